# Edit   The handle of the top drawer comes off.
# Loses  top_drawer,top_drawer_handle
PREFIX id: <https://example.org/id/>
PREFIX sdt: <https://example.org/sdt#>

DELETE WHERE { GRAPH ?graph { id:b\/body\/top_drawer sdt:hasBody id:b\/body\/top_drawer_handle } }
