r"""τ in the forms that the paper names, and the ways from one to another.

Articulation values, pose path of any body that the joint moves, path of any point of such a body: each
determines the others, except where the joint does not move the point, or brings it to one place twice.
A robot's joint-space motion becomes τ in `carry.py`, and τ a robot's motion in CanPerform.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sdt_kg.errors import DisconnectedFrameError, MotionError
from sdt_kg.iri import Iri, local_name
from sdt_kg.motion import Array, Motion
from sdt_kg.twin import Twin
from services.physics.chain import SEEDS, Chain, Follower, chain, follower
from services.physics.replay import check_samples, effective_bounds, fitted_positions
from services.physics.tree import Model

STEPS = 12
"""[1] Gauss-Newton steps from the nearest seed: exact points need four, noisy ones a few more."""

LEAST_RADIUS = 1e-6
"""[m] A point nearer to the hinge says nothing of its angle."""

SETTLED = 1e-9
"""[rad or m] How much a last step may still change."""

SAME_PLACE, APART = 1e-9, 1e-4
"""[m], [rad or m] Points that are one, and positions of the joint that are two: steps end nearer to one."""

SLOW_STEPS = 40
"""[1] Gauss-Newton steps where a point turns back: there each only halves what is left."""


@dataclass(frozen=True, slots=True, eq=False)
class PointPath:
    """τ as the path of one point of a moving body.

    Attributes:
        of: IRI of the body.
        offset: The point in the body's frame, shape (3,) [m].
        times: Shape (T,), increasing [s].
        positions: Shape (T, 3), in the environment's root frame [m].
        timed: As in `Motion`.
    """

    of: Iri
    offset: Array
    times: Array
    positions: Array
    timed: bool = True


def as_values(model: Model, twin: Twin, motion: Motion | PointPath) -> Motion:
    """τ as articulation values of the joint that moves the body.

    The path is taken to be the joint's own: how far it is from that is `residuals`.

    Raises:
        MotionError: Samples that are no motion.
        DisconnectedFrameError: Nothing moves the body, or nothing that the body does moves the point.
    """
    if isinstance(motion, PointPath):
        path = chain(model, motion.of, twin.state)
        active = fitted_to_points(model, twin, path, motion.offset, motion.positions)
        return Motion(path.follower.own, motion.times, _own(path.follower, active), motion.timed)
    check_samples(motion)
    if not motion.is_poses:
        return motion
    path = chain(model, motion.of, twin.state)
    observed = np.tile(np.eye(4), (len(motion.times), 1, 1))
    observed[:, :3, 3] = motion.values[:, :3]
    observed[:, :3, :3] = Rotation.from_quat(motion.values[:, 3:]).as_matrix()
    bounds = effective_bounds(model, twin, path.follower)
    values = fitted_positions(path, bounds, twin.state.get(path.follower.active, 0.0), observed)
    return Motion(path.follower.own, motion.times, values[:, None], motion.timed)


def as_poses(model: Model, twin: Twin, motion: Motion | PointPath, body: Iri) -> Motion:
    """τ as the pose path of a body, whichever form it comes in.

    Raises:
        DisconnectedFrameError: The joint that τ moves does not move the body.
    """
    values = as_values(model, twin, motion)
    poses = world_T_body(model, twin, values, body)
    quaternions = Rotation.from_matrix(poses[:, :3, :3]).as_quat()
    return Motion(body, values.times, np.hstack([poses[:, :3, 3], quaternions]), values.timed)


def as_point(model: Model, twin: Twin, motion: Motion | PointPath, body: Iri, offset: Array) -> PointPath:
    """τ as the path of a point of a body, its place in the body's frame given, shape (3,) [m]."""
    values = as_values(model, twin, motion)
    poses = world_T_body(model, twin, values, body)
    return PointPath(body, offset, values.times, poses[:, :3, :3] @ offset + poses[:, :3, 3], values.timed)


def world_T_body(model: Model, twin: Twin, motion: Motion, body: Iri) -> Array:
    """Poses of a body under articulation values, shape (T, 4, 4).

    Raises:
        DisconnectedFrameError: The joint does not move the body.
    """
    path, moved = chain(model, body, twin.state), follower(model, motion.of)
    if path.follower.active != moved.active:
        raise DisconnectedFrameError(
            f"joint '{local_name(motion.of)}' does not move '{local_name(body)}'",
            allowed=f"a body that '{local_name(moved.active)}' moves",
        )
    return path.poses((motion.values[:, 0] - moved.offset) / moved.multiplier)[0]


def fitted_to_points(model: Model, twin: Twin, path: Chain, offset: Array, positions: Array) -> Array:
    """Positions of the actuated joint at which the point is nearest to where it was seen, shape (T,).

    Raises:
        MotionError: Positions that are not numbers, or a place to which the joint brings the point twice.
        DisconnectedFrameError: The point lies on the hinge's axis.
    """
    if positions.ndim != 2 or positions.shape[1] != 3 or not np.isfinite(positions).all():
        raise MotionError(f"positions of shape {positions.shape}", allowed="finite numbers, shape (T, 3)")
    seeds = _seeds(model, twin, path)
    if len(path.moving) > 1:
        return _from_everywhere(path, seeds, offset, positions)
    gaps = positions[:, None] - _points(path, seeds, offset)[0][None]
    active = seeds[np.argmin((gaps**2).sum(axis=2), axis=1)]
    for _ in range(STEPS):
        step, squares = _step(path, active, offset, positions)
        if float(squares.min()) < LEAST_RADIUS**2:
            raise DisconnectedFrameError(
                f"the point {offset.tolist()} of '{local_name(path.follower.own)}' lies on its axis",
                allowed="a point that the joint moves",
            )
        active = active + step
        if float(np.abs(step).max()) < SETTLED:
            break
    return active


def _from_everywhere(path: Chain, seeds: Array, offset: Array, positions: Array) -> Array:
    """The same where joints move together: they may bring a point near a place, or to it, twice.

    Raises:
        MotionError: A place to which the point comes twice.
    """
    first = np.linalg.norm(positions[:, None] - _points(path, seeds, offset)[0][None], axis=2)
    basins = _basins(first)
    active, target = np.broadcast_to(seeds, basins.shape)[basins], positions[np.nonzero(basins)[0]]
    for _ in range(SLOW_STEPS):
        step, squares = _step(path, active, offset, target)
        active = np.clip(active + np.where(squares < LEAST_RADIUS**2, 0.0, step), seeds[0], seeds[-1])
    gaps, found = np.full(basins.shape, np.inf), np.zeros(basins.shape)
    gaps[basins] = np.linalg.norm(target - _points(path, active, offset)[0], axis=1)
    found[basins] = active
    best = np.take_along_axis(found, gaps.argmin(axis=1)[:, None], axis=1)
    there = (gaps < gaps.min(axis=1, keepdims=True) + SAME_PLACE) & (np.abs(found - best) > APART)
    for k, other in np.argwhere(there).tolist():
        between = (best[k] + found[k, other]) / 2
        if float(np.linalg.norm(positions[k] - _points(path, between, offset)[0])) < gaps[k, other]:
            continue  # beside its path a point is as near to a stretch of it, where it is slow
        raise MotionError(
            f"sample {k}: the point {offset.tolist()} of '{local_name(path.follower.own)}' is there with its "
            f"joint at {best[k, 0]:.4g} and at {found[k, other]:.4g}",
            allowed="a point that comes to each place once",
            remedy="give poses, or the joint's values",
        )
    return best[:, 0]


def _basins(gaps: Array) -> NDArray[np.bool_]:
    """Where along the last axis gaps are no larger than both neighbours, and these neighbours."""
    around = np.pad(gaps, ((0, 0), (1, 1)), constant_values=np.inf)
    least = (gaps <= around[:, :-2]) & (gaps <= around[:, 2:])
    wide = np.pad(least, ((0, 0), (1, 1)))
    return wide[:, :-2] | least | wide[:, 2:]


def _step(path: Chain, active: Array, offset: Array, positions: Array) -> tuple[Array, Array]:
    """A step of Gauss and Newton, and the square of how fast the point moves, shape (T,) each."""
    points, rates = _points(path, active, offset)
    squares = (rates**2).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return ((positions - points) * rates).sum(axis=1) / squares, squares


def _seeds(model: Model, twin: Twin, path: Chain) -> Array:
    """Positions of the actuated joint over its range and a little beyond."""
    bounds, joint = effective_bounds(model, twin, path.follower), path.follower
    if not (math.isfinite(bounds.lower) and math.isfinite(bounds.upper)):
        now = twin.state.get(joint.active, 0.0)
        return np.linspace(now - math.pi, now + math.pi, SEEDS)
    ends = (np.array([bounds.lower, bounds.upper]) - joint.offset) / joint.multiplier
    room = (ends.max() - ends.min()) / SEEDS
    return np.linspace(ends.min() - room, ends.max() + room, SEEDS)


def _points(path: Chain, active: Array, offset: Array) -> tuple[Array, Array]:
    """The point and its derivative by the actuated joint, shape (T, 3) each."""
    pose, rate = path.poses(active)
    return pose[:, :3, :3] @ offset + pose[:, :3, 3], rate[:, :3, :3] @ offset + rate[:, :3, 3]


def _own(joint: Follower, active: Array) -> Array:
    return (joint.multiplier * active + joint.offset)[:, None]


def residuals(model: Model, twin: Twin, path: PointPath) -> Array:
    """Distance of each sample from the joint's own path, shape (T,) [m]."""
    values = as_values(model, twin, path)
    return np.linalg.norm(
        as_point(model, twin, values, path.of, path.offset).positions - path.positions, axis=1
    )
