# Edit   A verdict forgets which state it was asked in.
PREFIX id: <https://example.org/id/>
PREFIX law: <https://example.org/law#>

DELETE { GRAPH ?graph { ?input law:name "state" } }
WHERE { GRAPH ?graph { ?input law:name "state" . ?verdict law:robot id:stretch } }
