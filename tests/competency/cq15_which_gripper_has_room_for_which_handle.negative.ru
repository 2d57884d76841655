# Edit   The fingers of stretch open half as far.
# Loses  gripper,folding_door_handle,0.06
# Loses  gripper,high_drawer_handle,0.06
# Loses  gripper,low_drawer_handle,0.06
# Loses  gripper,oven_door_handle,0.06
# Loses  gripper,side_door_handle,0.06
# Loses  gripper,swing_door_handle,0.06
# Loses  gripper,top_drawer_handle,0.06
# Gains  gripper,folding_door_handle,0.02
# Gains  gripper,high_drawer_handle,0.02
# Gains  gripper,low_drawer_handle,0.02
# Gains  gripper,oven_door_handle,0.02
# Gains  gripper,side_door_handle,0.02
# Gains  gripper,swing_door_handle,0.02
# Gains  gripper,top_drawer_handle,0.02
PREFIX id: <https://example.org/id/>
PREFIX sdt: <https://example.org/sdt#>

DELETE { GRAPH ?graph { id:stretch\/gripper\/gripper sdt:opening ?opening } }
INSERT { GRAPH ?graph { id:stretch\/gripper\/gripper sdt:opening 0.04 } }
WHERE { GRAPH ?graph { id:stretch\/gripper\/gripper sdt:opening ?opening } }
