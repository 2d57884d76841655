"""What of a verdict is shown in the picture: who is red, when, and between which points."""

import math
import re
from dataclasses import dataclass
from enum import Enum
from typing import Final

from predicates.case import Diagnosis, Evidence, Kind, Quantity
from sdt_kg.iri import Iri, body_iri, local_name

Point = tuple[float, float, float]

_NEAREST: Final = re.compile(r"nearest \((.+?)\): (.+) and (.+), (-?[\d.]+) mm at (-?[\d.]+) s")
"""How a certificate tells its closest pairs."""


class What(Enum):
    """What a mark shows."""

    CONTACT = "contact"
    LIMIT = "limit"
    NEAREST = "closest pair"
    REGION = "region of a proof"
    REACH = "reach"


@dataclass(frozen=True, slots=True)
class Box:
    """A box in the world: its middle [m], quaternion xyzw, and full sides [m]."""

    middle: Point
    orientation: tuple[float, float, float, float]
    sides: Point


@dataclass(frozen=True, slots=True)
class Mark:
    """One thing to look at.

    Attributes:
        text: What it is, in a line.
        reason: Index of the diagnosis that it belongs to; None for a certificate's.
        bodies: IRIs of those that are coloured.
        time: Of the motion's clock [s]; None where it has none.
        ends: Two points that a line joins, in the world [m].
        joint: IRI of the joint whose limit is meant.
        bound: Its limit that was passed [rad or m]; not a number for limits of speed.
        boxes: A region.
    """

    what: What
    text: str
    reason: int | None = None
    bodies: tuple[Iri, ...] = ()
    time: float | None = None
    ends: tuple[Point, Point] | None = None
    joint: Iri | None = None
    bound: float = math.nan
    boxes: tuple[Box, ...] = ()


def marks_of(diagnoses: tuple[Diagnosis, ...]) -> tuple[Mark, ...]:
    """Marks of the reasons of a refusal, as far as they can be shown; points are measured elsewhere."""
    # What a proof measured is a value of the container; its region says more.
    proved = {index for index, each in enumerate(diagnoses) if each.proof and each.kind is Kind.EMBODIMENT}
    found = (_mark(k, each.evidence) for k, each in enumerate(diagnoses) if k not in proved)
    return tuple(mark for mark in found if mark is not None)


def nearest_of(notes: tuple[str, ...], models: tuple[str, str]) -> tuple[Mark, ...]:
    """Marks of the closest pairs that a certificate names.

    Args:
        notes: Of CanPerform's answer.
        models: Names of kitchen and robot; a pair is two bodies of the robot, or one of each.
    """
    marks: list[Mark] = []
    for note in notes:
        told = _NEAREST.fullmatch(note)
        if told is not None:
            scope, one, other, distance, time = told.groups()
            kitchen, robot = models
            pair = body_iri(robot, one), body_iri(robot if scope == "self" else kitchen, other)
            text = f"nearest, {scope}: {one} and {other}, {distance} mm"
            marks.append(Mark(What.NEAREST, text, bodies=pair, time=float(time)))
    return tuple(marks)


def _mark(index: int, evidence: Evidence | None) -> Mark | None:
    if evidence is None:
        return None
    if evidence.links is not None:
        names = " and ".join(map(local_name, evidence.links))
        text = f"{names}: {_told(evidence)}"
        return Mark(What.CONTACT, text, index, bodies=evidence.links, time=evidence.time)
    limited = {Quantity.POSITION, Quantity.VELOCITY, Quantity.ACCELERATION}
    if evidence.entity is None or evidence.quantity not in limited or "/joint/" not in evidence.entity:
        return None
    text = f"{local_name(evidence.entity)}: {_told(evidence)}"
    bound = evidence.bound if evidence.quantity is Quantity.POSITION else math.nan
    return Mark(What.LIMIT, text, index, time=evidence.time, joint=evidence.entity, bound=bound)


def _told(evidence: Evidence) -> str:
    unit = "" if evidence.unit == "1" else f" {evidence.unit}"
    if evidence.quantity is Quantity.COUNT:
        return f"in the way {evidence.value:.0f} times in the search"
    bound = "" if math.isnan(evidence.bound) else f", bound {evidence.bound:.4g}{unit}"
    return f"{evidence.quantity.value} {evidence.value:.4g}{unit}{bound}"
