# Edit   Somebody measures where robots start in kitchen b.
# Loses  b,"no annotation: robots are assumed to start at x = 0, y = 0, yaw = 0 of the root frame"
PREFIX id: <https://example.org/id/>
PREFIX sdt: <https://example.org/sdt#>

DELETE WHERE { GRAPH ?graph { id:b sdt:assumption ?assumption } }
