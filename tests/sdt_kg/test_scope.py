"""D_artic: what is in scope, what is not, with focus node, path, value and bound."""

import math
from pathlib import Path

import pyoxigraph as ox
import pytest
import rdflib

import ontology
from sdt_kg.iri import LAW, SDT, local_name
from sdt_kg.load import load_twin
from sdt_kg.scope import D_ARTIC, request_graph, violations
from sdt_kg.shacl import Violation, check
from sdt_kg.triples.to_rdflib import rdflib_graph
from sdt_kg.twin import Twin
from tests.sdt_kg.conftest import Write, joint, limit, link
from tests.sdt_kg.test_twin import SLIDE, door


def found(twin: Twin) -> list[Violation]:
    (container,) = twin.containers()
    return violations(twin, container, verb=LAW + "Open")


def summary(twin: Twin) -> set[tuple[str, str, object, object]]:
    return {(local_name(v.focus), local_name(v.path or ""), v.value, v.bound) for v in found(twin)}


@pytest.mark.parametrize("robot", ["pr2", "tiago_dual", "stretch"])
@pytest.mark.parametrize("kitchen", ["a", "b"])
def test_the_paper_is_in_scope(kitchen: str, robot: str) -> None:
    twin = load_twin(kitchen, [robot])
    for container in twin.containers()[::4]:
        assert violations(twin, container, twin.robots[0], LAW + "Close") == []


def test_a_drawer_is_in_scope(drawer: Path) -> None:
    assert found(load_twin(drawer)) == []


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (
            {"velocityLimit": 0.0},
            {("slide", "velocityLimit", 0.0, 0), ("slide", "effectiveVelocityLimit", 0.0, 0)},
        ),
        (
            {"velocityLimit": None},
            {("slide", "velocityLimit", None, 1), ("slide", "effectiveVelocityLimit", None, 1)},
        ),
        ({"accelerationLimit": 1000.0}, {("slide", "accelerationLimit", 1000.0, 100)}),
        (
            {"upperLimit": 4.0},
            {("slide", "upperLimit", 4.0, 3.15), ("slide", "effectiveUpperLimit", 4.0, 3.15)},
        ),
        ({"upperLimit": 0.01}, {("slide", "closedTo", 0.01, 0.009000000000000001)}),
    ],
)
def test_a_limit_outside_its_interval_is_told_with_value_and_bound(
    drawer: Path, change: dict[str, float | None], expected: set[tuple[str, str, object, object]]
) -> None:
    assert summary(load_twin(drawer).with_edit(SLIDE, **change)) == expected


def test_a_lower_limit_below_0_is_out_of_scope_where_turning_does_not_help(write: Write) -> None:
    twin = load_twin(write(*door(limit(-1.0, 1.0))))
    assert ("hinge", "lowerLimit", -1.0, 0) in summary(twin)


def test_a_continuous_hinge_is_out_of_scope(write: Write) -> None:
    twin = load_twin(write(*door('<limit velocity="1" effort="1"/>', "continuous")))
    messages = {v.message for v in found(twin)}
    assert "a container's joint slides or turns between limits: make it prismatic or revolute" in messages


def test_a_handle_without_shape_is_out_of_scope(write: Write) -> None:
    parts = tuple(link("handle") if 'name="handle"' in part else part for part in door(limit(0.0, 1.5)))
    assert ("handle", "hasCollisionGeometry", None, 1) in summary(load_twin(write(*parts)))


def test_a_verb_of_another_class_is_out_of_scope(drawer: Path) -> None:
    twin = load_twin(drawer)
    (violation,) = violations(twin, twin.containers()[0], verb=LAW + "Pour")
    assert (violation.value, local_name(violation.path or "")) == (LAW + "Pour", "verb")


def test_a_robot_outside_r_is_out_of_scope() -> None:
    twin = load_twin("b", ["stretch"])
    (robot,) = twin.robots
    twin = twin.with_edit(robot, baseLinearVelocity=0.0)
    (violation,) = violations(twin, twin.containers()[0], robot)
    assert (violation.focus, violation.path, violation.value) == (robot, SDT + "baseLinearVelocity", 0.0)
    assert violations(twin, twin.containers()[0]) == []


def test_only_the_containers_own_joint_is_bound(write: Write) -> None:
    extra = (link("knob"), joint("turn", "revolute", "world", "knob", limit(-math.pi, math.pi)))
    assert found(load_twin(write(*door(limit(0.0, 1.5)), *extra))) == []


def test_constants_are_those_of_the_paper() -> None:
    assert D_ARTIC.number("openFraction") == 0.9
    assert D_ARTIC.number("closedTolerance") == 0.01
    assert len(D_ARTIC.content_hash) == 64


def test_kitchen_and_robot_are_looked_at_apart_and_nothing_is_missed_by_that() -> None:
    twin = load_twin("b", ["stretch"])
    (robot,), container = twin.robots, twin.containers()[0]
    twin = twin.with_edit(robot, baseLinearVelocity=0.0).with_edit(container.joint, velocityLimit=0.0)
    whole = check(request_graph(twin, container, robot, LAW + "Open"), D_ARTIC.shapes, [])
    assert len(whole) == 3
    assert violations(twin, container, robot, LAW + "Open") == whole


def test_a_graph_for_pyshacl_says_what_the_twin_says() -> None:
    twin = load_twin("b", ["stretch"])
    graph = twin.entities.asserted[twin.robots[0]]
    written = twin.entities.store.dump([graph]).dump(
        format=ox.RdfFormat.N_TRIPLES, from_graph=ox.NamedNode(graph)
    )
    assert written is not None
    read = rdflib.Graph().parse(data=written, format="nt")
    assert _values(rdflib_graph(twin.entities.store.triples(graph))) == _values(read)


def _values(graph: rdflib.Graph) -> set[tuple[object, ...]]:
    return {(s, p, o.toPython()) for s, p, o in graph}  # type: ignore[attr-defined]


@pytest.mark.parametrize("robot", ["pr2", "tiago_dual", "stretch"])
def test_what_import_writes_conforms_to_the_shapes_of_every_twin(robot: str) -> None:
    shapes = rdflib.Graph().parse(ontology.path("shapes/sdt.shapes.ttl"))
    data = rdflib.Graph()
    for s, p, o, _ in load_twin("b", [robot]).to_rdflib().quads():
        data.add((s, p, o))
    joints = ("ActiveJointShape", "BodyShape", "FixedJointShape", "PoseShape", "PrismaticJointShape")
    assert check(data, shapes, [f"https://example.org/sdt/shapes#{name}" for name in joints]) == []
