"""Forward: where a container goes under forces at its handle; the error of the steps is told by halving."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sdt_kg.errors import MotionError, OracleRejectedError
from services.dynamics.forward.compiled import simulated
from services.dynamics.model import Array, Mechanics, Values, Wave

FIRST_STEP = 1e-3
"""[s] The longest step that is tried."""

SHORTEST_STEP = 1e-6
"""[s] Below this nothing is gained; what has not converged then is refused."""

TOLERANCE = 5e-5
"""[rad or m] Difference to half the step, at every sample, below which a step is short enough."""


@dataclass(frozen=True, slots=True, eq=False)
class Simulated:
    """A container's motion under forces.

    Attributes:
        times: Shape (T,) [s].
        q, v: Shape (T,) [rad or m, and per second].
        step: With which it was computed [s].
        difference: Largest difference at a sample to the motion at twice the step [rad or m].
    """

    times: Array
    q: Array
    v: Array
    step: float
    difference: float


def simulate(  # noqa: PLR0913 - the profile, and the state in which it begins
    mechanics: Mechanics,
    values: Values,
    times: Array,
    force: Array,
    *,
    start: float,
    speed: float = 0.0,
    tolerance: float = TOLERANCE,
    others: Sequence[Values] = (),
) -> Simulated:
    """The motion of the joint under a force of the joint, N or N m, linear between samples.

    A force F at the handle is r F of the joint, r its distance from the axis. Steps are halved until two
    agree within the tolerance at every sample; the finer one is returned.

    Args:
        mechanics: Body, stops and lengths; its intervals are not used.
        values: Of the parameters of its joint.
        times: Shape (T,), increasing [s].
        force: Shape (T,), positive towards open.
        start: Position at the first time, between the stops [rad or m].
        speed: At the first time.
        tolerance: See TOLERANCE.
        others: Of the parameters of each joint that moves with it, in their order.

    Raises:
        MotionError: The samples are no force profile, or not each joint has its parameters.
        OracleRejectedError: No step above SHORTEST_STEP reaches the tolerance.
    """
    _check(times, force)
    if not mechanics.lower <= start <= mechanics.upper:
        raise MotionError(
            f"a start at {start:.4g}", allowed=f"between {mechanics.lower:.4g} and {mechanics.upper:.4g}"
        )
    joints = _joints(mechanics, values, others)
    folded, lifted = _carried(mechanics, (values, *others))
    stops = np.array([mechanics.lower, mechanics.upper])
    step, coarse = FIRST_STEP, None
    while step >= SHORTEST_STEP:
        q, v = simulated(times, force, start, speed, step, joints, folded, lifted, stops)
        if coarse is not None and (difference := float(np.abs(q - coarse).max())) <= tolerance:
            return Simulated(times, q, v, step, difference)
        coarse, step = q, step / 2
    raise OracleRejectedError(
        f"the motion of {mechanics.joint} did not converge to {tolerance:g} with steps of {step * 2:.1e} s"
    )


def _joints(mechanics: Mechanics, values: Values, others: Sequence[Values]) -> Array:
    """A row for each joint: ratio, offset, parameters, body, lengths."""
    if len(others) != len(mechanics.others):
        raise MotionError(
            f"parameters of {len(others)} joints that move along", allowed=f"{len(mechanics.others)}"
        )
    rows = list[Array]()
    for each, own in zip(mechanics.moving, (values, *others), strict=True):
        load, forces = each.mechanics.load, each.mechanics.forces
        body = (load.inertia, load.cosine, load.sine, load.constant)
        if each.mechanics.fold is not None:
            body = (0.0, 0.0, 0.0, 0.0)
        lengths = (forces.rest, forces.latch_width, forces.closer_range)
        rows.append(np.concatenate([(each.ratio, each.offset), own.array(), body, lengths]))
    return np.stack(rows)


def _carried(mechanics: Mechanics, values: Sequence[Values]) -> tuple[Array, Array]:
    """Inertia and weight of panels that others carry: rows size, rate, phase of waves of the first joint."""
    inertia, weight = list[tuple[float, Wave]](), list[tuple[float, Wave]]()
    for each, own in zip(mechanics.moving, values, strict=True):
        fold = each.mechanics.fold
        if fold is None:
            continue
        still = Wave(np.array([fold.turned]), np.zeros(1), np.zeros(1))
        inertia += [(own.mass, fold.carried), (own.mass * own.weight, fold.mixed)]
        inertia += [(own.mass * own.inertia, still)]
        weight += [(own.mass, fold.weight_carried), (own.mass * own.weight, fold.weight_own)]
    return _rows(inertia), _rows(weight)


def _rows(waves: list[tuple[float, Wave]]) -> Array:
    """Shape (K, 3); waves times factors."""
    rows = [np.column_stack([factor * wave.size, wave.rate, wave.phase]) for factor, wave in waves]
    return np.concatenate([np.zeros((0, 3)), *rows])


def _check(times: Array, force: Array) -> None:
    if times.ndim != 1 or len(times) < 2 or force.shape != times.shape:
        what = f"times of shape {times.shape} and forces of shape {force.shape}"
        raise MotionError(what, allowed="two samples or more, as many forces as times")
    if not (np.isfinite(times).all() and np.isfinite(force).all() and (np.diff(times) > 0).all()):
        raise MotionError("a force profile with gaps", allowed="finite numbers at increasing times")
