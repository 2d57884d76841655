# Edit   Stretch opens the high drawer too.
# Loses  pr2,a,high_drawer,2
PREFIX id: <https://example.org/id/>
PREFIX law: <https://example.org/law#>

DELETE { GRAPH ?graph { ?verdict law:outcome law:NotCertified } }
INSERT { GRAPH ?graph { ?verdict law:outcome law:Certified } }
WHERE { GRAPH ?graph { ?verdict law:outcome law:NotCertified ; law:container id:a\/body\/high_drawer ; law:robot id:stretch } }
