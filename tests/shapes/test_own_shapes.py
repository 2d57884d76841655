"""Shapes of one's own: what would let everything pass is refused, and they see what they ask about."""

import pytest
import rdflib

from sdt_kg.errors import InputError
from sdt_kg.iri import SDT
from sdt_kg.scope import request_graph
from sdt_kg.shacl import Violation, check
from tests.small import small_twin

TWIN = small_twin("a")
DRAWER = TWIN.container("low_drawer")
SHAPE = "https://my.org/shapes#Mine"
HEAD = """
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix sdt: <https://example.org/sdt#> .
@prefix sh: <http://www.w3.org/ns/shacl#> .
@prefix xsd: <http://www.w3.org/2001/XMLSchema#> .
@prefix my: <https://my.org/shapes#> .
"""
OF_JOINT = "my:Mine a sh:NodeShape ; sh:targetObjectsOf sdt:hasJoint ; "
SHORT = OF_JOINT + "sh:property [ sh:path sdt:upperLimit ; sh:maxInclusive 0.1 ] ."


def found(shapes: str) -> list[Violation]:
    graph = rdflib.Graph().parse(data=HEAD + shapes, format="turtle")
    return check(request_graph(TWIN, DRAWER, tee=graph), graph, [SHAPE])


@pytest.mark.parametrize(
    ("shapes", "why"),
    [
        (SHORT.replace("upperLimit", "uperLimit"), "sdt#uperLimit>, which no vocabulary has"),
        (SHORT.replace("hasJoint", "hasJiont"), "sdt#hasJiont>, which no vocabulary has"),
        (SHORT.replace("maxInclusive", "maxInclusiv"), "shacl#maxInclusiv>, which is no term of SHACL"),
        (
            SHORT.replace("sh:property", "<http://www.w3.org/ns/shacl/property>"),
            "shacl/property>, which is no",
        ),
        (SHORT.replace("sdt:upper", "<http://example.org/sdt#upper").replace("Limit ", "Limit> "), "ask for"),
        (SHORT.replace("sh:path", "sh:deactivated true ; sh:path"), "a shape without IRI deactivated"),
        (SHORT.replace("sh:property", "sh:deactivated true ; sh:property"), "#Mine> deactivated"),
        (SHORT.replace("0.1", '"NaN"^^xsd:double'), "a bound that is no number"),
        (SHORT + "<https://my.org/> owl:imports <https://my.org/more> .", "import <https://my.org/more>"),
        (OF_JOINT + "sh:js [ a sh:JSConstraint ] .", "sh:js in <https://my.org/shapes#Mine>"),
        (OF_JOINT + 'sh:message "nothing" .', "the shape <https://my.org/shapes#Mine> demands nothing"),
        (OF_JOINT + "sh:property [ sh:minCount 1 ] .", "the shapes are not SHACL: "),
        (SHORT.replace("sh:maxInclusive 0.1", 'sh:minCount "one"'), "the shapes are not SHACL: "),
        (SHORT.replace("sh:maxInclusive 0.1", 'sh:pattern "("'), "the shapes are not SHACL: "),
        (OF_JOINT + "sh:or my:Other .", "the shapes are not SHACL: "),
        (SHORT.replace("0.1", "my:Other"), "the shapes are not SHACL: "),
    ],
)
def test_shapes_that_would_let_everything_pass_are_refused(shapes: str, why: str) -> None:
    with pytest.raises(InputError) as refused:
        found(shapes)
    assert why in str(refused.value)


@pytest.mark.parametrize(
    "shapes",
    [
        SHORT,
        SHORT.replace("sh:targetObjectsOf sdt:hasJoint", "sh:targetSubjectsOf sdt:upperLimit"),
        SHORT.replace("sh:targetObjectsOf sdt:hasJoint", f"sh:targetNode <{DRAWER.joint}>"),
        SHORT.replace("sh:path", "sh:severity sh:Info ; sh:path"),
        OF_JOINT + "sh:property [ sh:path sdt:effortLimit ; sh:maxInclusive 0.1 ] .",
        OF_JOINT + "sh:property [ sh:path ( sdt:drivenBy sdt:upperLimit ) ; sh:maxInclusive 0.1 ] .",
        "my:Mine a sh:NodeShape ; sh:targetObjectsOf sdt:hasHandle ; sh:property [ "
        "sh:path sdt:hasCollisionGeometry ; sh:node my:Thin ] . "
        "my:Thin sh:property [ sh:path sdt:sizeX ; sh:maxInclusive 0.0001 ] .",
        "my:Mine a sh:NodeShape ; sh:targetClass sdt:Container ; "
        "sh:property [ sh:path rdfs:label ; sh:maxCount 0 ] .",
        OF_JOINT + "sh:closed true ; sh:property [ sh:path sdt:upperLimit ; sh:minCount 1 ] .",
        OF_JOINT + 'sh:sparql [ a sh:SPARQLConstraint ; sh:message "strong" ; sh:select """SELECT $this '
        '{ $this <https://example.org/sdt#effortLimit> ?most FILTER (?most > 0.1) }""" ] .',
    ],
)
def test_what_a_shape_forbids_is_seen_wherever_in_the_kitchen_it_is_said(shapes: str) -> None:
    violations = found(shapes)
    assert violations
    assert all(each.component is not None for each in violations), "of a constraint, not for want of a focus"


WITH_FORCES = (
    "my:Whole a sh:NodeShape ; sh:targetClass sdt:Container ; "
    "sh:property [ sh:path sdt:hasForceModel ; sh:minCount 1 ] . "
    "my:Mine a sh:NodeShape ; sh:targetObjectsOf sdt:hasForceModel ; "
    "sh:property [ sh:path sdt:massSpread ; sh:minCount 1 ] ."
)


def test_a_shape_that_looks_along_what_is_missing_is_not_told_beside_it() -> None:
    (missing,) = found(WITH_FORCES)
    assert (missing.focus, missing.path) == (DRAWER.iri, SDT + "hasForceModel")
    (unseen,) = found(WITH_FORCES.replace("minCount 1 ] . my:Mine", "maxCount 1 ] . my:Mine"))
    assert (unseen.focus, unseen.component) == (SHAPE, None), "nothing else says that it looked at nothing"
    other = WITH_FORCES.replace("sdt:hasForceModel ; sh:minCount", "sdt:drivenBy ; sh:minCount")
    assert {each.focus for each in found(other)} == {DRAWER.iri, SHAPE}, "what is missing is something else"


def test_what_is_allowed_passes_whatever_the_target() -> None:
    for target in ("sh:targetObjectsOf sdt:hasJoint", "sh:targetSubjectsOf sdt:upperLimit"):
        assert found(SHORT.replace("sh:targetObjectsOf sdt:hasJoint", target).replace("0.1", "9")) == []
