# Edit   The oven door opens a crack in every state.
# Loses  oven_door,0,2,0
# Gains  oven_door,0,0,2
PREFIX id: <https://example.org/id/>
PREFIX sdt: <https://example.org/sdt#>

DELETE { GRAPH ?graph { id:b\/joint\/oven_door_joint sdt:position ?position } }
INSERT { GRAPH ?graph { id:b\/joint\/oven_door_joint sdt:position 0.1 } }
WHERE { GRAPH ?graph { id:b\/joint\/oven_door_joint sdt:position ?position } }
