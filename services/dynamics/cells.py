"""Bounds of position, speed and acceleration over spans of τ, between its samples too, and at instants."""

from dataclasses import dataclass

import numpy as np

from sdt_kg.motion import Motion
from services.dynamics.model import Array
from services.embodiment.proof_check.geometry.interval import Interval
from services.physics.replay import velocities_of

ROUNDING = 1e-12
"""[1] Share of a motion's own figures by which bounds are widened: more than evaluating a cubic errs."""

INSTANTS = np.array([0.05, 0.5, 0.95])
"""[1] Of each cubic piece, whose acceleration is largest near its ends. Not at them: where a motion begins or
ends friction may point either way, in a span beside it only one."""


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """Spans of a motion, in order; every array has the shape (C,).

    Attributes:
        piece: Of which cubic piece each is a part.
        begin, end: Times [s].
        q, v, a: Bounds of position, speed and acceleration within each span.
        rests: Whether nothing moves in it.
    """

    piece: "np.ndarray[tuple[int], np.dtype[np.intp]]"
    begin: Array
    end: Array
    q: Interval
    v: Interval
    a: Interval
    rests: "np.ndarray[tuple[int], np.dtype[np.bool_]]"


def cells(motion: Motion, parts: int, off: float = 0.0) -> Cells:
    """The motion's cubic pieces, each cut into equal parts.

    Args:
        motion: Of a container.
        parts: Of each piece.
        off: How far from where the motion begins the container is then [rad or m]. Positions hold for both,
            and all between.
    """
    edges = np.linspace(0.0, 1.0, parts + 1)
    return _between(motion, edges[:-1], edges[1:], off)


def instants(motion: Motion, off: float = 0.0) -> Cells:
    """Some instants of each piece: what is bounded there no finer parts bound closer."""
    return _between(motion, INSTANTS, INSTANTS, off)


def _between(motion: Motion, begins: Array, ends: Array, off: float) -> Cells:
    """Of each piece what is between some shares of it.

    On a piece of duration h, u in [0, 1]: q = c0 + c1 u + c2 u² + c3 u³. Acceleration is linear, speed has
    at most one extremum, and position is monotone wherever speed keeps its sign; else it is bounded by speed.
    """
    times, values = motion.times, motion.values[:, 0]
    speeds = velocities_of(motion)[:, 0]
    h = np.diff(times)
    step, v0, v1 = np.diff(values), speeds[:-1] * h, speeds[1:] * h
    c0, c1, c2, c3 = values[:-1], v0, 3 * step - 2 * v0 - v1, v0 + v1 - 2 * step
    low, high = (np.broadcast_to(each, (len(h), len(begins))) for each in (begins, ends))
    h, c0, c1, c2, c3 = (each[:, None] for each in (h, c0, c1, c2, c3))

    def speed(u: Array) -> Array:
        return (c1 + u * (2 * c2 + u * 3 * c3)) / h

    def position(u: Array) -> Array:
        return c0 + u * (c1 + u * (c2 + u * c3))

    with np.errstate(divide="ignore", invalid="ignore"):
        turn = np.nan_to_num(-c2 / (3 * c3), nan=0.0, posinf=0.0, neginf=0.0)
    v = _hull(speed(low), speed(high), speed(np.clip(turn, low, high)))
    a = _hull((2 * c2 + 6 * c3 * low) / h**2, (2 * c2 + 6 * c3 * high) / h**2)
    swing = np.where((v.lo < 0) & (v.hi > 0), np.maximum(-v.lo, v.hi) * h * (high - low), 0.0)
    reached = _hull(position(low), position(high))
    q = Interval(reached.lo - swing + min(off, 0.0), reached.hi + swing + max(off, 0.0))
    rests = (c1 == 0) & (c2 == 0) & (c3 == 0) & np.ones_like(low, dtype=bool)
    began = times[:-1, None]
    begin, end = (began + h * low).ravel(), (began + h * high).ravel()
    piece = np.repeat(np.arange(len(h)), len(begins))
    return Cells(piece, begin, end, _widened(q, rests), _widened(v, rests), _widened(a, rests), rests.ravel())


def _hull(*values: Array) -> Interval:
    return Interval(np.minimum.reduce(values), np.maximum.reduce(values))


def _widened(bounds: Interval, rests: Array) -> Interval:
    """Flat, and wider by rounding, but exact where nothing moves."""
    scale = np.where(
        rests, 0.0, ROUNDING * max(float(np.abs(bounds.lo).max()), float(np.abs(bounds.hi).max()))
    )
    return Interval((bounds.lo - scale).ravel(), (bounds.hi + scale).ravel())
