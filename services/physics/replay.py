r"""Φ of Eq. (6): what a container's motion makes of the kitchen, rigid-body kinematics only.

Eq. (3): the state after τ differs from the state before in the joint that τ moves, and in those
which follow it. Friction, springs, and the mass of what is inside are outside D_artic.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from predicates.case import Code, Diagnosis, Evidence, Kind, Quantity
from predicates.oracle import Replayed
from sdt_kg.errors import MotionError
from sdt_kg.iri import Iri, local_name
from sdt_kg.mechanism import JointType
from sdt_kg.motion import Motion, check_numbers, check_times
from sdt_kg.numbers import told_apart
from sdt_kg.state import State
from sdt_kg.twin import Twin
from services.physics.chain import Chain, Follower, chain, follower
from services.physics.spline import Excess, Hermite, at_rest_velocities, excesses
from services.physics.tree import Model

Array = NDArray[np.float64]

START_TOLERANCE = {"m": 0.002, "rad": math.radians(1)}
"""How far from the kitchen's state τ may begin: the tolerance of the tool on the handle."""

BEYOND_STOPS = 1e-5
"""[rad or m] How far beyond its limits a joint may swing, a container's or a robot's: rounding, no more."""

RATE_SLACK = 1e-6
"""[1] Share by which velocity and acceleration may exceed their limits: rounding, nothing else."""

REST_SPEED = 1e-3
"""[rad/s or m/s] What counts as at rest, at the ends of a motion that brings its own velocities."""

POSE_TOLERANCE = 0.002
"""[m] How far a pose path may leave the joint's motion: the tolerance of the tool on the handle."""

ANGLE_TOLERANCE = math.radians(1)
"""[rad] See POSE_TOLERANCE."""

UNIT_NORM_TOLERANCE = 1e-3
"""[1] How far a quaternion's norm may be from 1 to be normalised rather than refused."""


@dataclass(frozen=True, slots=True)
class Bounds:
    """Effective limits of a joint, over everything that is coupled to it; lengths in `unit`."""

    lower: float
    upper: float
    velocity: float
    acceleration: float
    unit: str


def replay(model: Model, twin: Twin, motion: Motion) -> Replayed:
    r"""Final state when the kitchen follows the motion, :math:`\Phi_{sim}(G, \tau)`.

    Args:
        model: Built from the twin's environment; its root is the kitchen's root link.
        twin: The kitchen in the state in which the motion begins.
        motion: Articulation values, or poses of any frame that moves with the container.

    Raises:
        MotionError: Samples which are no motion: shape, order, numbers.
        DisconnectedFrameError: The frame or joint is not moved by anything.
    """
    check_samples(motion)
    violations: list[Diagnosis] = []
    if motion.is_poses:
        followed, motion, violations = _from_poses(model, twin, motion)
    else:
        followed = follower(model, motion.of)
    bounds = effective_bounds(model, twin, followed)
    values = motion.values[:, 0]
    began = followed.multiplier * twin.state.get(followed.active, 0.0) + followed.offset
    violations += _start(motion, began, bounds)
    violations += _limits(motion, bounds)
    end = min(max(float(values[-1]), bounds.lower), bounds.upper)
    active = (end - followed.offset) / followed.multiplier
    return Replayed(state_with(model, twin, followed.active, active), motion, tuple(violations))


def state_with(model: Model, twin: Twin, active: Iri, position: float) -> State:
    """The twin's state with an actuated joint, and all that follow it, elsewhere."""
    state = {**dict(twin.state.positions), active: position}
    for joint in _mimics(model, active):
        if joint.own in state:
            state[joint.own] = joint.multiplier * position + joint.offset
    return State.of(state)


@lru_cache(maxsize=1)
def spline_of(motion: Motion) -> Hermite:
    """The motion between its samples, at rest at its ends unless it brings its own velocities.

    That of the last motion is kept: its limits and its stops are asked about one after the other.
    """
    return Hermite(motion.times, motion.values[:, 0], velocities_of(motion)[:, 0])


def velocities_of(motion: Motion) -> Array:
    """Velocities at the samples, shape (T, 1): its own, or those with which it begins and ends at rest.

    Whoever asks where τ, given as values, is between its samples asks here: all predicates judge one curve.
    """
    return at_rest_velocities(motion.times, motion.values) if motion.velocities is None else motion.velocities


def check_samples(motion: Motion) -> None:
    """The samples are a motion: two or more, finite, increasing in time.

    Raises:
        MotionError: What is wrong, with the index of the first wrong sample.
    """
    times, values = motion.times, motion.values
    check_times(times)
    if values.ndim != 2 or values.shape[0] != len(times) or values.shape[1] not in {1, 7}:
        raise MotionError(
            f"values of shape {values.shape} for {len(times)} times", allowed="shape (T, 1) or (T, 7)"
        )
    check_numbers("values", values)
    if motion.velocities is not None:
        if motion.velocities.shape != (len(times), 1):
            raise MotionError(
                f"velocities of shape {motion.velocities.shape} for {len(times)} times",
                allowed="shape (T, 1)",
            )
        check_numbers("velocities", motion.velocities)


def effective_bounds(model: Model, twin: Twin, followed: Follower) -> Bounds:
    """Limits of the joint; those of the container where it is one, over the whole coupling."""
    joint = model.part.joints[model.coordinate[followed.own] - model.part.first]
    unit = "m" if joint.type is JointType.PRISMATIC else "rad"
    for each in twin.containers():
        if each.active_joint == followed.active:
            scale = followed.multiplier / each.multiplier
            shift = followed.offset - each.offset * scale
            lower, upper = sorted((each.lower * scale + shift, each.upper * scale + shift))
            return Bounds(lower, upper, each.velocity * abs(scale), each.acceleration * abs(scale), unit)
    limits = joint.limits
    return Bounds(limits.lower, limits.upper, limits.velocity, limits.acceleration, unit)


def _mimics(model: Model, active: Iri) -> Iterator[Follower]:
    """Joints that follow the actuated joint."""
    coupling, source = model.coupling, model.coordinate[active]
    for joint, k in model.coordinate.items():
        if coupling.source[k] == source and k != source:
            yield follower(model, joint)


def _from_poses(model: Model, twin: Twin, motion: Motion) -> tuple[Follower, Motion, list[Diagnosis]]:
    """The pose path as articulation values of the frame's own joint."""
    path = chain(model, motion.of, twin.state)
    observed, followed = _matrices(motion.values), path.follower
    bounds = effective_bounds(model, twin, followed)
    values = fitted_positions(path, bounds, twin.state.get(followed.active, 0.0), observed)
    fitted, _ = path.poses((values - followed.offset) / followed.multiplier)
    joint_motion = Motion(followed.own, motion.times, values[:, None], motion.timed)
    return followed, joint_motion, list(_leaving(motion, fitted, observed))


def fitted_positions(path: Chain, bounds: Bounds, began: float, observed: Array) -> Array:
    """Positions of the frame's own joint at which the frame is nearest to the observed poses.

    Args:
        path: How the frame moves.
        bounds: Of the frame's own joint.
        began: Position of the actuated joint in the state before, about which joints without
            limits are searched.
        observed: Shape (T, 4, 4).
    """
    followed = path.follower
    seeds = np.array([began - math.pi, began + math.pi])
    if math.isfinite(bounds.lower) and math.isfinite(bounds.upper):
        seeds = (np.array([bounds.lower, bounds.upper]) - followed.offset) / followed.multiplier
    active = path.fit(observed, float(seeds.min()), float(seeds.max()))
    if math.isinf(bounds.upper) and bounds.unit == "rad":
        active = np.unwrap(active)
    return followed.multiplier * active + followed.offset


def _matrices(poses: Array) -> Array:
    """Homogeneous transforms, shape (T, 4, 4), of positions and quaternions xyzw."""
    norms = np.linalg.norm(poses[:, 3:], axis=1)
    wrong = np.flatnonzero(np.abs(norms - 1) > UNIT_NORM_TOLERANCE)
    if wrong.size:
        raise MotionError(
            f"the quaternion of sample {int(wrong[0])} has the norm {norms[wrong[0]]:.4f}",
            allowed="x, y, z [m], then a unit quaternion x, y, z, w",
        )
    x, y, z, w = (poses[:, 3:] / norms[:, None]).T
    matrices = np.zeros((len(poses), 4, 4))
    matrices[:, 3, 3] = 1
    matrices[:, :3, 3] = poses[:, :3]
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )
    matrices[:, :3, :3] = np.moveaxis(np.array(rows), 2, 0)
    return matrices


def _leaving(motion: Motion, fitted: Array, observed: Array) -> Iterator[Diagnosis]:
    """Where the path leaves what the joint allows, by distance and by angle."""
    gaps, angles = apart(fitted, observed)
    name = local_name(motion.of)
    for quantity, unit, values, tolerance in (
        (Quantity.POSITION, "m", gaps, POSE_TOLERANCE),
        (Quantity.ORIENTATION_ERROR, "rad", angles, ANGLE_TOLERANCE),
    ):
        for excess in excesses(motion.times, values, -math.inf, tolerance, 0.0):
            what = f"the path of {name} leaves the joint's motion by {_figure(excess, unit)}"
            yield _violation(what, quantity, unit, motion.of, excess)


def apart(poses: Array, others: Array) -> tuple[Array, Array]:
    """Distance [m] and angle [rad] between poses, shape (T,) each."""
    gaps = np.linalg.norm(poses[:, :3, 3] - others[:, :3, 3], axis=1)
    differences = np.linalg.norm(poses[:, :3, :3] - others[:, :3, :3], axis=(1, 2))
    return gaps, 2 * np.arcsin(np.clip(differences / math.sqrt(8), 0, 1))


def _start(motion: Motion, began: float, bounds: Bounds) -> Iterator[Diagnosis]:
    """The motion begins where the kitchen is, and at rest; it ends at rest."""
    name, value, time = local_name(motion.of), float(motion.values[0, 0]), float(motion.times[0])
    if abs(value - began) > START_TOLERANCE[bounds.unit]:
        at, begins = told_apart(began, value, 4)
        where = f"{name} is at {at} {bounds.unit}, the motion begins at {begins} {bounds.unit}"
        excess = Excess(value, began, time, True)
        elsewhere = _violation(where, Quantity.POSITION, bounds.unit, motion.of, excess)
        yield replace(elsewhere, code=Code.KITCHEN_ELSEWHERE)
    if motion.velocities is None:
        return
    for index, word in ((0, "begins"), (-1, "ends")):
        speed, time = float(motion.velocities[index, 0]), float(motion.times[index])
        if abs(speed) > REST_SPEED:
            what = f"{name} {word} at {speed:.4g} {bounds.unit}/s, not at rest"
            excess = Excess(speed, 0.0, time, index == 0)
            yield _violation(what, Quantity.VELOCITY, f"{bounds.unit}/s", motion.of, excess, motion.timed)


def _limits(motion: Motion, bounds: Bounds) -> Iterator[Diagnosis]:
    """Limits of position, velocity and acceleration, between samples too."""
    spline = spline_of(motion)
    unit, v, a = bounds.unit, bounds.velocity, bounds.acceleration
    for quantity, of_unit, samples, lower, upper, slack in (
        (Quantity.POSITION, unit, spline.position(), bounds.lower, bounds.upper, BEYOND_STOPS),
        (Quantity.VELOCITY, f"{unit}/s", spline.velocity(), -v, v, v * RATE_SLACK),
        (Quantity.ACCELERATION, f"{unit}/s2", spline.acceleration(), -a, a, a * RATE_SLACK),
    ):
        for excess in excesses(*samples, lower, upper, 0.0 if math.isinf(slack) else slack):
            what = f"{quantity.value} of {local_name(motion.of)} is {_figure(excess, of_unit)}"
            sure = motion.timed or quantity is Quantity.POSITION
            yield _violation(what, quantity, of_unit, motion.of, excess, sure)


def _figure(excess: Excess, unit: str) -> str:
    when = "first" if excess.first else "at worst"
    value, bound = told_apart(excess.value, excess.bound, 4)
    return f"{value} {unit} (allowed {bound}) {when} at {excess.time:.3f} s"


def _violation(  # noqa: PLR0913, PLR0917  # the parts of one diagnosis
    reason: str, quantity: Quantity, unit: str, of: Iri, excess: Excess, proof: bool = True
) -> Diagnosis:
    """A CAUSAL diagnosis, proved: the motion itself breaks the bound.

    Not so where it does by its speed, and its times are only proposed: made slower it may not.
    """
    evidence = Evidence(quantity, excess.value, excess.bound, unit, entity=of, time=excess.time)
    return Diagnosis(Kind.CAUSAL, reason, evidence, proof=proof)
