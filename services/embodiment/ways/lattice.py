"""Drives over a lattice of base poses: complete at its resolution.

A* (Hart, Nilsson and Raphael 1968) from the goal, which is the end that tends to be shut in. Poses are
checked when they are reached, and kept; the pieces between them are checked when a way is found, and
those that are not free are left out of the next one.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Drive
from services.embodiment.ways import cells
from services.embodiment.ways.spaces import TURN_REACH, DriveSpace

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Node = tuple[int, int, int]

CELL = 0.1  # [m] between poses
HEADINGS = 16  # of a full turn; even ones lie along the lattice or its diagonals
BEYOND = 4.0  # [m] beyond start and goal that is searched
MOST = 12_000  # poses from which one search goes on
REPAIRS = 40  # ways of one search that turn out not to be free
GREED = 2.0  # [1] weight of the distance that is left: ways may be longer by this

_TURN = 2 * np.pi / HEADINGS
_LENGTHS = np.array([CELL * float(np.hypot(a, b)) for a, b in cells.STEPS] + 2 * [TURN_REACH * _TURN])


@dataclass(slots=True, eq=False)
class _Cells:
    """What is known of the poses (i, j, k) in a box; each is a number, in the order of (i, j, k).

    Attributes:
        first: i and j of the first.
        shape: How many there are of i, j and k.
        status: Whether each is free, if that is known.
        barred: Moves from each that are not, as bits.
    """

    first: tuple[int, int]
    shape: tuple[int, int, int]
    status: NDArray[np.int8] = field(init=False)
    barred: NDArray[np.uint16] = field(init=False)
    marks: NDArray[np.int32] = field(init=False)
    far: Array = field(init=False)
    before: Indices = field(init=False)
    runs: int = 0

    def __post_init__(self) -> None:
        count = int(np.prod(self.shape))
        self.status, self.barred = np.zeros(count, np.int8), np.zeros(count, np.uint16)
        self.marks, self.far, self.before = (
            np.zeros((2, count), np.int32),
            np.empty(count),
            np.empty(count, np.int64),
        )

    def number(self, node: Node) -> int:
        (i, j), (_, width, turns) = self.first, self.shape
        return ((node[0] - i) * width + node[1] - j) * turns + node[2]

    def nodes(self, numbers: Indices) -> NDArray[np.int64]:
        """Shape (N, 3)."""
        i, j, k = np.unravel_index(numbers, self.shape)
        return np.stack([i + self.first[0], j + self.first[1], k], axis=1)

    def covering(self, low: tuple[int, int], high: tuple[int, int]) -> "_Cells":
        """These, or more that cover i and j from `low` to `high` too."""
        end = self.first[0] + self.shape[0] - 1, self.first[1] + self.shape[1] - 1
        first = min(low[0], self.first[0]), min(low[1], self.first[1])
        last = max(high[0], end[0]), max(high[1], end[1])
        if first == self.first and last == end:
            return self
        more = _Cells(first, (last[0] - first[0] + 1, last[1] - first[1] + 1, HEADINGS))
        at = tuple(
            slice(own - new, own - new + size)
            for own, new, size in zip(self.first, first, self.shape, strict=False)
        )
        for name in ("status", "barred"):
            getattr(more, name).reshape(more.shape)[at] = getattr(self, name).reshape(self.shape)
        return more


@dataclass(slots=True, eq=False)
class Lattice:
    """Base poses (CELL · i, CELL · j, 2π/HEADINGS · k) of a parked robot in one scene.

    Attributes:
        shut: Poses from which no start was reached, all of their neighbours known.
        room: Floor below the most of these that end nowhere but at what is not free [m²]; 0 if none do.
    """

    space: DriveSpace
    shut: set[Node] = field(default_factory=set[Node])
    room: float = 0.0
    _cells: _Cells | None = None

    def begin(self) -> None:
        """Forget what another question learned, but whether poses are free: that changes no answer."""
        self.shut.clear()
        self.room = 0.0
        if self._cells is not None:
            self._cells.barred[:] = 0

    def road(self, start: Array, goal: Array, late: Callable[[], bool]) -> list[Array] | None:
        """Base poses of a free drive between start and goal, both left out, or None."""
        firsts, lasts = list(self._joined(goal)), list(self._joined(start))
        if not firsts or not lasts:
            return None
        ends = np.stack([start[:2], goal[:2]])
        low = np.ceil((ends.min(axis=0) - BEYOND) / CELL).astype(int).tolist()
        high = np.floor((ends.max(axis=0) + BEYOND) / CELL).astype(int).tolist()
        if self._cells is None:
            self._cells = _Cells((low[0], low[1]), (high[0] - low[0] + 1, high[1] - low[1] + 1, HEADINGS))
        known = self._cells = self._cells.covering((low[0], low[1]), (high[0], high[1]))
        (i, j) = known.first
        box = np.array([low[0] - i, high[0] - i, low[1] - j, high[1] - j])
        for _ in range(REPAIRS):
            nodes = self._way(known, (firsts, lasts), start, box, late)
            if nodes is None or self._clear(known, nodes):
                return None if nodes is None else self._poses(nodes[::-1], start)
        return None

    def shut_in(self, goal: Array) -> bool:
        """Whether a pose leads among those from which no start was reached."""
        return next(self._joined(goal, self.shut), None) is not None if self.shut else False

    def _poses(self, nodes: list[Node], start: Array) -> list[Array]:
        """The nodes' poses, their headings without jumps from that of the start."""
        poses, last = [], float(start[2])
        for node in nodes:
            pose = _pose(node)
            pose[2] += 2 * np.pi * np.round((last - pose[2]) / (2 * np.pi))
            last = float(pose[2])
            poses.append(pose)
        return poses

    def _joined(self, pose: Array, among: set[Node] | None = None) -> Iterator[Node]:
        """Nodes around a pose that a free piece joins to it; only some, if they are told."""
        i, j, k = [*np.floor(pose[:2] / CELL).astype(int).tolist(), round(pose[2] / _TURN)]
        for node in ((i + a, j + b, (k + c) % HEADINGS) for a in (0, 1) for b in (0, 1) for c in (0, 1, -1)):
            if among is not None and node not in among:
                continue
            there = _pose(node)
            there[2] += 2 * np.pi * np.round((pose[2] - there[2]) / (2 * np.pi))
            if self.space.free(pose, there):
                yield node

    def _clear(self, known: _Cells, nodes: list[Node]) -> bool:
        """Whether all pieces between the nodes are free; those that are not are barred."""
        if self.space.free_along(np.array(self._poses(nodes, _pose(nodes[0])))):
            return True
        if len(nodes) > 2:
            middle = len(nodes) // 2
            for part in (nodes[: middle + 1], nodes[middle:]):
                self._clear(known, part)
        else:
            for start, end in (nodes, nodes[::-1]):
                known.barred[known.number(start)] |= np.uint16(1 << _move(start, end))
        return False

    def _way(
        self,
        known: _Cells,
        ends: tuple[list[Node], list[Node]],
        start: Array,
        box: Indices,
        late: Callable[[], bool],
    ) -> list[Node] | None:
        """Nodes from one of the first to one of the last; None if there is no way, or it is too far."""
        firsts, lasts = (np.array(sorted(map(known.number, each)), np.int64) for each in ends)
        known.runs += 1
        run, room = known.runs, len(firsts) + cells.MOVES * (MOST + 1)
        known.marks[0, firsts], known.far[firsts], known.before[firsts] = run, 0.0, -1
        queue, waiting = np.zeros(room), np.empty(room, np.int64)
        waiting[: len(firsts)] = firsts
        grid = np.array(known.shape), box, known.status, known.barred
        target = np.array([*known.first, CELL, start[0], start[1], GREED])
        fixed = grid, self.space.drive is Drive.OMNI, _LENGTHS, target, MOST, lasts, run
        heap = queue, waiting, np.array([len(firsts), 0])
        asked = np.empty(cells.AHEAD * cells.MOVES, np.int64)
        while True:
            said, count = cells.search(*fixed, known.marks, known.far, known.before, heap, asked)
            if said != cells.ASKED:
                break
            if late():
                return None
            free = self.space.stand_free(known.nodes(asked[:count]).astype(np.float64) * _POSE)
            known.status[asked[:count]] = np.where(free, cells.FREE, cells.TAKEN)
        if said == cells.FOUND:
            return _back(known, count)
        if said == cells.NONE:
            reached = known.nodes(np.flatnonzero(known.marks[1] == run))
            self.shut |= {(i, j, k) for i, j, k in reached.tolist()}
            self._measure(reached[:, :2], box + np.repeat(known.first, 2))
        return None

    def _measure(self, reached: Indices, box: Indices) -> None:
        """Keep the floor below places (N, 2), unless some are at the end of what was searched."""
        if not ((reached == box[::2]) | (reached == box[1::2])).any():
            self.room = max(self.room, CELL**2 * len(np.unique(reached, axis=0)))


_POSE = np.array([CELL, CELL, _TURN])


def _pose(node: Node) -> Array:
    return _POSE * node


def _move(one: Node, other: Node) -> int:
    """Which move leads from one node to the next."""
    way = other[0] - one[0], other[1] - one[1]
    if way in cells.STEPS:
        return cells.STEPS.index(way)
    return len(cells.STEPS) + (other[2] != (one[2] + 1) % HEADINGS)


def _back(known: _Cells, number: int) -> list[Node]:
    """The way from the first node to this one."""
    numbers = [number]
    while (before := int(known.before[numbers[-1]])) >= 0:
        numbers.append(before)
    return [(i, j, k) for i, j, k in known.nodes(np.array(numbers[::-1])).tolist()]
