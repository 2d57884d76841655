"""Fits as joints: axis, place, positions of the samples, limits, standard deviations, evidence."""

import math

import numpy as np

from predicates.learn.articulation import Articulation
from predicates.learn.fitting.cells import Cells
from predicates.learn.fitting.curve import Curves
from predicates.learn.fitting.fit import ARC, LINE, Fit
from predicates.learn.fitting.priors import (
    SCALE_WEIGHT,
    STILL_SCALE,
    TURN_SCALE,
    Plumb,
    log_scale_density,
    log_travel_density,
)
from predicates.learn.fitting.student import FREEDOM, log_student
from predicates.learn.fitting.turning import Turning
from predicates.learn.track import Array, Track
from sdt_kg.mechanism import JointType

OUTLIER = 5.0
"""[1] Scales from the path beyond which a sample counts as an outlier and bounds no limit."""

SMOOTHING = 7
"""[1] Samples whose median bounds a limit, so that noise does not widen it."""

CONTRADICTED = 2.0
"""[1] Standard deviations from where the track alone shows an axis, beyond which that speaks against gravity:
then the axis is as uncertain as the two are apart."""

ROUNDS = 30
"""[1] Rounds of reweighting of a point that stands still."""


def still(track: Track, cells: Cells, turning: Turning | None) -> Articulation:
    """The candidate that nothing moves."""
    expected = math.hypot(STILL_SCALE, cells.noise)
    origin, scale = np.median(track.positions, axis=0), expected
    squares, pull = np.zeros(0), cells.weights
    for _ in range(ROUNDS):
        squares = ((cells.points - origin) ** 2).sum(axis=1)
        pull = cells.weights * (FREEDOM + 3) / (FREEDOM + squares / scale**2)
        known = SCALE_WEIGHT * expected**2
        scale = math.sqrt((float(pull @ squares) / 3 + known) / (pull.sum() + SCALE_WEIGHT))
        origin = pull @ cells.points / pull.sum()
    evidence = float(log_student(squares, scale, 3) @ cells.weights)
    evidence += log_scale_density(scale, expected)
    spread = scale / math.sqrt(float(pull.sum()))
    evidence += 1.5 * math.log(2 * math.pi) + 3 * math.log(spread)
    if turning is not None:
        evidence += turning.evidence_still()
    distances = np.linalg.norm(track.positions - origin, axis=1)
    return Articulation(
        JointType.FIXED, np.zeros(3), origin, 0.0, np.zeros(len(distances)), (0.0, 0.0), distances,
        scale, int((distances > OUTLIER * scale).sum()), {"origin": spread}, evidence, Plumb.FREE, (0.0, 0.0),
        None, max(cells.extent, STILL_SCALE),
    )  # fmt: skip


def moving(
    track: Track, family: list[tuple[Plumb, Fit, float]], turning: Turning | None, cells: Cells
) -> Articulation:
    """The best fit of a family as a joint, with the evidence of the whole family, orientations included."""
    told = [each + _turned(track, one, turning) for _, one, each in family]
    plumb, best, _ = family[int(np.argmax(told))]
    evidence = float(np.logaddexp.reduce(told)) + log_travel_density(cells.travel)
    curve, revolute = best.curve, best.free == ARC
    distances = np.linalg.norm(curve.residuals(track.positions)[0], axis=1)
    along = curve.progress(track.positions)[0]
    radius = 1 / float(curve.curvature[0]) if revolute else 0.0
    axis = _axis(best)
    unsure = best.scale / radius if revolute else 0.0
    steady = distances <= OUTLIER * best.scale
    steady = steady if steady.any() else np.ones_like(steady)
    raw = _raw_positions(along, axis, radius, unsure, turning)
    raw = raw if radius == 0 else _unwrapped(raw, steady)
    zero = _zero(raw, steady, cells)
    positions = raw - zero
    if -positions[steady].min() > positions[steady].max():
        axis, positions, curve, zero = -axis, -positions, _reversed(curve), -zero
    deviations = _deviations(best, len(track.positions), cells) | {"zero": zero}
    swung = _swung(best, family[0][1], len(track.positions), cells)
    if swung[0] > CONTRADICTED * swung[1]:
        deviations["axis"] = math.hypot(deviations["axis"], swung[0])
    anchor = curve.anchor[0]
    origin = anchor + radius * curve.inward[0] if revolute else anchor + zero * axis
    smooth = _smooth(positions[steady])
    limits = (float(smooth.min()), float(smooth.max()))
    if revolute:  # an angle is a length on the arc by the radius, which is not certain either
        share = deviations["radius"] / radius
        deviations["limits"] = math.hypot(deviations["limits"], max(map(abs, limits)) * share)
    kind = JointType.REVOLUTE if revolute else JointType.PRISMATIC
    return Articulation(
        kind, axis, origin, radius, positions, limits, distances, best.scale, int((~steady).sum()),
        deviations, evidence, plumb, swung, curve, cells.extent,
    )  # fmt: skip


def _turned(track: Track, one: Fit, turning: Turning | None) -> float:
    """Log evidence of the orientations, if the path is the fit's."""
    if turning is None:
        return 0.0
    if one.free != ARC:
        return turning.evidence_still()
    curve, curvature = one.curve, float(one.curve.curvature[0])
    angles = curve.progress(track.positions)[0] * curvature
    return turning.evidence_turning(curve.normal[0], angles, one.scale * curvature)


def _raw_positions(along: Array, axis: Array, radius: float, unsure: float, turning: Turning | None) -> Array:
    """Joint positions from any zero: of orientations where they say more than places."""
    if radius == 0:
        return along
    if turning is not None and turning.seen is not None and unsure > TURN_SCALE:
        return turning.vectors @ axis
    return along / radius


def _unwrapped(angles: Array, steady: np.ndarray) -> Array:
    """A hinge's angles without jumps by a turn, shape (T,); what is off the curve is as what is beside it."""
    index = np.flatnonzero(steady)
    near = np.interp(np.arange(len(angles)), index, np.unwrap(angles[index]))
    return near + np.remainder(angles - near + math.pi, 2 * math.pi) - math.pi


def _smooth(positions: Array) -> Array:
    """Running median, shape (T,); the ends are repeated, so that a short track keeps its range."""
    padded = np.pad(positions, SMOOTHING // 2, mode="edge")
    return np.median(np.lib.stride_tricks.sliding_window_view(padded, SMOOTHING), axis=1)


def _zero(raw: Array, steady: np.ndarray, cells: Cells) -> float:
    """Position at which the track begins: the median of its first cell's samples.

    Where a hinge comes round to where it began, the samples after the turn are in that cell, too.
    """
    steady = steady & (cells.members >= 0) if (steady & (cells.members >= 0)).any() else steady
    begin = int(np.argmax(steady))
    first = (cells.members == cells.members[begin]) & (np.abs(raw - raw[begin]) < math.pi)
    return float(np.median(raw[first & steady]))


def _reversed(curve: Curves) -> Curves:
    """The same curve, run through the other way."""
    return Curves(curve.anchor, -curve.tangent, curve.inward, curve.curvature)


def _axis(one: Fit) -> Array:
    return one.curve.normal[0] if one.free == ARC else one.curve.tangent[0]


def _swung(best: Fit, free: Fit, samples: int, cells: Cells) -> tuple[float, float]:
    """Angle from the axis that the track alone shows, and its standard deviation [rad]."""
    if best is free:
        return 0.0, 0.0
    angle = math.acos(min(1.0, abs(float(_axis(best) @ _axis(free)))))
    return angle, _deviations(free, samples, cells)["axis"]


def _deviations(best: Fit, samples: int, cells: Cells) -> dict[str, float]:
    """Standard deviations of what people read, from the covariance of the parameters."""
    variance = np.diag(best.covariance)
    per_cell = samples / max(len(cells.points), 1)
    end = best.scale / math.sqrt(max(per_cell, 1.0))
    if best.free == LINE:
        lateral = float(np.sqrt(variance[0:2].max()))
        return {"axis": float(np.sqrt(variance[2:4].max())), "origin": lateral, "limits": end}
    radius = 1 / float(best.curve.curvature[0])
    direction = best.parameters[4:6] * radius
    spread = radius**2 * math.sqrt(float(direction @ best.covariance[4:6, 4:6] @ direction))
    across = np.array([-direction[1], direction[0]])
    # the plane turns with the tangent (along it) and with the curvature vector (across it)
    swing = radius * math.sqrt(float(across @ best.covariance[4:6, 4:6] @ across))
    tilt = math.sqrt(float(across @ best.covariance[2:4, 2:4] @ across))
    inwards = math.sqrt(float(direction @ best.covariance[0:2, 0:2] @ direction))
    return {
        "axis": max(swing, tilt),
        "origin": math.hypot(spread, inwards),
        "radius": spread,
        "limits": end / radius,
    }
