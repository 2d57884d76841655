# Edit   The low drawer was opened with the left hand.
# Loses  pr2,gripper,omni,a,Open,low_drawer
# Gains  pr2,left,omni,a,Open,low_drawer
PREFIX id: <https://example.org/id/>
PREFIX law: <https://example.org/law#>

DELETE { GRAPH ?graph { ?verdict law:gripper ?gripper } }
INSERT { GRAPH ?graph { ?verdict law:gripper "left" } }
WHERE { GRAPH ?graph { ?verdict law:gripper ?gripper ; law:container id:a\/body\/low_drawer ; law:robot id:pr2 } }
