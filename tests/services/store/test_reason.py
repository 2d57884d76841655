"""Reasoning: two engines agree on types, and an individual of two disjoint classes is told."""

import shutil

import pyoxigraph as ox
import pytest

from sdt_kg.history.diff import quads_of_twin
from sdt_kg.interchange import owlready_ontology
from sdt_kg.iri import LAW, OWL, RDF, SDT, XSD, body_iri
from services.store.reason import Engine, reasoned
from tests.small import small_twin

DRAWER = ox.NamedNode(body_iri("b", "top_drawer"))
NEEDS_JAVA = pytest.mark.skipif(shutil.which("java") is None, reason="HermiT needs Java")
ENGINES = [Engine.OWLRL, pytest.param(Engine.HERMIT, marks=NEEDS_JAVA)]
G = ox.NamedNode("https://example.org/g")


def kitchen(*more: tuple[ox.NamedNode, str, ox.NamedNode | ox.Literal]) -> list[ox.Quad]:
    added = [ox.Quad(subject, ox.NamedNode(predicate), value, G) for subject, predicate, value in more]
    return [*quads_of_twin(small_twin("b")), *added]


NEW = ox.NamedNode(body_iri("b", "new"))


def test_what_is_not_asserted_is_inferred_into_a_graph_of_its_own() -> None:
    quads = kitchen((NEW, RDF + "type", ox.NamedNode(SDT + "Door")))
    found = reasoned(quads, Engine.OWLRL)
    assert found.consistent
    assert found.clashes == ()
    assert [kind for each, kind in found.types if each == NEW.value] == [SDT + "Body", SDT + "Container"]
    assert {quad.graph_name.value for quad in found.quads()} == {found.graph}
    assert found.graph.endswith("/reasoned/owlrl")
    asserted = {(quad.subject, quad.object) for quad in quads}
    assert not asserted & {(quad.subject, quad.object) for quad in found.quads()}


@NEEDS_JAVA
def test_both_engines_infer_the_same_types() -> None:
    quads = kitchen((NEW, RDF + "type", ox.NamedNode(SDT + "Door")))
    one, other = (reasoned(quads, engine).types for engine in (Engine.HERMIT, Engine.OWLRL))
    assert one == other
    assert len(one) > 10


@pytest.mark.parametrize("engine", ENGINES)
def test_an_individual_of_two_disjoint_classes_is_inconsistent_and_told(engine: Engine) -> None:
    found = reasoned(kitchen((DRAWER, RDF + "type", ox.NamedNode(SDT + "RevoluteJoint"))), engine)
    assert not found.consistent
    assert any("top_drawer is " in clash and "Joint" in clash for clash in found.clashes)
    assert found.types == ()


@pytest.mark.parametrize("engine", ENGINES)
def test_the_bytes_of_a_certificate_contradict_nothing(engine: Engine) -> None:
    bytes_ = ox.Literal("c2R0IGNlcnRpZmljYXRlIDEK", datatype=ox.NamedNode(XSD + "base64Binary"))
    artefact = (NEW, RDF + "type", ox.NamedNode(LAW + "Artefact"))
    found = reasoned(kitchen(artefact, (NEW, LAW + "content", bytes_)), engine)
    assert (found.consistent, found.clashes) == (True, ())


def test_a_functional_property_with_two_values_is_told() -> None:
    found = reasoned(kitchen((DRAWER, SDT + "name", ox.Literal("another name"))), Engine.OWLRL)
    assert found.clashes == ("top_drawer has 2 values of name, which has one at most",)


def test_imports_are_not_fetched() -> None:
    ontology = ox.NamedNode("https://example.org/mine")
    nowhere = ox.NamedNode("http://127.0.0.1:9/must-not-be-asked")
    quads = kitchen(
        (ontology, RDF + "type", ox.NamedNode(OWL + "Ontology")), (ontology, OWL + "imports", nowhere)
    )
    onto = owlready_ontology(quads, "https://example.org/here")
    assert onto.base_iri == "https://example.org/here#"
    assert onto.imported_ontologies == []
    assert reasoned(quads, Engine.OWLRL).consistent


def test_a_twin_is_classes_and_individuals_of_owlready2() -> None:
    twin = small_twin("b")
    onto = twin.to_owlready()
    drawer = onto.world[DRAWER.value]
    assert drawer.hasHandle == [onto.world[twin.container("top_drawer").handle]]
    assert onto.world[SDT + "Drawer"] in drawer.is_a
    assert drawer in onto.world[SDT + "Container"].instances()
    assert len(list(onto.world.individuals())) > 40
