# Edit   A verdict abstains too.
PREFIX id: <https://example.org/id/>
PREFIX law: <https://example.org/law#>

INSERT { GRAPH ?graph { ?verdict law:outcome law:Abstained } }
WHERE { GRAPH ?graph { ?verdict law:outcome law:Certified ; law:robot id:pr2 ; law:container id:a\/body\/low_drawer } }
