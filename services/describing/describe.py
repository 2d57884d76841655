"""The first annotation of a robot, whole."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from sdt_kg.annotation import RobotAnnotation
from sdt_kg.describe import guessed, turtle
from sdt_kg.urdf import read_mechanism
from services.describing.parking import parked
from services.describing.touching import ALWAYS, Pair, touching


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
    """
    mechanism = read_mechanism(urdf)
    robot = guessed(mechanism)
    why = touching(mechanism, robot)
    allowed = robot.allowed_contacts | why.keys()
    notes = (*robot.notes, *_of_pairs(len(allowed), why))
    robot = parked(urdf, replace(robot, allowed_contacts=allowed, notes=notes))
    return Described(robot, turtle(robot, urdf.name, why), (*mechanism.notes, *robot.notes))


def _of_pairs(count: int, why: Mapping[Pair, str]) -> Iterator[str]:
    """How many pairs may touch, and which of them do not do so always."""
    if not count:
        return
    some = sorted(" with ".join(sorted(pair)) for pair, reason in why.items() if reason != ALWAYS)
    rest = f"; these do not touch always: {', '.join(some)}" if some else ""
    yield f"check: nobody sees contact of {count} pairs of bodies (sdt:mayTouch, each with its reason){rest}"
