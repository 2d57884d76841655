# Edit   Stretch can perform one motion more.
# Loses  stretch,canPerform,2
# Gains  stretch,canPerform,1
PREFIX id: <https://example.org/id/>
PREFIX law: <https://example.org/law#>

DELETE { GRAPH ?graph { ?verdict law:canPerform false } }
INSERT { GRAPH ?graph { ?verdict law:canPerform true } }
WHERE { GRAPH ?graph { ?verdict law:canPerform false ; law:container id:a\/body\/high_drawer } }
