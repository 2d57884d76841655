# Edit   Closed ends beyond where open begins.
PREFIX id: <https://example.org/id/>
PREFIX sdt: <https://example.org/sdt#>

DELETE { GRAPH ?graph { ?joint sdt:openFrom ?from } }
INSERT { GRAPH ?graph { ?joint sdt:openFrom 0.0 } }
WHERE { GRAPH ?graph { ?joint sdt:openFrom ?from } FILTER (?joint = id:b\/joint\/oven_door_joint) }
