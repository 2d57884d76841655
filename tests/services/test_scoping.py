"""Which containers are in which TEE class, what is lacking, and where intervals end."""

import pyoxigraph as ox
import rdflib

import ontology
from sdt_kg.entities import Replacement
from sdt_kg.iri import RDF, SDT, SH, TEE, local_name
from sdt_kg.load import load_twin
from services.scoping import Lack, Membership, report_turtle, scope_map, tee_classes, to_json
from tests.small import small_twin

TWIN = small_twin("a", ("pr2",))
DRAWER = next(each for each in TWIN.containers() if each.kind == "drawer")


def member(twin, tee: str = "D_artic") -> Membership:
    (found,) = (
        each for each in scope_map(twin).members if (each.container, each.tee.name) == (DRAWER.name, tee)
    )
    return found


def lacks(twin, path: str) -> Lack:
    (found,) = (each for each in member(twin).lacks if each.path and local_name(each.path) == path)
    return found


def test_the_classes_are_those_of_tee_ttl_wider_ones_first() -> None:
    graph = rdflib.Graph().parse(ontology.path("tee.ttl"))
    named = {str(each) for each in graph.subjects(rdflib.RDF.type, rdflib.URIRef(TEE + "TeeClass"))}
    classes = tee_classes()
    assert {each.iri for each in classes} == named
    for position, each in enumerate(classes):
        assert each.refined is None or each.refined in classes[:position]


def test_a_drawer_that_is_too_long_says_by_how_much() -> None:
    found = lacks(TWIN.with_edit(DRAWER.joint, upperLimit=4.0), "upperLimit")
    assert (found.value, found.bound) == (4.0, 3.15)
    assert abs(found.missing - 0.85) < 1e-12
    assert found.demanded == "≤ 3.15"
    assert not found.is_unmeasured


def test_what_nobody_measured_is_asked_for_with_its_interval() -> None:
    found = lacks(TWIN.with_edit(DRAWER.joint, velocityLimit=None), "velocityLimit")
    assert found.is_unmeasured
    assert found.demanded == "> 0, ≤ 10"


def test_forces_that_nobody_measured_are_what_keeps_a_container_out_of_the_narrower_class() -> None:
    found = member(TWIN, "D_artic_dyn")
    assert not found.holds
    (model,) = (each for each in found.lacks if each.path and local_name(each.path) == "hasForceModel")
    assert model.is_unmeasured
    assert "coulombFrictionFrom" in model.demanded


def test_too_many_values_are_told_as_such_and_named() -> None:
    made = {(DRAWER.joint, SDT + "hasForceModel", ox.NamedNode(f"{DRAWER.joint}/{name}")) for name in "ab"}
    kinds = {(str(model.value), RDF + "type", ox.NamedNode(SDT + "SlideForceModel")) for _, _, model in made}
    found = member(
        TWIN.rewritten(Replacement(TWIN.environment, frozenset(), frozenset(made | kinds), "two")),
        "D_artic_dyn",
    )
    (lack,) = (each for each in found.lacks if each.path == SDT + "hasForceModel")
    assert (lack.value, lack.bound, lack.demanded, lack.is_unmeasured) == ("several", 1, "", False)
    assert lack.message.endswith("keep one of a and b")


def test_the_end_of_an_interval_is_as_far_as_the_value_is_from_its_bound() -> None:
    found = member(TWIN.with_edit(DRAWER.joint, velocityLimit=9.75))
    assert found.holds
    (end,) = (each for each in found.ends if local_name(each.path) == "velocityLimit")
    assert (end.value, end.bound, end.room) == (9.75, 10.0, 0.25)
    shares = [each.share for each in found.ends]
    assert shares == sorted(shares)


def test_json_has_every_container_in_every_class() -> None:
    said = to_json("a", scope_map(TWIN))
    count = len(TWIN.containers())
    assert [(each["name"], each["of"]) for each in said["classes"]] == [
        (each.name, count) for each in tee_classes()
    ]
    assert len(said["containers"]) == count * len(tee_classes())


def test_the_command_tells_the_map_and_refuses_nonsense(sdt) -> None:
    done = sdt("scope", "b", "--explain")
    assert done.code == 0, done.err
    for text in ("D_artic_dyn", "refines", "where the interval ends", "no containers, and why"):
        assert text in done.out
    assert sdt("scope", "no-such-kitchen", "--explain").code == 2


def test_the_report_is_shacl() -> None:
    conforms, focus = rdflib.URIRef(SH + "conforms"), rdflib.URIRef(SH + "focusNode")
    twin = load_twin("b")
    joint = twin.containers()[0].joint
    inside = rdflib.Graph().parse(data=report_turtle(twin))
    assert [str(value) for value in inside.objects(None, conforms)] == ["true"]
    outside = rdflib.Graph().parse(data=report_turtle(twin.with_edit(joint, velocityLimit=0.0)))
    assert [str(value) for value in outside.objects(None, conforms)] == ["false"]
    assert set(outside.objects(None, focus)) == {rdflib.URIRef(joint)}
