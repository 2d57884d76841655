# Edit   What certifies kitchen b says no more which motion it is about.
# Loses  Causes,CanPerform,12
# Loses  SatisfiesRequest,Causes,16
# Gains  Causes,CanPerform,6
# Gains  SatisfiesRequest,Causes,8
PREFIX id: <https://example.org/id/>
PREFIX law: <https://example.org/law#>
PREFIX prov: <http://www.w3.org/ns/prov#>

DELETE { GRAPH ?graph { ?answer prov:wasDerivedFrom ?source } }
WHERE {
  GRAPH ?graph {
    ?verdict law:answer ?answer , ?source ;
      law:environment id:b .
    ?answer prov:wasDerivedFrom ?source .
  }
}
