# Edit   The oven door belongs to another kitchen.
PREFIX id: <https://example.org/id/>
PREFIX sdt: <https://example.org/sdt#>

DELETE { GRAPH ?graph { id:b\/body\/oven_door sdt:partOf id:b } }
INSERT { GRAPH ?graph { id:b\/body\/oven_door sdt:partOf id:a } }
WHERE { GRAPH ?graph { id:b\/body\/oven_door sdt:partOf id:b } }
