"""Distances between all pairs of bodies, between samples too.

A pair is clear on an interval if its distance at the middle exceeds what it must keep by more than
the two bodies can approach each other until the ends (`Kinematics.bounds`); else the interval is
halved for that pair alone, down to a resolution at which the pair is refused.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from predicates.margins import LOOKED_UP_TO
from sdt_kg.errors import OracleRejectedError
from services.embodiment.certify.sweep import compiled, telling
from services.embodiment.certify.sweep.kinematics import Kinematics
from services.embodiment.certify.sweep.pieces import Timeline
from services.embodiment.certify.sweep.shapes import Shapes
from services.physics.geometry.convex import ROOM as ROOM_OF_DISTANCE

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Codes = NDArray[np.int8]

PRECISION = 0.001  # [m] of the smallest distance and the deepest penetration that are reported
PROMPT = 0.02  # [s] precision of the first time of a violation
SHORTEST = 1e-5  # [s] an interval that is not halved any more
HOPELESS = (
    0.005  # [m] above this shift, pairs whose boxes may come so near are halved, however far apart they are
)
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
        level: Level of the timeline at which the search begins.
    """

    shapes: Indices
    least: Array
    least_held: Array
    held_from: float
    level: int = 0


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
        worst: The least slack that was seen, None where nothing came nearer than `LOOKED_UP_TO`.
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
        """Least slack so far [m]; `LOOKED_UP_TO` where nothing is nearer."""
        return LOOKED_UP_TO if self.worst is None else self.worst.value - self.worst.least


@dataclass(frozen=True, slots=True, eq=False)
class Items:
    """Pairs on intervals of one level, in the order of time: indices of both, shape (M,) each."""

    pair: Indices = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    interval: Indices = field(default_factory=lambda: np.zeros(0, dtype=np.intp))

    def where(self, mask: NDArray[np.bool_] | Indices | slice) -> "Items":
        """Some of the items."""
        return Items(self.pair[mask], self.interval[mask])

    def chunks(self) -> Iterator["Items"]:
        """The items a few at a time, those of one interval together."""
        at = 0
        while at < len(self):
            last = min(at + CHUNK, len(self)) - 1
            end = int(np.searchsorted(self.interval, self.interval[last], side="right"))
            yield self.where(slice(at, end))
            at = end

    def spans(self) -> tuple[Indices, Indices]:
        """The intervals, each once, and which of them each item has."""
        intervals, which = np.empty((2, len(self)), dtype=np.intp)
        return intervals[: telling.each(self.interval, intervals, which)], which

    def __len__(self) -> int:
        return len(self.pair)


def joined(parts: Sequence[Items], *, sort: bool = False) -> Items:
    """Items of all parts; sorted, in the order of time, else as they come."""
    if len(parts) == 1:
        return parts[0]
    if not parts:
        return Items()
    both = Items(np.concatenate([p.pair for p in parts]), np.concatenate([p.interval for p in parts]))
    return both.where(np.argsort(both.interval, kind="stable")) if sort else both


class Sweep:
    """The search over intervals for some sets of pairs along one motion.

    Sets are searched together, and what is found of one shortens no search in another.

    Attributes:
        found: What is known so far of each set.
    """

    def __init__(
        self, timeline: Timeline, kinematics: Kinematics, shapes: Shapes, sets: Sequence[Pairs]
    ) -> None:
        self.timeline, self.kinematics, self.shapes, self.sets = timeline, kinematics, shapes, sets
        self.found = [Clearance() for _ in sets]
        counts = [len(each.shapes) for each in sets]
        self._pairs = np.concatenate([each.shapes for each in sets])
        self._set = np.repeat(np.arange(len(sets)), counts)
        self._begin = np.cumsum([0, *counts]).tolist()
        self._keep = (
            np.concatenate([each.least for each in sets]),
            np.concatenate([each.least_held for each in sets]),
            np.repeat([each.held_from for each in sets], counts),
        )

        self._room = (
            *(np.empty(size) for size in ((3, 3), 3, 3) * 2),
            np.zeros(ROOM_OF_DISTANCE),
            np.empty(len(kinematics.path)),
        )
        self._known = (
            np.full(len(sets), LOOKED_UP_TO),
            np.full(len(sets), np.inf),
            np.empty((2, len(sets)), dtype=np.intp),
            np.empty((2, len(sets)), dtype=bool),
            np.zeros(len(sets), dtype=np.int64),
        )

    def run(self, resolution: float) -> list[Clearance]:
        """Every pair on the whole motion.

        Args:
            resolution: Pairs which keep less than this above their least distance may be refused [m].
        """
        items, level = Items(), min(each.level for each in self.sets)
        while len(items) or any(level <= each.level for each in self.sets):
            items = self._few(level, joined([items, *self._start(level)], sort=True))
            items = joined([self._step(level, some, resolution) for some in items.chunks()])
            level += 1
        return self.found

    def _few(self, level: int, items: Items) -> Items:
        """The items without those of sets that have too many: these are given up."""
        if len(items) <= MOST_ITEMS:
            return items
        own = self._set[items.pair]
        many = np.flatnonzero(np.bincount(own, minlength=len(self.sets)) > MOST_ITEMS)
        for n in many.tolist():
            start, _ = self.timeline.interval(level, items.interval[own == n])
            self.found[n].gave_up = float(start.min())
        return items.where(~np.isin(own, many))

    def _start(self, level: int) -> Iterator[Items]:
        """Of the sets that begin at this level the pairs whose boxes, swept over an interval, come near."""
        begins = [n for n, each in enumerate(self.sets) if each.level == level and len(each.shapes)]
        if not begins:
            return
        start, end = self.timeline.interval(level, np.arange(2**level))
        intervals = np.flatnonzero(end > start)
        spans = self.timeline.spans(level, intervals)
        placed = self.kinematics.place(spans.q, spans.v)
        low, high = np.empty((2, len(intervals), len(self.shapes.radius), 3))
        path, turning = self.kinematics.path, self.kinematics.revolute
        room = *self._room[:3], self._room[-1]
        compiled.swept(self.shapes.placing, placed.arrays, spans.arrays, path, turning, room, low, high)
        for n in begins:
            which, pair = _near(self.sets[n], low, high)
            yield Items(pair + self._begin[n], intervals[which])

    def _step(self, level: int, items: Items, resolution: float) -> Items:
        """Both halves of those items which have to be halved; what the others say is in `found`."""
        unique, span = items.spans()
        spans = self.timeline.spans(level, unique)
        placed = self.kinematics.place(spans.q, spans.v)
        of, about = (items.pair, span), (self._pairs, self._keep, self._set)
        done, out = np.empty(len(items), dtype=np.int64), np.empty((3, len(items)))
        told = done, out[0], out[1], out[2]
        moves, limits = (self.kinematics.path, self.kinematics.revolute), (PRECISION, HOPELESS, SHORTEST)
        shapes, slack, first = (self.shapes.placing, self.shapes.convex), self._known[0], self._known[1]
        looked = *moves, slack, first - PROMPT, limits, self._room
        telling.look(of, *about, *shapes, placed.arrays, spans.arrays, *looked, told)
        left = np.flatnonzero(done == telling.LEFT)
        if len(left):
            out[0, left] = self.shapes.distances(placed, span[left], self._pairs[items.pair[left]])
        halves, limits = (
            np.empty((2, 2 * len(items)), dtype=np.intp),
            (resolution, SHORTEST, PRECISION, PROMPT),
        )
        size = self.shapes.radius, spans.arrays, spans.middle
        count = telling.settle(of, items.interval, *about, *size, told, self._known, limits, halves)
        if count < 0:
            raise OracleRejectedError("a distance between two bodies came out larger than it can be")
        self._saw(items, span, spans.middle, out[0])
        return Items(halves[0, :count], halves[1, :count])

    def _saw(self, items: Items, span: Indices, time: Array, distance: Array) -> None:
        """What the items of one level tell is known."""
        least, least_held, held_from = self._keep
        _, _, items_that_tell, unshown, queries = self._known
        for one, count in zip(self.found, queries.tolist(), strict=True):
            one.queries = count
        for which, n in zip(*np.nonzero(items_that_tell >= 0), strict=True):
            k = items_that_tell[which, n]
            p, when = items.pair[k], float(time[span[k]])
            keep = float((least_held if when >= held_from[p] else least)[p])
            first, second = self._pairs[p].tolist()
            seen = Distance((first, second), when, float(distance[k]), keep, not unshown[which, n])
            if which == 0:
                self.found[n].worst = seen
            else:
                self.found[n].first = seen


def _near(pairs: Pairs, low: Array, high: Array) -> tuple[Indices, Indices]:
    """Spans and pairs, in the order of time, whose boxes come near each other."""
    least, room = float(pairs.least.max()) + LOOKED_UP_TO, len(pairs.shapes) + ROOM
    while True:
        which, pair = np.empty((2, room), dtype=np.intp)
        work = *np.empty((2, 1, *low.shape[1:])), np.empty(len(pairs.shapes), dtype=np.intp)
        count = telling.starting(pairs.shapes, low, high, least, work, which, pair)
        if count <= room:
            return which[:count], pair[:count]
        room = count
