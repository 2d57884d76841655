"""What of a verdict is shown in the picture: who is red, when, and between which points."""

import math
from dataclasses import dataclass
from enum import Enum

from predicates.case import Answer, Diagnosis, Evidence, Kind, Quantity
from predicates.margins import SMALLEST
from sdt_kg.iri import Iri, local_name

Point = tuple[float, float, float]


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


def nearest_of(performed: Answer) -> tuple[Mark, ...]:
    """Marks of the closest pairs of a certificate; stores of earlier versions name none."""
    marks: list[Mark] = []
    for name, pair in performed.nearest_pairs.items():
        between = " and ".join(map(local_name, pair.links))
        distance = performed.figures[name][0] * 1000
        text = f"nearest, {name.removeprefix(SMALLEST)}: {between}, {distance:.1f} mm"
        marks.append(Mark(What.NEAREST, text, bodies=pair.links, time=pair.time))
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
