"""Drives over a lattice of base poses: complete at its resolution, where a random roadmap has gaps.

A* (Hart, Nilsson and Raphael 1968) from the goal, which is the end that tends to be shut in. Poses are
checked when they are reached, and kept; the pieces between them are checked when a way is found, and
those that are not free are left out of the next one.
"""

import heapq
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Drive
from services.embodiment.ways.spaces import TURN_REACH, DriveSpace

Array = NDArray[np.float64]
Node = tuple[int, int, int]

CELL = 0.1  # [m] between poses
HEADINGS = 16  # of a full turn; even ones lie along the lattice or its diagonals
BEYOND = 4.0  # [m] beyond start and goal that is searched
MOST = 12_000  # poses from which one search goes on
REPAIRS = 40  # ways of one search that turn out not to be free
GREED = 1.5  # [1] weight of the distance that is left: ways may be longer by this
STEPS = ((1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1))


@dataclass(slots=True, eq=False)
class Lattice:
    """Base poses (CELL · i, CELL · j, 2π/HEADINGS · k) of a parked robot in one scene.

    Attributes:
        shut: Poses from which no start was reached, all of their neighbours known.
    """

    space: DriveSpace
    shut: set[Node] = field(default_factory=set[Node])
    _free: dict[Node, bool] = field(default_factory=dict[Node, bool])
    _barred: set[tuple[Node, Node]] = field(default_factory=set[tuple[Node, Node]])

    def road(self, start: Array, goal: Array, late: Callable[[], bool]) -> list[Array] | None:
        """Base poses of a free drive between start and goal, both left out, or None."""
        firsts, lasts = list(self._joined(goal)), list(self._joined(start))
        if not firsts or not lasts:
            return None
        ends = np.stack([start[:2], goal[:2]])
        box = (ends.min(axis=0) - BEYOND) / CELL, (ends.max(axis=0) + BEYOND) / CELL
        for _ in range(REPAIRS):
            nodes = self._way(firsts, set(lasts), start, box, late)
            if nodes is None or self._clear(nodes):
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

    def _clear(self, nodes: list[Node]) -> bool:
        """Whether all pieces between the nodes are free; those that are not are barred."""
        clear = True
        for one, other in pairwise(nodes):
            here, there = self._poses([one, other], _pose(one))
            if not self.space.free(here, there):
                self._barred |= {(one, other), (other, one)}
                clear = False
        return clear

    def _way(
        self,
        firsts: list[Node],
        lasts: set[Node],
        start: Array,
        box: tuple[Array, Array],
        late: Callable[[], bool],
    ) -> list[Node] | None:
        """Nodes from one of the first to one of the last; None if there is no way, or it is too far."""
        before: dict[Node, Node | None] = dict.fromkeys(firsts)
        far = dict.fromkeys(firsts, 0.0)
        queue = [(0.0, node) for node in firsts]
        done: set[Node] = set()
        while queue:
            _, node = heapq.heappop(queue)
            if node in done:
                continue
            done.add(node)
            if node in lasts:
                return _back(before, node)
            if len(done) > MOST or late():
                return None
            for other, length in self._neighbours(node, box):
                if far[node] + length < far.get(other, np.inf):
                    far[other], before[other] = far[node] + length, node
                    left = np.hypot(other[0] * CELL - start[0], other[1] * CELL - start[1])
                    heapq.heappush(queue, (far[other] + GREED * float(left), other))
        self.shut |= done
        return None

    def _neighbours(self, node: Node, box: tuple[Array, Array]) -> list[tuple[Node, float]]:
        i, j, k = node
        found = [((i, j, (k + turn) % HEADINGS), TURN_REACH * _TURN) for turn in (1, -1)]
        for n, (a, b) in enumerate(STEPS):
            ahead = 2 * n % (HEADINGS // 2) == k % (HEADINGS // 2)
            inside = box[0][0] <= i + a <= box[1][0] and box[0][1] <= j + b <= box[1][1]
            if inside and (ahead or self.space.drive is Drive.OMNI):
                found.append(((i + a, j + b, k), CELL * float(np.hypot(a, b))))
        new = [other for other, _ in found if other not in self._free]
        if new:
            stands = self.space.stand_free(np.array([_pose(other) for other in new]))
            self._free.update(zip(new, stands, strict=True))
        return [one for one in found if self._free[one[0]] and (node, one[0]) not in self._barred]


_TURN = 2 * np.pi / HEADINGS


def _pose(node: Node) -> Array:
    return np.array([CELL * node[0], CELL * node[1], _TURN * node[2]])


def _back(before: dict[Node, Node | None], node: Node) -> list[Node]:
    """The way from the first node to this one."""
    nodes, at = [node], before[node]
    while at is not None:
        nodes.append(at)
        at = before[at]
    return nodes[::-1]
