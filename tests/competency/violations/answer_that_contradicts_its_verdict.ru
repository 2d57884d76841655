# Edit   An answer is turned around, and its verdict is not.
PREFIX law: <https://example.org/law#>

DELETE { GRAPH ?graph { ?answer law:holds false } }
INSERT { GRAPH ?graph { ?answer law:holds true } }
WHERE { GRAPH ?graph { ?answer law:holds false ; law:predicate law:CanPerform } }
