"""Limits of position, velocity and acceleration; exact between samples."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from predicates.case import Evidence, Quantity
from sdt_kg.iri import local_name
from sdt_kg.mechanism import JointType
from sdt_kg.numbers import told_apart
from sdt_kg.twin import Container
from services.embodiment.certify.findings import Findings, Violation
from services.embodiment.certify.sweep.kinematics import joint_axes, unit_of
from services.embodiment.certify.sweep.pieces import (
    Pieces,
    accelerations,
    ahead,
    positions,
    velocities,
)
from services.embodiment.certify.tolerances import Tolerances
from services.physics.model import Scene
from services.physics.tree import Bounds

Array = NDArray[np.float64]

STILL = 1e-6  # [rad or m] rounding of what does not move
SUBSAMPLES = 32  # of the base's speed on each piece; what lies between is bounded


def joint_limits(scene: Scene, pieces: Pieces, container: Container, tolerances: Tolerances) -> Findings:
    """Every coordinate keeps its limits; the base's linear ones hold for the length of the vector too."""
    findings, bounds = Findings(), _bounds(scene, container)
    findings.add(position_limits(scene, pieces, container, tolerances))
    findings.add(_slowing(scene, pieces, tolerances))
    own, moved = pieces.moving, pieces.moved
    rated = (
        (Quantity.VELOCITY, velocities(moved), bounds.velocity[own]),
        (Quantity.ACCELERATION, accelerations(moved), bounds.acceleration[own]),
    )
    for quantity, (rates, at), most in rated:
        ratio = _ratio(np.abs(rates), most)
        for j, i, n in first_and_worst(ratio > 1 + tolerances.rate, ratio):
            time, k = pieces.start[n] + at[i, n, j], int(own[j])
            findings.violations.append(
                _limit(scene, k, quantity, abs(rates[i, n, j]), float(most[j]), time, ratio[i, n, j])
            )
        findings.figures[f"largest {quantity.value} ratio"] = (float(ratio.max(initial=0.0)), "1")
    findings.add(_base_norms(scene, pieces, tolerances))
    findings.add(_unbounded(scene, pieces, scene.coordinate[container.joint], bounds))
    return findings


def position_limits(scene: Scene, pieces: Pieces, container: Container, tolerances: Tolerances) -> Findings:
    """What moves keeps its limits all the time; what stands still, at the start."""
    findings, begin, bounds = Findings(), pieces.c[0, 0], _bounds(scene, container)
    may = np.maximum(bounds.lower - begin, begin - bounds.upper) > tolerances.position
    may[pieces.moving] = True
    own = np.flatnonzero(may)
    (values, s), lower, upper = positions(pieces.columns(own)), bounds.lower[own], bounds.upper[own]
    excess = np.maximum(lower - values, values - upper)
    for j, i, n in first_and_worst(excess > tolerances.position, excess):
        bound = float((lower if values[i, n, j] < lower[j] else upper)[j])
        time, k = pieces.start[n] + s[i, n, j], int(own[j])
        findings.violations.append(
            _limit(scene, k, Quantity.POSITION, values[i, n, j], bound, time, excess[i, n, j])
        )
    return findings


def _slowing(scene: Scene, pieces: Pieces, tolerances: Tolerances) -> Findings:
    """What a safety controller slows near its limits is slow enough there not to lag behind.

    Where the gain is k, v ≤ k (upper − q): the joint stays within its limits where it would be in 1/k at
    this speed. A joint that may be `tolerances.lag` beyond them then is never farther behind the motion,
    since it comes nearer at k times what it is farther. One that is beyond its limits, and goes no farther,
    is told by `position_limits`.
    """
    findings, bounds = Findings(), scene.bounds
    own = pieces.moving[np.isfinite(bounds.gain[pieces.moving])]
    values, s = positions(ahead(pieces.columns(own), 1.0 / bounds.gain[own]))
    lower, upper = bounds.lower[own], bounds.upper[own]
    excess = np.maximum(lower - values, values - upper)
    for j, i, n in first_and_worst(excess > tolerances.lag, excess):
        k, at = int(own[j]), float(s[i, n, j])
        q, v, _ = (float(each[0, k]) for each in pieces.at(np.array([n]), np.array([at])))
        room, speed = (upper[j] - q, v) if values[i, n, j] > upper[j] else (q - lower[j], -v)
        if room < -tolerances.position and speed <= tolerances.lag * bounds.gain[k]:
            continue
        room = max(float(room), 0.0)
        least = room * float(bounds.gain[k])
        unit, time = unit_of(scene, k), float(pieces.start[n] + at)
        fast, slow = told_apart(speed, least, 4)
        reason = (
            f"{local_name(scene.names[k])} moves at {fast} {unit}/s, {room:.3g} {unit} before "
            f"its limit, where its safety controller lets it move at {slow} {unit}/s"
        )
        evidence = Evidence(Quantity.VELOCITY, speed, least, f"{unit}/s", scene.names[k], time=time)
        violation = Violation("slowed near its limit: robot", reason, evidence, float(excess[i, n, j]))
        findings.violations.append(violation)
    return findings


def _unbounded(scene: Scene, pieces: Pieces, own: int, bounds: Bounds) -> Findings:
    """The container and each joint of the robot that moves have limits, or those of what they mimic."""
    most = {
        Quantity.POSITION: np.maximum(bounds.upper, -bounds.lower),
        Quantity.VELOCITY: bounds.velocity,
        Quantity.ACCELERATION: bounds.acceleration,
    }
    turning = {
        k for k, one in enumerate(scene.robot.joints, scene.robot.first) if one.type is JointType.CONTINUOUS
    }
    endless = turning.union(scene.base.tolist(), [own])  # of the container, its scope asks for limits
    findings = Findings()
    for k in pieces.moving.tolist():
        if k != own and (k < scene.base[0] or scene.coupling.source[k] != k):
            continue
        for quantity, all_of in most.items():
            if np.isfinite(all_of[k]) or (quantity is Quantity.POSITION and k in endless):
                continue
            name = local_name(scene.names[k])
            how = "far" if quantity is Quantity.POSITION else "fast"
            reason = f"{name} moves, and nothing says how {how}: it has no limit of {quantity.value}"
            evidence = Evidence(Quantity.COUNT, 0.0, 1.0, "1", scene.names[k])
            findings.violations.append(Violation(f"no limit of {quantity.value}", reason, evidence, 0.0))
    return findings


def _bounds(scene: Scene, container: Container) -> Bounds:
    """The scene's limits, and for the container's joint also those that are in effect for a container."""
    k, bounds = scene.coordinate[container.joint], scene.bounds
    velocity, acceleration = bounds.velocity.copy(), bounds.acceleration.copy()
    velocity[k] = min(velocity[k], container.velocity)
    acceleration[k] = min(acceleration[k], container.acceleration)
    return replace(bounds, velocity=velocity, acceleration=acceleration)


def _ratio(value: Array, most: Array) -> Array:
    """Ratio to the limit, where nothing of a limit of nothing is no violation."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(value == 0, 0.0, value / most)


def first_and_worst(violated: NDArray[np.bool_], badness: Array) -> Iterator[tuple[int, int, int]]:
    """For each coordinate k, candidate i and piece n of its first and of its worst violation."""
    for k in np.flatnonzero(violated.any(axis=(0, 1))):
        n = int(np.argmax(violated[:, :, k].any(axis=0)))
        yield int(k), int(np.argmax(violated[:, n, k])), n
        i, n = np.unravel_index(np.argmax(badness[:, :, k]), badness.shape[:2])
        yield int(k), int(i), int(n)


def _limit(  # noqa: PLR0913, PLR0917  # the parts of one sentence
    scene: Scene,
    k: int,
    quantity: Quantity,
    value: float,
    bound: float,
    time: float,
    excess: float,
    combined: bool = False,
) -> Violation:
    turning = joint_axes(scene)[1][k]
    unit = ("rad" if turning else "m") + _PER[quantity]
    name = "the base, x and y combined," if combined else local_name(scene.names[k])
    reached, limit = told_apart(value, bound, 4)
    reason = f"{name} reaches {quantity.value} {reached} {unit}, its limit is {limit} {unit}"
    evidence = Evidence(quantity, float(value), float(bound), unit, entity=scene.names[k], time=float(time))
    part = "kitchen" if k < scene.base[0] else "base" if k <= scene.base[2] else "robot"
    part += ", combined" if combined else ""
    return Violation(f"limit of {quantity.value}: {part}", reason, evidence, float(excess))


_PER = {Quantity.POSITION: "", Quantity.VELOCITY: "/s", Quantity.ACCELERATION: "/s2"}


def _base_norms(scene: Scene, pieces: Pieces, tolerances: Tolerances) -> Findings:
    findings, plane = Findings(), scene.base[:2]
    most_v, most_a = scene.bounds.velocity[plane[0]], scene.bounds.acceleration[plane[0]]
    part = np.linspace(0, 1, SUBSAMPLES + 1)[:, None]
    s = part * pieces.duration
    base = pieces.columns(plane)
    _, c1, c2, c3 = base.c
    x, y = (c1[:, k] + s * (2 * c2[:, k] + 3 * s * c3[:, k]) for k in (0, 1))
    speed = np.sqrt(x**2 + y**2)
    # A quadratic leaves its chord by at most (width²/8)·|second derivative|.
    between = (pieces.duration / SUBSAMPLES) ** 2 / 8 * 6 * np.linalg.norm(c3, axis=1)
    values, at = accelerations(base)
    acceleration = np.linalg.norm(values, axis=2)
    rated = (
        (Quantity.VELOCITY, speed + between, s, most_v),
        (Quantity.ACCELERATION, acceleration, at[:, :, 0], most_a),
    )
    for quantity, value, s_of, most in rated:
        ratio = _ratio(value, most)[:, :, None]
        for _, i, n in first_and_worst(ratio > 1 + tolerances.rate, ratio):
            time = pieces.start[n] + s_of[i, n]
            findings.violations.append(
                _limit(scene, int(plane[0]), quantity, value[i, n], float(most), time, ratio[i, n, 0], True)
            )
        findings.figures[f"largest base {quantity.value} ratio"] = (float(ratio.max()), "1")
    return findings


def kitchen_keeps(scene: Scene, pieces: Pieces, container: Container, tolerances: Tolerances) -> Findings:
    """The container moves, and of the kitchen nothing else but what is coupled to it."""
    findings, source = Findings(), scene.coupling.source
    own, begin = scene.coordinate[container.joint], pieces.c[0, 0]
    if not (np.abs(pieces.of(own) - begin[own]) > STILL).any():
        unit = unit_of(scene, own)
        evidence = Evidence(Quantity.POSITION, 0.0, STILL, unit, container.joint)
        findings.violations.append(Violation("moves", f"{container.name} does not move", evidence, 0.0))
    others = pieces.moving[pieces.moving < scene.base[0]]
    others = others[source[others] != source[own]]
    values, s = positions(pieces.columns(others))
    moved = np.abs(values - begin[others])
    for j, i, n in first_and_worst(moved > tolerances.position, moved):
        k = int(others[j])
        value, time = float(moved[i, n, j]), float(pieces.start[n] + s[i, n, j])
        unit = unit_of(scene, k)
        evidence = Evidence(Quantity.POSITION, value, 0.0, unit, scene.names[k], time=time)
        reason = (
            f"{local_name(scene.names[k])} moves by {value:.4g} {unit}, and it is no part of {container.name}"
        )
        findings.violations.append(Violation("kitchen stands still", reason, evidence, value))
    return findings
