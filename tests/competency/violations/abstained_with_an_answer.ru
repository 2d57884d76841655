# Edit   An abstention is said to be proved.
PREFIX law: <https://example.org/law#>

DELETE { GRAPH ?graph { ?diagnosis law:proof false } }
INSERT { GRAPH ?graph { ?diagnosis law:proof true } }
WHERE { GRAPH ?graph { ?diagnosis a law:OutOfScope ; law:proof false } }
