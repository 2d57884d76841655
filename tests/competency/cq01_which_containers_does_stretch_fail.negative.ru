# Edit   What stretch failed is certified.
# Loses  a,Open,high_drawer,the handle of high_drawer needs the lift at 1.3 m
PREFIX id: <https://example.org/id/>
PREFIX law: <https://example.org/law#>

DELETE { GRAPH ?graph { ?verdict law:outcome law:NotCertified } }
INSERT { GRAPH ?graph { ?verdict law:outcome law:Certified } }
WHERE { GRAPH ?graph { ?verdict law:outcome law:NotCertified ; law:container id:a\/body\/high_drawer ; law:robot id:stretch } }
