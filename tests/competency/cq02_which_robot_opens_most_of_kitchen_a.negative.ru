# Edit   PR2 opens the side door and the folding door no more.
# Loses  pr2,4,4
# Gains  pr2,2,4
PREFIX id: <https://example.org/id/>
PREFIX law: <https://example.org/law#>

DELETE { GRAPH ?graph { ?verdict law:outcome law:Certified } }
INSERT { GRAPH ?graph { ?verdict law:outcome law:NotCertified } }
WHERE { GRAPH ?graph { ?verdict law:outcome law:Certified ; law:container ?container ; law:robot id:pr2 } VALUES ?container { id:a\/body\/side_door id:a\/body\/folding_door } }
