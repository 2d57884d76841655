# Edit   The oven door is taken for a drawer.
# Loses  b,oven_door,Door,1.35,1.5
# Gains  b,oven_door,Drawer,1.35,1.5
PREFIX id: <https://example.org/id/>
PREFIX sdt: <https://example.org/sdt#>

DELETE { GRAPH ?graph { id:b\/body\/oven_door a sdt:Door } }
INSERT { GRAPH ?graph { id:b\/body\/oven_door a sdt:Drawer } }
WHERE { GRAPH ?graph { id:b\/body\/oven_door a sdt:Door } }
