"""Distances between all pairs of bodies, between samples too.

A pair is clear on an interval if its distance at the middle exceeds what it must keep by more than
the two bodies can approach each other until the ends (`Kinematics.bounds`); else the interval is
halved for that pair alone, down to a resolution at which the pair is refused.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import OracleRejectedError
from services.embodiment.certify.sweep import compiled, telling
from services.embodiment.certify.sweep.kinematics import Kinematics, Placed
from services.embodiment.certify.sweep.pieces import Spans, Timeline
from services.embodiment.certify.sweep.shapes import Shapes

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

NEAR = 0.02  # [m] smallest distances above this are not looked for more closely
PRECISION = 0.001  # [m] of the smallest distance and the deepest penetration that are reported
PROMPT = 0.02  # [s] precision of the first time of a violation
SHORTEST = 1e-5  # [s] an interval that is not halved any more
HOPELESS = 0.01  # [m] above this shift, pairs that are nearer are halved, however much nearer they are
ROOM = 100_000  # items for which there is room at first; more are counted, and then room is made
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
    """Pairs on intervals of one level, in the order of time: indices of both, shape (M,) each."""

    pair: Indices = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    interval: Indices = field(default_factory=lambda: np.zeros(0, dtype=np.intp))

    def where(self, mask: NDArray[np.bool_] | slice) -> "Items":
        """Some of the items."""
        return Items(self.pair[mask], self.interval[mask])

    def halves(self) -> "Items":
        """Both halves of each interval."""
        both = np.concatenate((2 * self.interval, 2 * self.interval + 1))
        order = np.argsort(both, kind="stable")
        return Items(np.concatenate((self.pair, self.pair))[order], both[order])

    def spans(self) -> tuple[Indices, Indices]:
        """The intervals, each once, and which of them each item has."""
        new = np.ones(len(self), dtype=bool)
        np.not_equal(self.interval[1:], self.interval[:-1], out=new[1:])
        return self.interval[new], np.cumsum(new) - 1

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
        low, high = np.empty((2, len(intervals), len(self.shapes.radius), 3))
        path, turning = self.kinematics.path, self.kinematics.revolute
        compiled.swept(self.shapes.placing, placed.arrays, spans.arrays, path, turning, low, high)
        least, room = float(self.pairs.least.max()) + NEAR, len(self.pairs.shapes) + ROOM
        while True:
            which, pair = np.empty((2, room), dtype=np.intp)
            count = telling.starting(self.pairs.shapes, low, high, least, which, pair)
            if count <= room:
                return Items(pair[:count], intervals[which[:count]])
            room = count

    def _step(self, level: int, items: Items, resolution: float) -> Items:
        """Those items which have to be halved; what the others say is in `found`."""
        unique, span = items.spans()
        spans = self.timeline.spans(level, unique)
        placed = self.kinematics.place(spans.q, spans.v)
        done, (distance, approach, between) = self._looked_at(items, span, spans, placed)
        left = np.flatnonzero(done == telling.LEFT)
        if len(left):
            pairs = self.pairs.shapes[items.pair[left]]
            distance[left] = self.shapes.distances(placed, span[left], pairs)
        low, last, seen = np.empty(len(items)), np.empty(len(items), bool), np.empty(len(items), np.int8)
        queries, sane = telling.settle(
            (items.pair, span),
            self.pairs.shapes,
            self._keep,
            self.shapes.radius,
            spans.arrays,
            spans.middle,
            (done, distance, approach, between),
            self.found.slack,
            (resolution, SHORTEST, PRECISION),
            low,
            last,
            seen,
        )
        if not sane:
            raise OracleRejectedError("a distance between two bodies came out larger than it can be")
        self.found.queries += queries
        for i in np.flatnonzero(seen):
            one, other = self.pairs.shapes[items.pair[i]].tolist()
            time = float(spans.middle[span[i]])
            held = time >= self.pairs.held_from
            least = float((self.pairs.least_held if held else self.pairs.least)[items.pair[i]])
            self.found.saw(Distance((one, other), time, float(distance[i]), least, bool(seen[i] < 2)))
        return items.where(self._open(low, spans.start[span]) & ~last)

    def _looked_at(
        self, items: Items, span: Indices, spans: Spans, placed: Placed
    ) -> tuple[NDArray[np.int64], Array]:
        """What was done about each item; distance, approach, distance of centres, shape (3, M)."""
        done, out = np.empty(len(items), dtype=np.int64), np.empty((3, len(items)))
        first = self.found.first
        telling.look(
            (items.pair, span),
            self.pairs.shapes,
            self._keep,
            self.shapes.placing,
            self.shapes.convex,
            placed.arrays,
            spans.arrays,
            self.kinematics.path,
            self.kinematics.revolute,
            self.found.slack,
            np.inf if first is None else first.time - PROMPT,
            (PRECISION, HOPELESS, SHORTEST),
            (done, out[0], out[1], out[2]),
        )
        return done, out

    @property
    def _keep(self) -> tuple[Array, Array, float]:
        """What compiled loops take of the distances to be kept."""
        return self.pairs.least, self.pairs.least_held, self.pairs.held_from

    def _open(self, low: Array, start: Array) -> NDArray[np.bool_]:
        """Whether items with this lower bound on their slack can still tell something."""
        lower_than_seen = low < self.found.slack - PRECISION
        if self.found.first is None:
            return lower_than_seen | (low <= 0)
        return lower_than_seen | ((low <= 0) & (start < self.found.first.time - PROMPT))
