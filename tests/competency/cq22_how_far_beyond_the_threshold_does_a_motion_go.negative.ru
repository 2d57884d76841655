# Edit   The side door's way is longer, so that open begins later.
# Loses  Open,side_door,1.355,1.35,0.005
# Gains  Open,side_door,1.355,1.4,0.045
PREFIX id: <https://example.org/id/>
PREFIX sdt: <https://example.org/sdt#>

DELETE { GRAPH ?graph { id:a\/joint\/side_door_joint sdt:openFrom ?from } }
INSERT { GRAPH ?graph { id:a\/joint\/side_door_joint sdt:openFrom 1.4 } }
WHERE { GRAPH ?graph { id:a\/joint\/side_door_joint sdt:openFrom ?from } }
