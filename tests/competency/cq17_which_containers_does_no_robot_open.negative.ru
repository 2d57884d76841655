# Edit   PR2 is certified no more for the high drawer.
# Gains  a,high_drawer,2,0
PREFIX id: <https://example.org/id/>
PREFIX law: <https://example.org/law#>

DELETE { GRAPH ?graph { ?verdict law:outcome law:Certified } }
INSERT { GRAPH ?graph { ?verdict law:outcome law:NotCertified } }
WHERE { GRAPH ?graph { ?verdict law:outcome law:Certified ; law:container id:a\/body\/high_drawer ; law:robot id:pr2 } }
