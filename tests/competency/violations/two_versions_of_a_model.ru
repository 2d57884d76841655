# Edit   Some verdicts were about an earlier kitchen b.
PREFIX id: <https://example.org/id/>
PREFIX law: <https://example.org/law#>

DELETE { GRAPH ?graph { ?input law:inputHash ?hash } }
INSERT { GRAPH ?graph { ?input law:inputHash "https://example.org/id/b 0" } }
WHERE { GRAPH ?graph { ?input law:name "environment" ; law:inputHash ?hash . ?verdict law:robot id:pr2 ; law:environment id:b } }
