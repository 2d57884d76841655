# Edit   An abstention loses its report.
PREFIX id: <https://example.org/id/>
PREFIX law: <https://example.org/law#>

DELETE { GRAPH ?graph { ?verdict law:scopeReport ?report } }
WHERE { GRAPH ?graph { ?verdict law:scopeReport ?report ; law:robot id:pr2 } }
