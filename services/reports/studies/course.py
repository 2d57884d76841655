"""What a piece of evidence measures, along a whole motion: a joint, or a distance, against its bounds."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from predicates.case import Evidence, Quantity, Verdict
from sdt_kg.iri import local_name
from sdt_kg.motion import BodyMotion
from services.embodiment.certify.motion import whole_motion
from services.embodiment.certify.sweep.pieces import Pieces
from services.embodiment.certify.tolerances import Tolerances
from services.physics.model import Scene
from services.reports.pages.figure import Figure, drawn
from services.reports.scene.gap import gap

Array = NDArray[np.float64]

SAMPLES = 240
"""[1] Points of a curve."""

MOST = 4
"""[1] Curves in a figure; the first reasons come first."""

ORDER = {Quantity.POSITION: 0, Quantity.VELOCITY: 1, Quantity.ACCELERATION: 2}


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """One quantity along a motion.

    Attributes:
        title: What is measured.
        unit: Of it.
        times: Shape (T,) [s].
        values: Shape (T,).
        bounds: What it had to keep: none, one or two.
        marks: (time, value) of what the certifier found, between the samples too.
    """

    title: str
    unit: str
    times: Array
    values: Array
    bounds: tuple[float, ...]
    marks: tuple[tuple[float, float], ...]


def courses(verdict: Verdict, scene: Scene, motion: BodyMotion) -> tuple[Course, ...]:
    """The quantities of a verdict's reasons along the motion that it is about, each once."""
    evidence = [each.evidence for each in verdict.diagnoses if each.evidence is not None]
    groups: dict[object, list[Evidence]] = {}
    for each in evidence:
        if each.time is not None and (each.quantity in ORDER or each.links is not None):
            groups.setdefault((each.quantity, each.links or each.entity), []).append(each)
    pieces, _ = whole_motion(scene, motion, Tolerances())
    times = np.linspace(motion.times[0], motion.times[-1], SAMPLES)
    at = np.clip(np.searchsorted(pieces.start, times, side="right") - 1, 0, len(pieces.start) - 1)
    states = pieces.at(at, times - pieces.start[at])
    found = (_course(scene, group, times, states, pieces) for group in groups.values())
    return tuple(each for each in found if each is not None)[:MOST]


def _course(
    scene: Scene, group: list[Evidence], times: Array, states: tuple[Array, Array, Array], pieces: Pieces
) -> Course | None:
    first = group[0]
    marks = tuple((float(each.time), each.value) for each in group if each.time is not None)
    bounds = tuple(sorted({each.bound for each in group if np.isfinite(each.bound)}))
    if first.links is not None:
        found = [gap(scene, q, first.links) for q in states[0]]
        values = np.array([np.nan if each is None else 1000 * each[0] for each in found])
        title = f"distance of {' and '.join(map(local_name, first.links))}"
        scaled = tuple(1000 * each for each in bounds), tuple((time, 1000 * value) for time, value in marks)
        return Course(title, "mm", times, values, *scaled)
    if first.entity not in scene.coordinate:
        return None
    order, k = ORDER[first.quantity], scene.coordinate[first.entity]
    values = states[order][:, k]
    if order > 0:
        marks = tuple((time, on_curve(pieces, order, k, time, value)) for time, value in marks)
    limits = tuple(_limits(scene, first))
    return Course(
        f"{first.quantity.value} of {local_name(first.entity)}",
        first.unit,
        times,
        values,
        limits or bounds,
        marks,
    )


def on_curve(pieces: Pieces, order: int, k: int, time: float, size: float) -> float:
    """A speed or acceleration with the sign that the curve has there: a limit is told of its size alone.

    Args:
        pieces: Of the motion.
        order: 1 for velocity, 2 for acceleration, which may leap where two pieces meet.
        k: Coordinate.
        time: Of the motion's clock [s].
        size: What was found, with or without its sign.
    """
    after = min(max(int(np.searchsorted(pieces.start, time, side="right")) - 1, 0), len(pieces.start) - 1)
    met = np.array([max(after - 1, 0), after])
    both = pieces.at(met, np.minimum(time - pieces.start[met], pieces.duration[met]))[order][:, k]
    return math.copysign(size, both[np.argmin(np.abs(np.abs(both) - abs(size)))])


def _limits(scene: Scene, evidence: Evidence) -> Iterator[float]:
    """Both limits of a joint for a quantity, where it has them."""
    k = scene.coordinate[str(evidence.entity)]
    bounds = scene.bounds
    pairs = {
        Quantity.POSITION: (bounds.lower[k], bounds.upper[k]),
        Quantity.VELOCITY: (-bounds.velocity[k], bounds.velocity[k]),
        Quantity.ACCELERATION: (-bounds.acceleration[k], bounds.acceleration[k]),
    }
    return (float(each) for each in pairs[evidence.quantity] if np.isfinite(each))


def courses_figure(found: tuple[Course, ...], motion: BodyMotion, name: str) -> Figure:
    """The courses, at least one, one below the other, over the phases of the motion."""
    with drawn(0.5 + 1.25 * len(found)) as drawing:
        every = drawing.subplots(len(found), 1, sharex=True, squeeze=False)[:, 0]
        for axes, one in zip(every, found, strict=True):
            axes.plot(one.times, one.values, color="#3c5a7d")
            for bound in one.bounds:
                axes.axhline(bound, color="#c22026", linewidth=0.9, linestyle="--")
            if one.marks:
                axes.plot(*zip(*one.marks, strict=True), "o", color="#c22026", markersize=4)
            axes.set_title(one.title, loc="left")
            axes.set_ylabel(one.unit)
            for _, begin in motion.phases:
                axes.axvline(motion.times[begin], color="#9a9aa2", linewidth=0.6)
        phases = ", ".join(phase for phase, _ in motion.phases)
        every[-1].set_xlabel(f"s; grey: {phases}" if phases else "s")
    caption = (
        "What the reasons measure, along the motion. Dashed: what had to be kept; dots: what the certifier"
        " found, which looks between the samples too."
    )
    return Figure(name, caption, drawing)
