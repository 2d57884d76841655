# Edit   The lift reaches 0.2 m higher, which is still too low for the high drawer.
# Loses  stretch,high_drawer,position,0.32,m
# Gains  stretch,high_drawer,position,0.1,m
PREFIX law: <https://example.org/law#>

DELETE { GRAPH ?graph { ?diagnosis law:bound ?bound } }
INSERT { GRAPH ?graph { ?diagnosis law:bound 1.2e0 } }
WHERE { GRAPH ?graph { ?diagnosis a law:EmbodimentFailure ; law:bound ?bound ; law:value ?value } FILTER (?value > 1.2) }
