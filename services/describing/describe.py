"""The first annotation of a robot, whole."""

import shlex
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from sdt_kg.annotation import RobotAnnotation
from sdt_kg.describe import guessed, turtle
from sdt_kg.entities import Entities
from sdt_kg.errors import InputError
from sdt_kg.iri import model_iri
from sdt_kg.mechanism import Mechanism
from sdt_kg.naming import few
from sdt_kg.triples import mechanism_triples
from sdt_kg.urdf import read_mechanism
from services.describing.parking import parked
from services.describing.touching import ALWAYS, Pair, touching

NAMED = 3
"""[containers] Told by name of a kitchen that is taken for a robot."""


@dataclass(frozen=True, slots=True)
class Described:
    """A first annotation, as a value and as Turtle.

    Attributes:
        notes: What import noticed about the model, and what was guessed and from what.
    """

    robot: RobotAnnotation
    text: str
    notes: tuple[str, ...]


def describe(urdf: Path) -> Described:
    """A first annotation of a URDF or xacro file; it loads as it is, unless no gripper was found.

    Raises:
        UrdfError: Not a valid URDF.
        InputError: A kitchen: it has containers and no gripper.
    """
    mechanism = read_mechanism(urdf)
    robot = guessed(mechanism)
    if not robot.grippers:
        _check_no_kitchen(urdf, mechanism)
    why = touching(mechanism, robot)
    allowed = robot.allowed_contacts | why.keys()
    notes = (*robot.notes, *_of_pairs(len(allowed), why))
    robot = parked(urdf, replace(robot, allowed_contacts=allowed, notes=notes))
    return Described(
        robot, turtle(robot, urdf.name, why), (*mechanism.notes, *robot.notes, *robot.base_notes)
    )


def _check_no_kitchen(urdf: Path, mechanism: Mechanism) -> None:
    """A model in which no gripper was found has no doors and drawers either."""
    kitchen = Entities.alone(model_iri(mechanism.name), mechanism_triples(mechanism, "Environment"))
    names = [each.name for each in kitchen.containers]
    if names:
        raise InputError(
            f"{urdf} looks like a kitchen: it has no gripper, and containers ({few(names, NAMED)})",
            allowed="the URDF or xacro of a robot",
            remedy=f"a kitchen needs no annotation: sdt containers {shlex.quote(str(urdf))}",
        )


def _of_pairs(count: int, why: Mapping[Pair, str]) -> Iterator[str]:
    """How many pairs may touch, and which of them do not do so always."""
    if not count:
        return
    some = sorted(" with ".join(sorted(pair)) for pair, reason in why.items() if reason != ALWAYS)
    rest = f"; these do not touch always: {', '.join(some)}" if some else ""
    yield f"check: nobody sees contact of {count} pairs of bodies (sdt:mayTouch, each with its reason){rest}"
