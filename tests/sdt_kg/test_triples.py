"""Mechanism → triples → mechanism, exactly."""

import math

import hypothesis.strategies as st
import pyoxigraph as ox
import pytest
from hypothesis import HealthCheck, given, settings

from sdt_kg.iri import model_iri
from sdt_kg.load import load_twin
from sdt_kg.mechanism import (
    Body,
    Geometry,
    Inertia,
    Joint,
    JointType,
    Limits,
    Mechanism,
    Mimic,
    Pose,
    ShapeType,
)
from sdt_kg.store import MemoryStore
from sdt_kg.triples import Facts, mechanism_triples, read_mechanism_of
from sdt_kg.triples.from_mechanism import SIZES

GRAPH = "https://example.org/id/graph/test"

numbers = st.floats(allow_nan=False, allow_infinity=False)
names = st.text(min_size=1, max_size=8).filter(str.isprintable)


def tuples(length: int) -> st.SearchStrategy[tuple[float, ...]]:
    return st.tuples(*[numbers] * length)


parts = st.floats(-1, 1)
turns = st.tuples(parts, parts, parts, parts.filter(lambda part: abs(part) > 0.1)).map(
    lambda four: tuple(part / math.hypot(*four) for part in four)
)
axes = st.tuples(parts, parts, parts.filter(lambda part: abs(part) > 0.1)).map(
    lambda three: tuple(part / math.hypot(*three) for part in three)
)
poses = st.builds(Pose, tuples(3), turns)


def geometries() -> st.SearchStrategy[Geometry]:
    plain = [
        st.builds(Geometry, st.just(shape), poses, tuples(len(SIZES[shape])))
        for shape in ShapeType
        if shape is not ShapeType.MESH
    ]
    mesh = st.builds(
        Geometry, st.just(ShapeType.MESH), poses, tuples(3), st.just("/a b/ü#1.stl"), st.just("ab" * 32)
    )
    return st.one_of(*plain, mesh)


limits = st.builds(
    Limits,
    st.one_of(numbers, st.just(-math.inf)),
    *[st.one_of(numbers, st.just(math.inf))] * 4,
)


inertias = st.builds(Inertia, numbers, poses, tuples(6)).filter(lambda one: one.possible)


@st.composite
def mechanisms(draw: st.DrawFn) -> Mechanism:
    bodies = draw(st.lists(names, min_size=1, max_size=4, unique=True))
    joints: list[Joint] = []
    for number, child in enumerate(bodies[1:], 1):
        mimic = draw(st.one_of(st.none(), st.builds(Mimic, st.just("j1"), numbers, numbers)))
        joints.append(
            Joint(
                name=f"j{number}",
                type=draw(st.sampled_from(JointType)),
                parent=bodies[draw(st.integers(0, number - 1))],
                child=child,
                origin=draw(poses),
                axis=draw(axes),  # type: ignore[arg-type]
                limits=draw(limits),
                mimic=mimic if number > 1 else None,
                notes=draw(st.lists(names, max_size=2).map(tuple)),
            )
        )
    return Mechanism(
        name=draw(names),
        root=bodies[0],
        bodies=tuple(
            Body(
                name,
                draw(st.one_of(st.none(), inertias)),
                draw(st.lists(geometries(), max_size=2).map(tuple)),
            )
            for name in bodies
        ),
        joints=tuple(joints),
        notes=draw(st.lists(names, max_size=2).map(tuple)),
    )


@settings(max_examples=60, suppress_health_check=[HealthCheck.filter_too_much])
@given(mechanisms())
def test_reading_back_gives_an_equal_mechanism(mechanism: Mechanism) -> None:
    store = MemoryStore()
    store.add(GRAPH, mechanism_triples(mechanism, "Environment"))
    assert read_mechanism_of(Facts(store.triples(GRAPH)), model_iri(mechanism.name)) == mechanism


@settings(max_examples=30, suppress_health_check=[HealthCheck.filter_too_much])
@given(mechanisms())
def test_reading_back_from_a_file_gives_an_equal_mechanism(mechanism: Mechanism) -> None:
    store = MemoryStore()
    store.add(GRAPH, mechanism_triples(mechanism, "Robot"))
    text = store.dump([GRAPH]).dump(format=ox.RdfFormat.N_QUADS)
    again = MemoryStore()
    again.add(
        GRAPH,
        ((q.subject.value, q.predicate.value, q.object) for q in ox.parse(text, format=ox.RdfFormat.N_QUADS)),
    )
    assert read_mechanism_of(Facts(again.triples(GRAPH)), model_iri(mechanism.name)) == mechanism


@pytest.mark.parametrize("robot", ["pr2", "tiago_dual", "stretch"])
def test_bundled_models_differ_from_their_urdf_by_acceleration_limits_only(robot: str) -> None:
    from dataclasses import replace  # noqa: PLC0415

    from sdt_kg.load import bundled  # noqa: PLC0415
    from sdt_kg.urdf import read_mechanism  # noqa: PLC0415

    twin = load_twin("b", [robot])
    for path, model, turn in (
        (bundled("robot", robot), twin.robots[0], False),
        (bundled("kitchen", "b"), twin.environment, True),
    ):
        read = twin.mechanism(model)
        joints = tuple(replace(j, limits=replace(j.limits, acceleration=math.inf)) for j in read.joints)
        assert replace(read, joints=joints) == read_mechanism(path, turn_axes=turn)
