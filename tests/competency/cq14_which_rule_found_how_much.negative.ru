# Edit   One more handle is found by its name.
# Loses  r04_handle_by_name,7
# Gains  r04_handle_by_name,8
PREFIX id: <https://example.org/id/>
PREFIX sdt: <https://example.org/sdt#>

INSERT { GRAPH ?graph { id:b\/body\/knob a sdt:Handle } }
WHERE {
  GRAPH ?graph {
    ?graph sdt:inferredBy id:rule\/r04_handle_by_name .
    id:b\/body\/top_drawer_handle a sdt:Handle .
  }
}
