"""Triples → Mechanism: what physics is built from."""

import math
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Final, TypeVar
from urllib.parse import unquote, urlparse

from sdt_kg.iri import RDFS, SDT, Iri, local_name
from sdt_kg.mechanism import Body, Geometry, Inertia, Joint, Limits, Mechanism, Mimic, ShapeType
from sdt_kg.triples.facts import Facts
from sdt_kg.triples.from_mechanism import JOINT_CLASSES, LIMITS, MOMENTS, SHAPE_CLASSES, SIZES

Kind = TypeVar("Kind")

NONE: Final[Mapping[Iri, Body]] = MappingProxyType({})

_JOINT_TYPES: Final = {SDT + name: kind for kind, name in JOINT_CLASSES.items()}
_SHAPE_TYPES: Final = {SDT + name: kind for kind, name in SHAPE_CLASSES.items()}


def read_mechanism_of(facts: Facts, model: Iri, known: Mapping[Iri, Body] = NONE) -> Mechanism:
    """The mechanism that `mechanism_triples` wrote, with limits that annotation added since.

    Bodies that are known are not read.
    """
    parts = facts.having("partOf", model)
    bodies = [iri for iri in parts if SDT + "Body" in facts.types(iri)]
    joints = [iri for iri in parts if not facts.types(iri).isdisjoint(_JOINT_TYPES)]
    return Mechanism(
        name=local_name(model),
        root=local_name(str(facts.one(model, "rootBody"))),
        bodies=tuple(known.get(iri) or _body(facts, iri) for iri in _ordered(facts, bodies)),
        joints=tuple(_joint(facts, iri) for iri in _ordered(facts, joints)),
        notes=notes_of(facts, model),
    )


def notes_of(facts: Facts, subject: Iri) -> tuple[str, ...]:
    """What import noticed about the subject."""
    notes = _ordered(facts, facts.iris(subject, "hasNote"))
    return tuple(str(facts.one(note, RDFS + "comment")) for note in notes)


def _ordered(facts: Facts, subjects: list[Iri]) -> list[Iri]:
    return sorted(subjects, key=lambda subject: (facts.number(subject, "index"), subject))


def _body(facts: Facts, iri: Iri) -> Body:
    inertia = facts.one(iri, "hasInertia")
    return Body(
        name=local_name(iri),
        inertia=None if inertia is None else _inertia(facts, str(inertia)),
        collision=tuple(
            geometry_of(facts, shape) for shape in _ordered(facts, facts.iris(iri, "hasCollisionGeometry"))
        ),
    )


def _inertia(facts: Facts, iri: Iri) -> Inertia:
    ixx, ixy, ixz, iyy, iyz, izz = (facts.number(iri, name) for name in MOMENTS)
    pose = facts.pose(str(facts.one(iri, "hasPose")))
    inertia = Inertia(facts.number(iri, "mass"), pose, (ixx, ixy, ixz, iyy, iyz, izz))
    if not inertia.possible:
        raise ValueError(f"'{iri}', whose moments no body has,")
    return inertia


def geometry_of(facts: Facts, iri: Iri) -> Geometry:
    """The collision shape."""
    shape = _kind(facts, iri, _SHAPE_TYPES)
    file = facts.one(iri, "meshFile")
    return Geometry(
        shape=shape,
        pose=facts.pose(str(facts.one(iri, "hasPose"))),
        size=tuple(facts.number(iri, name) for name in SIZES[shape]),
        mesh_file="" if file is None else str(Path(unquote(urlparse(str(file)).path))),
        mesh_hash=str(facts.one(iri, "meshHash") or ""),
    )


def shapes_of(facts: Facts, iri: Iri) -> list[ShapeType]:
    """Every kind of shape that it is said to be."""
    return _kinds(facts, iri, _SHAPE_TYPES)


def _kinds(facts: Facts, iri: Iri, kinds: Mapping[Iri, Kind]) -> list[Kind]:
    return [kinds[each] for each in facts.types(iri) if each in kinds]


def _kind(facts: Facts, iri: Iri, kinds: Mapping[Iri, Kind]) -> Kind:
    found = _kinds(facts, iri, kinds)
    if len(found) != 1:
        raise ValueError(f"the type of {local_name(iri)}")
    return found[0]


def _joint(facts: Facts, iri: Iri) -> Joint:
    kind = _kind(facts, iri, _JOINT_TYPES)
    bounds = {
        attribute: facts.number(iri, name, -math.inf if attribute == "lower" else math.inf)
        for attribute, name in LIMITS.items()
    }
    return Joint(
        name=local_name(iri),
        type=kind,
        parent=local_name(str(facts.one(iri, "parent"))),
        child=local_name(str(facts.one(iri, "child"))),
        origin=facts.pose(str(facts.one(iri, "hasOrigin"))),
        axis=facts.axis(iri),
        limits=Limits(**bounds),
        mimic=_mimic(facts, iri),
        notes=notes_of(facts, iri),
    )


def _mimic(facts: Facts, iri: Iri) -> Mimic | None:
    target = facts.one(iri, "mimics")
    if target is None:
        return None
    multiplier, offset = facts.number(iri, "mimicMultiplier"), facts.number(iri, "mimicOffset")
    return Mimic(local_name(str(target)), multiplier, offset)
