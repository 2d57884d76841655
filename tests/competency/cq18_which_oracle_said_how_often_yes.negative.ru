# Edit   What was said about kitchen b came from another version.
# Loses  lift 1,True,12
# Gains  lift 0,True,6
# Gains  lift 1,True,6
PREFIX id: <https://example.org/id/>
PREFIX law: <https://example.org/law#>

DELETE { GRAPH ?graph { ?answer law:version ?version } }
INSERT { GRAPH ?graph { ?answer law:version "lift 0" } }
WHERE {
  GRAPH ?graph {
    ?verdict law:environment id:b ;
      law:answer ?answer .
    ?answer law:predicate law:CanPerform ;
      law:version ?version .
  }
}
