# Edit   A search gave up where a proof was.
# Loses  pr2,b,Close,oven_door,nothing to cause: oven_door at 0 rad already meets close
# Loses  stretch,b,Close,oven_door,nothing to cause: oven_door at 0 rad already meets close
PREFIX law: <https://example.org/law#>

DELETE { GRAPH ?graph { ?diagnosis law:proof true } }
INSERT { GRAPH ?graph { ?diagnosis law:proof false } }
WHERE { GRAPH ?graph { ?diagnosis a law:CausalFailure ; law:proof true } }
