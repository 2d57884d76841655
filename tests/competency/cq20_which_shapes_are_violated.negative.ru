# Edit   The report is about another property shape.
# Loses  JointShape-lowerLimit,swing_door_joint,-1,0,2
# Gains  JointShape-upperLimit,swing_door_joint,-1,0,2
PREFIX sh: <http://www.w3.org/ns/shacl#>

DELETE { GRAPH ?graph { ?result sh:sourceShape ?shape } }
INSERT { GRAPH ?graph { ?result sh:sourceShape <https://example.org/tee/d_artic#JointShape-upperLimit> } }
WHERE {
  GRAPH ?graph { ?result sh:sourceShape ?shape }
  FILTER (?shape = <https://example.org/tee/d_artic#JointShape-lowerLimit>)
}
