# Edit   The folding door gets a joint that moves by itself.
# Loses  folding_door,folding_door_joint,upper_panel_joint,2
PREFIX id: <https://example.org/id/>
PREFIX sdt: <https://example.org/sdt#>

DELETE { GRAPH ?graph { id:a\/joint\/folding_door_joint sdt:drivenBy ?active } }
INSERT { GRAPH ?graph { id:a\/joint\/folding_door_joint sdt:drivenBy id:a\/joint\/folding_door_joint } }
WHERE { GRAPH ?graph { id:a\/joint\/folding_door_joint sdt:drivenBy ?active } }
