"""What an observed track is in a twin: whose container moves so, if any does, and τ without the noise."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy import stats
from scipy.interpolate import PchipInterpolator

from predicates.learn import Track
from predicates.learn.fitting.cells import spikes
from sdt_kg.errors import MotionError
from sdt_kg.motion import Array, Motion
from sdt_kg.twin import Container, Twin
from services.physics.chain import chain
from services.physics.generate import is_stuck
from services.physics.points import PointPath, as_point, as_values, world_T_body
from services.physics.replay import Bounds, effective_bounds, spline_of
from services.physics.tree import Model

REACH = 0.3
"""[m] How far from a handle's origin a hand may hold it, or a marker sit: half a long bar and a hand."""

DEVIATIONS = 3.0
"""[1] Scales of the learned path within which the twin's own path explains the track."""

LEAST_SCALE = 0.002
"""[m] Play and compliance that every track is allowed."""

SHARE = 0.9
"""[1] Share of the samples that has to lie so near: hands let go at the end."""

ROUNDS = 4
"""[1] Rounds in which the point that is held is found: across its path by all samples."""

FIRST = 5
"""[1] Samples whose median says where a track begins."""

NEAR = 0.01
"""[m] Samples nearer than this to the begin, before any that is not, are standstill."""

KNOTS = 17
"""[1] Samples of the motion without noise: a hand that opens a drawer does not change its mind faster."""

LIMIT_SHARE = 0.98
"""[1] Share of the velocity and acceleration limits that a motion with stretched times uses."""

SURE = 0.99
"""[1] Confidence from which on a track moves at its begin or end, and does not rest there."""

MOST = 200
"""[1] Samples that tell this: the time grows by their square."""

MOVED = 0.02
"""[1] Share of the way within which the ends are standstill."""


@dataclass(frozen=True, slots=True, eq=False)
class Followed:
    """A track as motion of one container, as the twin has it.

    Attributes:
        container: Whose handle is near the track's begin.
        reach: Distance from the handle's origin to the observed point [m].
        offset: The observed point in the handle's frame, shape (3,) [m].
        values: Shape (T,): position of the container's own joint nearest to each sample [rad or m].
        distances: Shape (T,): how far the sample is from the twin's path, the joint's limits aside [m].
        radius: Of the point's circle [m]; 1 for a slide, so that lengths are lengths.
    """

    container: Container
    reach: float
    offset: Array
    values: Array
    distances: Array
    radius: float

    def explains(self, scale: float, bounds: Bounds) -> bool:
        """Whether the twin's path, within its limits, is as near as noise of a scale [m] allows."""
        near = DEVIATIONS * max(scale, LEAST_SCALE)
        beyond = np.maximum(self.values - bounds.upper, bounds.lower - self.values).clip(min=0) * self.radius
        return bool(np.mean(np.maximum(self.distances, beyond) <= near) >= SHARE)


def followed(model: Model, twin: Twin, track: Track, container: Container) -> Followed | None:
    """The track as motion of a container that begins in the twin's state; None if no handle is within reach.

    Args:
        model: Built from the twin's environment.
        twin: The kitchen in the state in which the track begins.
        track: In the kitchen's root frame.
        container: Whose motion it might be, by the nearest of its handles.
    """
    found = (_by_own(model, twin, track, each) for each in container.by_each_handle)
    return min((each for each in found if each is not None), key=lambda each: each.reach, default=None)


def _by_own(model: Model, twin: Twin, track: Track, container: Container) -> Followed | None:
    path = chain(model, container.handle, twin.state)
    joint = path.follower
    pose = path.poses(np.array([twin.state.get(joint.active, 0.0)]))[0][0]
    offset = pose[:3, :3].T @ (_begin(track) - pose[:3, 3])
    reach = float(np.linalg.norm(offset))
    if reach > REACH:
        return None
    try:
        for _ in range(ROUNDS):
            seen = PointPath(container.handle, offset, track.times, track.positions, timed=False)
            values = as_values(model, twin, seen)
            poses = world_T_body(model, twin, values, container.handle)
            gaps = track.positions - poses[:, :3, :3] @ offset - poses[:, :3, 3]
            offset = offset + np.median(np.einsum("tji,tj->ti", poses[:, :3, :3], gaps), axis=0)
    except MotionError:
        return None
    again = as_point(model, twin, values, container.handle, offset)
    distances = np.linalg.norm(again.positions - track.positions, axis=1)
    lever = Motion(values.of, np.array([0.0, 1.0]), values.values[:1] + np.array([[0.0], [1e-4]]))
    moved = as_point(model, twin, lever, container.handle, offset).positions
    radius = float(np.linalg.norm(moved[1] - moved[0])) / 1e-4
    return Followed(container, reach, offset, values.values[:, 0], distances, radius)


def _begin(track: Track) -> Array:
    """Where the point is before it moves, by the samples near the first few."""
    positions = track.positions
    first = np.median(positions[:FIRST], axis=0)
    away = np.linalg.norm(positions - first, axis=1) > NEAR
    still = max(int(np.argmax(away)) if away.any() else len(positions), FIRST)
    times = track.times[:still]
    return np.array([_at(times[0], times, each)[0] for each in positions[:still].T])


def _at(time: float, times: Array, values: Array) -> tuple[float, bool]:
    """The value at a time of some samples, and whether it surely moves there: else it is their median."""
    some = slice(None, None, -(-len(values) // MOST))
    line = np.array(stats.theilslopes(values[some], times[some], SURE), dtype=np.float64)
    slope, at_0, lowest, highest = line.tolist()
    if lowest <= 0 <= highest:
        return float(np.median(values)), False
    return float(np.clip(at_0 + slope * time, values.min(), values.max())), True


def near_first(model: Model, twin: Twin, track: Track) -> Iterator[Followed]:
    """The track as motion of every container whose handle is within reach, the nearest first."""
    found = (followed(model, twin, track, container) for container in twin.containers())
    yield from sorted((each for each in found if each is not None), key=lambda each: each.reach)


def motion_of(model: Model, twin: Twin, track: Track, seen: Followed) -> tuple[Motion, float]:
    """τ of a track without noise and standstill, and by what its times are stretched to keep to limits.

    It begins exactly in the twin's state; a value that noise carries over a limit is at the limit. Times
    are the track's where it has some; else, and where the limits of velocity and acceleration demand it,
    they are stretched: a track shows a path, not how fast a container may move.
    """
    joint = seen.container.joint
    path = chain(model, seen.container.handle, twin.state)
    bounds = effective_bounds(model, twin, path.follower)
    kept = ~spikes(track.positions) & (seen.distances <= np.quantile(seen.distances, SHARE) + LEAST_SCALE)
    times, values = track.times[kept], np.clip(seen.values[kept], bounds.lower, bounds.upper)
    last, end = _end(times, values)
    times, values = _moving(times, values, last)
    knots = np.linspace(times[0], times[-1], KNOTS)
    smooth = _smooth(times, values, knots)
    began = path.follower.multiplier * twin.state.get(path.follower.active, 0.0) + path.follower.offset
    smooth[0], smooth[-1] = began, end
    # between knots no value is outside theirs, or noise would swing beyond a limit
    rates = np.asarray(PchipInterpolator(knots, smooth).derivative()(knots), dtype=np.float64)
    rates[0] = rates[-1] = 0
    motion = Motion(joint, knots - knots[0], smooth[:, None], timed=False, velocities=rates[:, None])
    stretch = max(_stretch(motion, bounds), 1.0 if track.timed else 0.0)
    stretched = replace(motion, times=motion.times * stretch, velocities=rates[:, None] / stretch)
    return stretched, stretch if track.timed else math.nan


def _resting(values: Array) -> int:
    """First of the samples at which it rests at the end: at least the last FIRST."""
    far = MOVED * float(np.abs(values - values[0]).max())
    away = np.flatnonzero(np.abs(values - np.median(values[-FIRST:])) > far)
    return min(int(away[-1]) + 1 if away.size else 0, len(values) - FIRST)


def _end(times: Array, values: Array) -> tuple[int, float]:
    """The sample at which it comes to its end, and that: the last one of a track that ends moving."""
    rest = _resting(values)
    end, moves = _at(times[-1], times[rest:], values[rest:])
    return len(values) - 1 if moves else rest, end


def _moving(times: Array, values: Array, last: int) -> tuple[Array, Array]:
    """The part between standstill at the begin and the sample at which it comes to its end."""
    way = np.abs(values - values[0])
    first = max(int(np.argmax(way > MOVED * float(way.max()))) - 1, 0)
    return (times, values) if last - first < 2 else (times[first : last + 1], values[first : last + 1])


def _smooth(times: Array, values: Array, knots: Array) -> Array:
    """Values at knots: medians of the samples about each, so that spikes and noise do not count."""
    half = (knots[1] - knots[0]) / 2
    found = np.array(
        [
            np.median(values[near]) if (near := np.abs(times - knot) <= half).any() else np.nan
            for knot in knots
        ]
    )
    known = np.isfinite(found)
    found = np.interp(knots, knots[known], found[known])
    return found


def _stretch(motion: Motion, bounds: Bounds) -> float:
    """Factor of time at which the motion uses LIMIT_SHARE of its limits; 1 where nothing may move."""
    if is_stuck(bounds):
        return 1.0
    spline = spline_of(motion)
    speed, force = (float(np.abs(each).max()) for _, each in (spline.velocity(), spline.acceleration()))
    return max(
        speed / (LIMIT_SHARE * bounds.velocity), math.sqrt(force / (LIMIT_SHARE * bounds.acceleration)), 1e-6
    )
