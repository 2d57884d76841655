# Edit   A refusal is called certified.
PREFIX id: <https://example.org/id/>
PREFIX law: <https://example.org/law#>

DELETE { GRAPH ?graph { ?verdict law:outcome law:NotCertified } }
INSERT { GRAPH ?graph { ?verdict law:outcome law:Certified } }
WHERE { GRAPH ?graph { ?verdict law:outcome law:NotCertified ; law:robot id:stretch ; law:container id:a\/body\/high_drawer } }
