"""A motion's coordinates as cubic pieces, and sound bounds on them over any interval of time."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from services.embodiment.certify.sweep import compiled

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

LOOKS = 500_000  # at the sideways velocity that are kept at once, for memory
MOST_LOOKS = 20_000_000  # in all, some 20 s: a motion within its limits has as many in an hour


@dataclass(frozen=True, eq=False)
class Pieces:
    r"""q(s) = c0 + c1 s + c2 s² + c3 s³ for 0 ≤ s ≤ h on each of N pieces.

    Attributes:
        start: When each piece begins, shape (N,) [s].
        duration: h, shape (N,) [s].
        c: c0 to c3, shape (4, N, nq).
    """

    start: Array
    duration: Array
    c: Array

    def at(self, piece: Indices, s: Array) -> tuple[Array, Array, Array]:
        """Positions, velocities and accelerations, shape (M, nq) each, at s [s] into the pieces."""
        q, v, a = np.empty((3, len(piece), self.c.shape[2]))
        compiled.at(piece, s, self.c, q, v, a)
        return q, v, a

    @property
    def end(self) -> Array:
        """Positions at the end, shape (nq,)."""
        return self.at(np.array([len(self.start) - 1]), self.duration[-1:])[0][0]

    def columns(self, coordinates: Indices) -> "Pieces":
        """The same pieces with these coordinates only."""
        if np.array_equal(coordinates, self.moving):
            return self.moved
        return Pieces(self.start, self.duration, np.ascontiguousarray(self.c[:, :, coordinates]))

    def part(self, first: int, end: int) -> "Pieces":
        """Those pieces from `first` on that come before `end`."""
        return Pieces(
            self.start[first:end], self.duration[first:end], np.ascontiguousarray(self.c[:, first:end])
        )

    @cached_property
    def moving(self) -> Indices:
        """The coordinates that do not stand still on all pieces."""
        return np.flatnonzero((self.c[1:] != 0).any(axis=(0, 1)))

    @cached_property
    def moved(self) -> "Pieces":
        """The same pieces with those coordinates only."""
        return Pieces(self.start, self.duration, np.ascontiguousarray(self.c[:, :, self.moving]))

    @cached_property
    def extremes(self) -> tuple[Array, Array]:
        """What `positions` gives; kept, so not to be changed."""
        values, s = np.empty_like(self.c), np.empty_like(self.c)
        compiled.extremes(self.c, self.duration, values, s)
        return values, s

    def of(self, k: int) -> Array:
        """What `positions` gives of coordinate k, shape (4, N)."""
        (own,) = np.nonzero(self.moving == k)
        if not len(own):
            return np.full((4, len(self.start)), self.c[0, 0, k])
        return positions(self.moved)[0][:, :, own[0]]

    @cached_property
    def farthest(self) -> Array:
        """How far each coordinate comes from 0 at most, shape (nq,) [rad or m]."""
        far = np.abs(self.c[0, 0])
        far[self.moving] = np.abs(positions(self.moved)[0]).max(axis=(0, 1))
        return far


def hermite(times: Array, q: Array, v: Array) -> Pieces:
    """Cubic Hermite pieces through T samples of q and v, shape (T, nq)."""
    c = np.empty((4, len(times) - 1, q.shape[1]))
    compiled.hermite(*map(np.ascontiguousarray, (times, q, v)), c)
    return Pieces(times[:-1], np.diff(times), c)


def positions(pieces: Pieces) -> tuple[Array, Array]:
    """Exact candidates for the extreme positions of each piece, shape (4, N, nq), and their s [s]."""
    return pieces.extremes


def ahead(pieces: Pieces, seconds: Array) -> Pieces:
    """Where each coordinate would be some seconds later, shape (nq,), if it kept the velocity that it has."""
    c = pieces.c.copy()
    c[:3] += np.arange(1, 4)[:, None, None] * pieces.c[1:] * seconds
    return Pieces(pieces.start, pieces.duration, c)


def velocities(pieces: Pieces) -> tuple[Array, Array]:
    """Exact candidates for the extreme velocities of each piece, shape (3, N, nq), and their s [s]."""
    _, c1, c2, c3 = pieces.c
    h = np.broadcast_to(pieces.duration[:, None], c1.shape)
    with np.errstate(divide="ignore", invalid="ignore"):
        s = np.stack((np.zeros_like(c1), h, -c2 / (3 * c3)))
    s = np.where(np.isfinite(s), np.clip(s, 0, h), 0)
    return c1 + s * (2 * c2 + 3 * s * c3), s


def accelerations(pieces: Pieces) -> tuple[Array, Array]:
    """Extreme accelerations of each piece, which are at its ends: shape (2, N, nq), and their s [s]."""
    _, c1, c2, c3 = pieces.c
    h = np.broadcast_to(pieces.duration[:, None], c1.shape)
    s = np.stack((np.zeros_like(c1), h))
    return 2 * c2 + 6 * s * c3, s


def sideways(base: Pieces, ahead: float, slack: float) -> tuple[Array, Array, float]:
    r"""How fast a point before the base's origin moves across its heading.

    That is :math:`|-\sin\theta\,\dot x + \cos\theta\,\dot y + r\dot\theta|`, and changes by at most
    :math:`|a| + |\dot\theta||v| + r|\ddot\theta|` a second. It is looked at so often that it changes by less
    than `slack` around each look, as far as there is room; the bounds hold however often that is.

    Args:
        base: x, y [m], yaw [rad].
        ahead: r [m].
        slack: [m/s].

    Returns:
        The largest on each piece [m/s], and about when [s], shape (N,) each; and its integral [m].
    """
    v, a = (np.abs(rates(base)[0]).max(axis=0) for rates in (velocities, accelerations))
    linear = np.hypot(a[:, 0], a[:, 1]) + v[:, 2] * np.hypot(v[:, 0], v[:, 1])
    steepest = linear + abs(ahead) * a[:, 2]
    count = np.clip(np.ceil(base.duration * steepest / (2 * slack)), 1, LOOKS)
    count = np.maximum(count * min(1.0, MOST_LOOKS / count.sum()), 1).astype(np.intp)
    most, times, path = np.empty(len(count)), np.empty(len(count)), 0.0
    ends, first = np.cumsum(count), 0
    while first < len(count):
        before = ends[first] - count[first]
        last = max(int(np.searchsorted(ends, before + LOOKS, side="right")), first + 1)
        own = np.arange(first, last)
        begins = ends[own] - count[own] - before
        piece = np.repeat(own, count[own])
        part = np.arange(len(piece)) - np.repeat(begins, count[own]) + 0.5
        width = (base.duration / count)[piece]
        q, rate, _ = base.at(piece, part * width)
        across = -np.sin(q[:, 2]) * rate[:, 0] + np.cos(q[:, 2]) * rate[:, 1]
        speed = np.abs(across + ahead * rate[:, 2])
        bound = speed + steepest[piece] * width / 2
        most[own] = np.maximum.reduceat(bound, begins)
        at = np.flatnonzero(bound == most[piece])[::-1]
        times[piece[at]] = base.start[piece[at]] + part[at] * width[at]
        # From the middle of an interval to its ends the speed gains steepest · width / 4 on average at most.
        path += float(((speed + steepest[piece] * width / 4) * width).sum())
        first = last
    return most, times, path


@dataclass(frozen=True, slots=True, eq=False)
class Spans:
    """Intervals of time, and what the coordinates do on each.

    Attributes:
        start, end, middle: Shape (U,) [s].
        q, v: At the middle, shape (U, nq).
        shift: Bound on |q(t) - q(middle)| over the interval, shape (U, nq).
        v_max, a_max: Bounds on |velocity| and |acceleration|, shape (U, nq); `inf` for an interval
            of several pieces.
    """

    start: Array
    end: Array
    middle: Array
    q: Array
    v: Array
    shift: Array
    v_max: Array
    a_max: Array

    @property
    def arrays(self) -> tuple[Array, ...]:
        """What compiled loops take: start, end, shift, v_max, a_max."""
        return self.start, self.end, self.shift, self.v_max, self.a_max


class Timeline:
    """A binary tree of intervals over the pieces of a motion.

    Level `depth` has one interval for each piece (filled up with empty ones to a power of two), the
    levels above join neighbours, those below halve a piece. Interval i of one level is halved into
    2i and 2i + 1 of the next.
    """

    def __init__(self, pieces: Pieces) -> None:
        count = len(pieces.start)
        self.pieces, self.depth = pieces, int(np.ceil(np.log2(count)))
        self.end = float(pieces.start[-1] + pieces.duration[-1])
        pad = 2**self.depth - count
        self._knots = np.concatenate((pieces.start, np.full(pad + 1, self.end)))
        candidates, _ = positions(pieces)
        bottom = 2**self.depth - 1  # the first row of the last level: level k has rows from 2**k - 1 on
        self._low, self._high = np.empty((2, 2 * bottom + 1, pieces.c.shape[2]))
        for rows, extreme, of_two in (
            (self._low, candidates.min(axis=0), np.minimum),
            (self._high, candidates.max(axis=0), np.maximum),
        ):
            rows[bottom : bottom + count] = extreme
            rows[bottom + count :] = candidates[1, -1]  # positions at the end of the motion
            for begin in (2**level - 1 for level in reversed(range(self.depth))):
                below = rows[2 * begin + 1 : 4 * begin + 3]
                of_two(below[::2], below[1::2], out=rows[begin : 2 * begin + 1])

    def interval(self, level: int, index: Indices) -> tuple[Array, Array]:
        """Start and end of intervals, shape (U,) each [s]."""
        spans = self.spans(level, index)
        return spans.start, spans.end

    def spans(self, level: int, index: Indices) -> Spans:
        """What the coordinates do on intervals of one level."""
        start, end, middle = times = tuple(np.empty((3, len(index))))
        q, v, shift, v_max, a_max = np.empty((5, len(index), self.pieces.c.shape[2]))
        tree = self._knots, self.pieces.c, self._low, self._high
        compiled.spans(level, self.depth, index, *tree, times, q, v, shift, v_max, a_max)
        return Spans(start, end, middle, q, v, shift, v_max, a_max)
