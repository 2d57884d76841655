"""A narrower class D: containers that a child could use, stated as a SHACL shape.

A class says where a physics is held to be valid. Outside it the Law abstains: no verdict, and the SHACL
result says why. Here is the shape, before it becomes a class of the ontology (predicates/README.md).
"""

import rdflib

from sdt_kg.errors import InputError
from sdt_kg.iri import local_name
from sdt_kg.scope import request_graph, violations
from sdt_kg.shacl import check
from services import load

LIGHT = "https://example.org/tee/light#"
SHAPES = f"""
@prefix sdt: <https://example.org/sdt#> .
@prefix sh: <http://www.w3.org/ns/shacl#> .

<{LIGHT}ShortWay> a sh:NodeShape ;
  sh:targetObjectsOf sdt:hasJoint ;
  sh:property [
    sh:path sdt:upperLimit ;
    sh:minCount 1 ;
    sh:maxInclusive 0.5 ;
    sh:message "the way is longer than 0.5 m or 0.5 rad: too far for a short arm"
  ] .
"""
shapes = rdflib.Graph().parse(data=SHAPES, format="turtle")
twin = load("b").twin

for container in twin.containers():
    inside = not violations(twin, container)  # D_artic first: a narrower class is inside the wider one
    found = check(request_graph(twin, container, tee=shapes), shapes, [f"{LIGHT}ShortWay"])
    why = "; ".join(f"{local_name(each.focus)}: {each.value} > {each.bound}" for each in found)
    print(f"{container.name}: {'inside' if inside and not found else 'abstain'} {why}")

# A shape that finds nothing to look at lets nothing pass, and a typo is no permission: it is refused by name.
container = twin.containers()[0]
idle = rdflib.Graph().parse(data=SHAPES.replace("sdt:hasJoint ", "sdt:padFriction "), format="turtle")
print(check(request_graph(twin, container, tee=idle), idle, [f"{LIGHT}ShortWay"])[0].message)
typo = rdflib.Graph().parse(data=SHAPES.replace("sdt:upperLimit", "sdt:uperLimit"), format="turtle")
try:
    check(request_graph(twin, container, tee=typo), typo, [f"{LIGHT}ShortWay"])
except InputError as error:
    print(error)
