"""Push to open: the container is pushed in, let go, and comes out by itself."""

import math
from dataclasses import dataclass

import numpy as np

from predicates.learn.holding.log import LEAST_WINDOW, Log, left
from predicates.learn.track import Array

SIGNIFICANT = 6.0
"""[1] Standard deviations of a mean by which a force or way differs from none."""

LEAST_PUSH = 3.0
"""[N] A weaker push is a hand that rests on the handle."""


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


def push(log: Log) -> PushToOpen | None:
    """The push, the depth and the way out; None if nothing was pushed in or nothing came out."""
    force, window = log.smooth(log.force), log.window
    least = max(LEAST_PUSH, SIGNIFICANT * log.force_noise / math.sqrt(window))
    gone = left(log.way, window)
    early = slice(0, max(gone, window))
    deepest = int(np.argmin(force[early]))
    if -force[deepest] < least:
        return None
    pressing = _around(force < force[deepest] / 2, deepest)
    if pressing.stop - pressing.start < LEAST_WINDOW or pressing.stop > gone:
        return None
    depth, depth_deviation = _extreme(log.times[pressing], -log.way[pressing], log.way_noise)
    hardest, _ = _extreme(log.times[pressing], -log.force[pressing], log.force_noise)
    if depth < 2 * depth_deviation:
        return None
    released = _free_from(force, pressing.stop, least)
    if released == len(force):
        return None
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
    return PushToOpen(hardest, depth, depth_deviation, out, float(log.times[released]), misfit - cost)


def _around(marked: np.ndarray, inside: int) -> slice:
    """The run of marked samples around one of them."""
    before, after = np.flatnonzero(~marked[:inside]), np.flatnonzero(~marked[inside:])
    start = int(before[-1]) + 1 if before.size else 0
    return slice(start, inside + int(after[0]) if after.size else len(marked))


def _free_from(force: Array, begin: int, least: float) -> int:
    """First sample from `begin` on at which the hand no longer pushes; the end if it never lets go."""
    free = force[begin:] > -least / 2
    return begin + int(np.argmax(free)) if free.any() else len(force)


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
