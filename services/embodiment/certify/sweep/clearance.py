"""Distances between all pairs of bodies, between samples too.

A pair is clear on an interval if its distance at the middle exceeds what it must keep by more than
the two bodies can approach each other until the ends (`Kinematics.bounds`); else the interval is
halved for that pair alone, down to a resolution at which the pair is refused.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import OracleRejectedError
from services.embodiment.certify.sweep.kinematics import WORLD, Kinematics, Of, Placed
from services.embodiment.certify.sweep.pieces import Spans, Timeline
from services.embodiment.certify.sweep.shapes import Shapes

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

NEAR = 0.02  # [m] smallest distances above this are not looked for more closely
PRECISION = 0.001  # [m] of the smallest distance and the deepest penetration that are reported
PROMPT = 0.02  # [s] precision of the first time of a violation
SHORTEST = 1e-5  # [s] an interval that is not halved any more
HOPELESS = 0.01  # [m] above this shift, pairs whose centres are nearer are halved without a query
CHUNK = 20_000  # items that are looked at together, for memory
MOST_ITEMS = 2_000_000  # pairs × intervals of one level: more means a motion too wild to be checked


@dataclass(frozen=True, slots=True, eq=False)
class Pairs:
    """Pairs of shapes to be kept apart.

    Attributes:
        shapes: Shape (P, 2); the bound is on the motion of the first against the second.
        least: Distance to be kept [m], shape (P,).
        least_held: Distance to be kept from `held_from` on [m], shape (P,).
        held_from: [s].
    """

    shapes: Indices
    least: Array
    least_held: Array
    held_from: float


@dataclass(frozen=True, slots=True)
class Distance:
    """Signed distance of a pair of shapes at a time, and what it had to keep.

    Attributes:
        resolved: False where the pair is not shown to keep its distance, nor to miss it.
    """

    pair: tuple[int, int]
    time: float
    value: float
    least: float
    resolved: bool = True


@dataclass(slots=True)
class Clearance:
    """What is known of a set of pairs.

    Attributes:
        worst: The least slack that was seen, None where nothing came nearer than `NEAR`.
        first: The first violation.
        queries: Distance computations.
        gave_up: Time of an interval that was left unresolved because there were too many.
    """

    worst: Distance | None = None
    first: Distance | None = None
    queries: int = 0
    gave_up: float | None = None

    @property
    def slack(self) -> float:
        """Least slack so far [m]; `NEAR` where nothing is nearer."""
        return NEAR if self.worst is None else min(NEAR, self.worst.value - self.worst.least)

    def saw(self, distance: Distance) -> None:
        """One more distance is known."""
        if distance.value - distance.least < self.slack:
            self.worst = distance
        violated = distance.value < distance.least or not distance.resolved
        if violated and (self.first is None or distance.time < self.first.time):
            self.first = distance


@dataclass(frozen=True, slots=True, eq=False)
class Items:
    """Pairs on intervals of one level: index of the pair and of the interval, shape (M,) each."""

    pair: Indices = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    interval: Indices = field(default_factory=lambda: np.zeros(0, dtype=np.intp))

    def where(self, mask: NDArray[np.bool_] | slice) -> "Items":
        """Some of the items."""
        return Items(self.pair[mask], self.interval[mask])

    def halves(self) -> "Items":
        """Both halves of each interval."""
        both = np.concatenate((2 * self.interval, 2 * self.interval + 1))
        return Items(np.tile(self.pair, 2), both)

    def __len__(self) -> int:
        return len(self.pair)


class Sweep:
    """The search over intervals for one set of pairs.

    Attributes:
        found: What is known so far.
    """

    def __init__(self, timeline: Timeline, kinematics: Kinematics, shapes: Shapes, pairs: Pairs) -> None:
        self.timeline, self.kinematics, self.shapes, self.pairs = timeline, kinematics, shapes, pairs
        self.found = Clearance()

    def run(self, level: int, resolution: float) -> Clearance:
        """Every pair on the whole motion, beginning with the intervals of one level.

        Args:
            level: Level of the timeline at which the search begins.
            resolution: Pairs which keep less than this above their least distance may be refused [m].
        """
        items = self._start(level)
        while len(items):
            if len(items) > MOST_ITEMS:
                start, _ = self.timeline.interval(level, items.interval)
                self.found.gave_up = float(start.min())
                return self.found
            chunks = range(0, len(items), CHUNK)
            kept = [self._step(level, items.where(slice(i, i + CHUNK)), resolution) for i in chunks]
            items = Items(np.hstack([k.pair for k in kept]), np.hstack([k.interval for k in kept])).halves()
            level += 1
        return self.found

    def _start(self, level: int) -> Items:
        """Pairs whose boxes, swept over an interval, come near each other."""
        start, end = self.timeline.interval(level, np.arange(2**level))
        intervals = np.flatnonzero(end > start)
        spans = self.timeline.spans(level, intervals)
        placed = self.kinematics.place(spans.q, spans.v)
        ones, others = np.unique(self.pairs.shapes[:, 0]), np.unique(self.pairs.shapes[:, 1])
        least = float(self.pairs.least.max())
        near = _overlapping(
            self._swept(spans, placed, ones), self._swept(spans, placed, others), least + NEAR
        )
        one, other = (
            np.searchsorted(ones, self.pairs.shapes[:, 0]),
            np.searchsorted(others, self.pairs.shapes[:, 1]),
        )
        which, pair = np.nonzero(near[:, one, other])
        return Items(pair, intervals[which])

    def _swept(self, spans: Spans, placed: Placed, shapes: Indices) -> tuple[Array, Array]:
        """Lowest and highest corners of boxes that contain shapes all through the spans, shape (U, S, 3)."""
        count = len(spans.start)
        span, shape = np.repeat(np.arange(count), len(shapes)), np.tile(shapes, count)
        centre = self.shapes.centres(placed, span, shape)
        carrier, radius = self.shapes.carrier[shape], self.shapes.radius[shape]
        ball = Of(span, carrier, np.full_like(carrier, WORLD), centre, radius)
        moved, _ = self.kinematics.bounds(spans, placed, ball)
        half = self.shapes.extents(placed, span, shape) + moved[:, None]
        size = (count, len(shapes), 3)
        return (centre - half).reshape(size), (centre + half).reshape(size)

    def _step(self, level: int, items: Items, resolution: float) -> Items:
        """Those items which have to be halved; what the others say is in `found`."""
        unique, span = np.unique(items.interval, return_inverse=True)
        spans = self.timeline.spans(level, unique)
        placed = self.kinematics.place(spans.q, spans.v)
        one, other = self.pairs.shapes[items.pair].T
        centre, between, floor = self._boxes(placed, span, one, other)
        carrier, against = self.shapes.carrier[one], self.shapes.carrier[other]
        ball = Of(span, carrier, against, centre, self.shapes.radius[one])
        approach, _ = self.kinematics.bounds(spans, placed, ball)
        least, now = self._least(items.pair, spans, span)
        width = (spans.end - spans.start)[span]
        hopeless = (between < approach + least) & (approach > HOPELESS) & (width > SHORTEST)
        ask = ~hopeless & self._open(floor - approach - least, spans.start[span])
        distance = floor.copy()
        distance[ask] = self.shapes.distances(placed, span[ask], self.pairs.shapes[items.pair[ask]])
        self.found.queries += int(ask.sum())
        most = between + self.shapes.radius[one] + self.shapes.radius[other]
        if not (distance <= most + PRECISION).all():  # also true of what is not a number
            raise OracleRejectedError("a distance between two bodies came out larger than it can be")
        low = distance - approach - least
        last = ask & ((approach <= resolution) | (width <= SHORTEST))
        unresolved = last & (low <= 0) & (distance >= now)
        seen = ask & ((distance - now < self.found.slack) | (distance < now) | unresolved)
        for i in np.flatnonzero(seen):
            pair = (int(one[i]), int(other[i]))
            time = float(spans.middle[span[i]])
            self.found.saw(Distance(pair, time, float(distance[i]), float(now[i]), not unresolved[i]))
        return items.where(self._open(low, spans.start[span]) & ~last)

    def _open(self, low: Array, start: Array) -> NDArray[np.bool_]:
        """Whether items with this lower bound on their slack can still tell something."""
        lower_than_seen = low < self.found.slack - PRECISION
        if self.found.first is None:
            return lower_than_seen | (low <= 0)
        return lower_than_seen | ((low <= 0) & (start < self.found.first.time - PROMPT))

    def _boxes(
        self, placed: Placed, span: Indices, one: Indices, other: Indices
    ) -> tuple[Array, Array, Array]:
        """Centres of the first shapes, distances of the centres, and lower bounds on signed distances."""
        centre = self.shapes.centres(placed, span, one)
        between = self.shapes.centres(placed, span, other) - centre
        half = self.shapes.extents(placed, span, one) + self.shapes.extents(placed, span, other)
        gap = np.abs(between) - half
        # Boxes that overlap are separated by a shift along the axis of least overlap: no depth is more.
        boxes = np.where((gap > 0).any(axis=1), np.linalg.norm(np.maximum(gap, 0), axis=1), gap.max(axis=1))
        apart = np.linalg.norm(between, axis=1)
        balls = apart - self.shapes.radius[one] - self.shapes.radius[other]
        return centre, apart, np.maximum(boxes, balls)

    def _least(self, pair: Indices, spans: Spans, span: Indices) -> tuple[Array, Array]:
        """Distance to be kept all through an interval, and at its middle."""
        held, least = self.pairs.least_held[pair], self.pairs.least[pair]
        whole = np.where(spans.start[span] >= self.pairs.held_from, held, least)
        return whole, np.where(spans.middle[span] >= self.pairs.held_from, held, least)


def _overlapping(ones: tuple[Array, Array], others: tuple[Array, Array], least: float) -> NDArray[np.bool_]:
    """Which boxes come nearer to each other than `least` along every axis, shape (U, S, S')."""
    near = np.ones((*ones[0].shape[:2], others[0].shape[1]), dtype=bool)
    for axis in range(3):
        (low, high), (other_low, other_high) = (
            [corner[:, :, axis] for corner in box] for box in (ones, others)
        )
        near &= low[:, :, None] - least <= other_high[:, None]
        near &= other_low[:, None] <= high[:, :, None] + least
    return near
