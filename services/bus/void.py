"""What a server holds, in VoID: how much, and how many things of which class."""

from typing import Final

MEDIA: Final = "application/n-triples"
VOID: Final = """
PREFIX void: <http://rdfs.org/ns/void#>
CONSTRUCT {
  ?dataset a void:Dataset ;
    void:classPartition ?part ;
    void:distinctSubjects ?subjects ;
    void:triples ?triples ;
    void:vocabulary law:, sdt:, tee: .
  ?part void:class ?class ;
    void:entities ?entities .
}
WHERE {
  { SELECT (COUNT(*) AS ?triples) (COUNT(DISTINCT ?s) AS ?subjects) WHERE { ?s ?p ?o } }
  { SELECT ?class (COUNT(DISTINCT ?each) AS ?entities) WHERE { ?each a ?class } GROUP BY ?class }
  BIND (id:dataset AS ?dataset)
  BIND (IRI(CONCAT(STR(?dataset), "#", ENCODE_FOR_URI(STR(?class)))) AS ?part)
}
"""
"""Over entities, present states and verdicts: the default graph."""
