# Edit   The oven door hangs behind its hinge.
PREFIX id: <https://example.org/id/>
PREFIX sdt: <https://example.org/sdt#>

DELETE { GRAPH ?graph { id:b\/joint\/oven_door_joint sdt:position ?position } }
INSERT { GRAPH ?graph { id:b\/joint\/oven_door_joint sdt:position -0.5 } }
WHERE { GRAPH ?graph { id:b\/joint\/oven_door_joint sdt:position ?position } }
