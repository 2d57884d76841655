"""A latch: the force grows to a threshold, the latch gives way, and friction alone remains."""

import math
from dataclasses import dataclass

import numpy as np

from predicates.learn.holding.log import LEAST_WINDOW, Log, left
from predicates.learn.track import Array

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
class Plain:
    """Nothing but friction holds the container.

    Attributes:
        friction: Force along the path while it moves [N].
    """

    friction: float


def latch(log: Log) -> Latch | Plain:
    """The threshold and the friction after it; plain where a threshold explains no more."""
    force, begin = log.smooth(log.force), left(log.way, log.window)
    moving = log.force[begin:]
    friction = float(np.median(moving)) if len(moving) >= log.window else 0.0
    span = slice(_rise(force, begin), min(begin + 3 * log.window, len(force)))
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
