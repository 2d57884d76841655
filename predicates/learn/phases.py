r"""Terms of Φ′ that only forces show: a latch to overcome, or a door that is pushed in and springs out.

Read from a log with the hand's force on the handle. Three explanations compete:

- plain: the force grows until friction is overcome and stays there,
- latch: it grows to a threshold, the latch gives way, and friction alone remains,
- push to open: it is negative first, the container goes in, is let go and comes out by itself.
"""

import math
from dataclasses import dataclass

import numpy as np

from predicates.learn.articulation import Articulation
from predicates.learn.fitting.vectors import cross
from predicates.learn.track import Array, Track
from sdt_kg.errors import MotionError
from sdt_kg.mechanism import JointType

SMOOTHING = 0.02
"""[1] Share of the samples in a moving mean, at least LEAST_WINDOW: 0.1 s of a log of 5 s."""

LEAST_WINDOW = 5
"""[1] Samples in the shortest moving mean."""

LEFT = 0.012
"""[m] A container that is farther than this from its place has left it: six times usual noise."""

SIGNIFICANT = 6.0
"""[1] Standard deviations of a mean by which a force or way differs from none."""

LEAST_PUSH = 3.0
"""[N] A weaker push is a hand that rests on the handle."""

LEAST_LATCH = 3.0
"""[N] A threshold nearer to friction than this is stiction, not a latch."""

LEAST_EVIDENCE = 3.0
"""[1] Log of how much likelier a latch has to be: 20 times."""

SELECTION = 1.7
"""[1] By what a threshold is less certain than a line's end: the break itself is chosen among many samples.
Over 100 synthetic logs the errors are then as large as their standard deviations say."""

SURE = 2.5
"""[1] Standard deviations by which a threshold has to exceed friction."""

RISEN = 0.15
"""[1] Share of the largest force at which the rise before a break begins."""

GRID = 40
"""[1] Candidate samples for the begin of the rise, and for the break."""


@dataclass(frozen=True, slots=True)
class Latch:
    """A latch that gives way to a force.

    Attributes:
        force: Threshold along the path [N].
        force_deviation: Its standard deviation [N].
        travel: How far the handle gives before the latch does [m].
        friction: Force along the path afterwards [N].
        break_time: When it gave way [s, or samples].
        evidence: How much likelier the log is with the latch than without, as a logarithm, less
            what its two parameters cost.
    """

    force: float
    force_deviation: float
    travel: float
    friction: float
    break_time: float
    evidence: float


@dataclass(frozen=True, slots=True)
class PushToOpen:
    """A container that is pushed in, let go, and comes out by itself.

    Attributes:
        force: Largest push against the path [N].
        depth: How far it went in [m].
        depth_deviation: Its standard deviation [m].
        spring_out: Where it came to rest by itself, from where it was at first [m].
        release_time: When it was let go [s, or samples].
        evidence: How much likelier the log is with the push than without, as a logarithm.
    """

    force: float
    depth: float
    depth_deviation: float
    spring_out: float
    release_time: float
    evidence: float


@dataclass(frozen=True, slots=True)
class Plain:
    """Nothing but friction holds the container.

    Attributes:
        friction: Force along the path while it moves [N].
    """

    friction: float


@dataclass(frozen=True, slots=True, eq=False)
class _Log:
    """Way [m], force along it [N] and times of each sample, with their noise and the moving mean's length."""

    way: Array
    force: Array
    times: Array
    way_noise: float
    force_noise: float
    window: int

    def smooth(self, values: Array) -> Array:
        """Centred moving mean, shorter at the ends, shape (T,)."""
        ones = np.ones(self.window)
        return np.convolve(values, ones, "same") / np.convolve(np.ones(len(values)), ones, "same")


def phases(track: Track, joint: Articulation) -> Latch | PushToOpen | Plain:
    """What held the container before it moved along the joint that was learned.

    Raises:
        MotionError: The track has no forces, or the joint does not move.
    """
    log = _log(track, joint)
    pushed = _push(log)
    return _latch(log) if pushed is None else pushed


def along(track: Track, joint: Articulation) -> tuple[Array, Array]:
    """Way along the joint's path [m], and the force along it [N], shape (T,) each.

    Raises:
        MotionError: The track has no forces, or the joint does not move.
    """
    if track.forces is None:
        raise MotionError(f"{track.name} has no forces", allowed="columns fx fy fz [N]")
    if joint.joint_type is JointType.FIXED:
        raise MotionError(f"{track.name} does not move", allowed="a prismatic or revolute joint")
    if joint.joint_type is JointType.PRISMATIC:
        return joint.positions, track.forces @ joint.axis
    arms = joint.point(joint.positions) - joint.origin
    tangents = cross(joint.axis, arms) / joint.radius
    return joint.positions * joint.radius, np.einsum("ti,ti->t", tangents, track.forces)


def _log(track: Track, joint: Articulation) -> _Log:
    way, force = along(track, joint)
    window = max(LEAST_WINDOW, int(SMOOTHING * len(way)) | 1)
    rest = way[: max(window, _left(way, window))]
    zero = float(np.median(rest[: max(window, len(rest) // 4)]))
    return _Log(way - zero, force, track.times, _noise(way), _noise(force), window)


def _noise(values: Array) -> float:
    """Standard deviation of white noise on smooth values, from their second differences."""
    second = np.diff(values, 2)
    return float(np.median(np.abs(second))) / 0.6745 / math.sqrt(6) + 1e-9


def _left(way: Array, window: int) -> int:
    """First sample at which the container has left its place for good."""
    mean = np.convolve(way, np.ones(window) / window, "same")
    beyond = mean > LEFT
    return int(np.argmax(beyond)) if beyond.any() else len(way)


def _push(log: _Log) -> PushToOpen | None:
    """The push, the depth and the way out; None if nothing was pushed in or nothing came out."""
    force, window = log.smooth(log.force), log.window
    least = max(LEAST_PUSH, SIGNIFICANT * log.force_noise / math.sqrt(window))
    left = _left(log.way, window)
    early = slice(0, max(left, window))
    deepest = int(np.argmin(force[early]))
    if -force[deepest] < least:
        return None
    pressing = _around(force < force[deepest] / 2, deepest)
    if pressing.stop - pressing.start < LEAST_WINDOW:
        return None
    depth, depth_deviation = _extreme(log.times[pressing], -log.way[pressing], log.way_noise)
    push, _ = _extreme(log.times[pressing], -log.force[pressing], log.force_noise)
    if depth < 2 * depth_deviation:
        return None
    released = _free_from(force, pressing.stop, least)
    pulled = _pulled_from(force, released, least)
    free = slice(released, max(pulled, released + window))
    out = _plateau(log.way[free], window)
    if (
        out < SIGNIFICANT * log.way_noise / math.sqrt(window)
        or abs(float(np.median(log.force[free]))) > least
    ):
        return None
    misfit = float((log.force[pressing] ** 2).sum()) / (2 * log.force_noise**2)
    cost = 1.5 * math.log(len(log.force))
    return PushToOpen(push, depth, depth_deviation, out, float(log.times[released]), misfit - cost)


def _around(marked: np.ndarray, inside: int) -> slice:
    """The run of marked samples around one of them."""
    before, after = np.flatnonzero(~marked[:inside]), np.flatnonzero(~marked[inside:])
    start = int(before[-1]) + 1 if before.size else 0
    return slice(start, inside + int(after[0]) if after.size else len(marked))


def _free_from(force: Array, begin: int, least: float) -> int:
    """First sample from `begin` on at which the hand no longer pushes."""
    free = force[begin:] > -least / 2
    return begin + (int(np.argmax(free)) if free.any() else 0)


def _pulled_from(force: Array, begin: int, least: float) -> int:
    """First sample from `begin` on at which the hand pulls; the end if it never does."""
    pulled = force[begin:] > least / 2
    return begin + int(np.argmax(pulled)) if pulled.any() else len(force)


def _plateau(way: Array, window: int) -> float:
    """Where a way comes to rest: the median of its last third."""
    return float(np.median(way[-max(window, len(way) // 3) :]))


def _extreme(times: Array, values: Array, noise: float) -> tuple[float, float]:
    """Top of a parabola through values, and the standard deviation of that."""
    x = (times - times.mean()) / max(float(np.ptp(times)), 1e-9)
    basis: Array = np.stack([np.ones_like(x), x, x * x], axis=1)
    left = basis.T @ basis
    a, b, c = (float(each) for each in np.linalg.solve(left, basis.T @ values))
    at = float(np.clip(-b / (2 * c), -0.5, 0.5)) if c < 0 else 0.0
    row = np.array([1.0, at, at * at])
    return a + b * at + c * at * at, noise * math.sqrt(float(row @ np.linalg.solve(left, row)))


def _latch(log: _Log) -> Latch | Plain:
    """The threshold and the friction after it; plain where a threshold explains no more."""
    force, left = log.smooth(log.force), _left(log.way, log.window)
    moving = log.force[left:]
    friction = float(np.median(moving)) if len(moving) >= log.window else 0.0
    span = slice(_rise(force, left), min(left + 3 * log.window, len(force)))
    values, count = log.force[span], span.stop - span.start
    if count < 3 * LEAST_WINDOW:
        return Plain(friction)
    best = min(
        (_ramp(values, begin, end, friction) for begin, end in _grid(count, log.window)),
        key=lambda each: each[0],
    )
    misfit, end, top, spread = best
    plain = min(_ramp(values, begin, end, friction, friction)[0] for begin, end in _grid(count, log.window))
    evidence = (plain - misfit) / (2 * log.force_noise**2) - math.log(count)
    deviation = SELECTION * spread * log.force_noise
    if evidence < LEAST_EVIDENCE or top - friction < max(LEAST_LATCH, SURE * deviation):
        return Plain(friction)
    broke = span.start + end
    travel = float(np.mean(log.way[max(broke - log.window, 0) : broke]))
    return Latch(top, deviation, max(travel, 0.0), friction, float(log.times[broke]), evidence)


def _rise(force: Array, left: int) -> int:
    """First sample of the rise that leads to the largest force before the container has left."""
    top = int(np.argmax(force[: left + 1]))
    low = np.flatnonzero(force[:top] < RISEN * force[top])
    return int(low[-1]) + 1 if low.size else 0


def _grid(count: int, window: int) -> list[tuple[int, int]]:
    """Begins of the rise and breaks worth a try, as samples."""
    begins = np.unique(np.linspace(0, count // 2, GRID // 4).astype(int))
    ends = np.unique(np.linspace(window, count - 2, GRID).astype(int))
    return [(int(begin), int(end)) for begin in begins for end in ends if end - begin >= LEAST_WINDOW]


def _ramp(
    values: Array, begin: int, end: int, friction: float, top: float | None = None
) -> tuple[float, int, float, float]:
    """Misfit, break, top and spread of a straight rise to the break, then friction.

    Args:
        values: Force [N].
        begin: Sample from which the rise is straight.
        end: Sample of the break.
        friction: After the break [N].
        top: Force at the break; None for the likeliest.
    """
    rising, after = values[begin:end], values[end:]
    x = np.arange(begin - end, 0, dtype=np.float64) + 0.5
    basis: Array = np.stack([np.ones_like(x), x], axis=1)
    before = values[:begin]
    if top is None:
        left = basis.T @ basis
        height, slope = (float(each) for each in np.linalg.solve(left, basis.T @ rising))
        spread = math.sqrt(float(np.linalg.inv(left)[0, 0]))
    else:
        height, spread = top, 0.0
        slope = float(x @ (rising - height)) / float(x @ x)
    gaps = rising - height - slope * x
    first = height + slope * float(x[0])
    misfit = (
        float(gaps @ gaps) + float(((after - friction) ** 2).sum()) + float(((before - first) ** 2).sum())
    )
    return misfit, end, height, spread
