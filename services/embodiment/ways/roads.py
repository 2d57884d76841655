"""Roads: how a parked robot drives among the furniture.

A probabilistic roadmap (Kavraki et al. 1996), grown only as far as a question needs it. Containers of one
kitchen share what is known of free poses, and nothing else: no answer depends on what was asked before.
"""

import heapq
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Drive
from services.embodiment.body.limb import Limb
from services.embodiment.body.parked import Parked
from services.embodiment.body.world import Rules, World
from services.embodiment.ways.lattice import Lattice
from services.embodiment.ways.spaces import DriveSpace

Array = NDArray[np.float64]

NEIGHBOURS = 7  # nodes that a new node is joined to, if it can be
BATCH = 16  # nodes by which a roadmap grows at once
LARGEST = 240  # nodes in all
SHORTCUTS = 30
DETOUR = 2.0  # [m] beyond start and goal that nodes are drawn


@dataclass(slots=True, eq=False)
class Roads:
    """A roadmap of base poses (x, y, yaw).

    Attributes:
        space: Decides what is free.
        posture: x with the arm as it is carried, the base at 0, shape (n,).
        nodes: Free base poses.
        edges: (one, other, length) of nodes that a free straight piece joins.
        lattice: Where the roadmap has a gap.
    """

    space: DriveSpace
    posture: Array
    lattice: Lattice
    rng: np.random.Generator = field(default_factory=np.random.default_rng)
    nodes: list[Array] = field(default_factory=list[Array])
    edges: list[tuple[int, int, float]] = field(default_factory=list[tuple[int, int, float]])

    def begin(self, seed: int) -> None:
        """Be ready for another question, as if it were the first."""
        self.rng = np.random.default_rng(seed)
        self.nodes.clear()
        self.edges.clear()
        self.lattice.begin()

    def road(self, start: Array, goal: Array, growths: int, late: Callable[[], bool]) -> Array | None:
        """Corners of a free drive, shape (K, 3), or None if it needs a larger roadmap.

        The roadmap may grow `growths` times for this question, unless it is `late`.
        """
        if self.space.free(start, goal):
            return self.space.edge(start, goal)
        if self.lattice.shut_in(goal):
            return None
        ends = np.stack([start, goal])
        box = ends[:, :2].min(axis=0) - DETOUR, ends[:, :2].max(axis=0) + DETOUR
        for growth in range(growths + 1):
            path = self._path(self._ways(start), self._ways(goal))
            if path is not None:
                return self._shortened([start, *path, goal])
            if growth == growths or len(self.nodes) > LARGEST or late():
                break
            self._grow(box)
        path = self.lattice.road(start, goal, late) if growths else None
        return None if path is None else self._ended(start, path, goal)

    def _ended(self, start: Array, path: list[Array], goal: Array) -> Array:
        """The drive over these poses, as short as shortcuts make it, ending at the goal's very heading."""
        end = goal.copy()
        end[2] += 2 * np.pi * np.round((path[-1][2] - goal[2]) / (2 * np.pi))
        return self._shortened(self._pulled([start, *path, end]))

    def _pulled(self, path: list[Array]) -> list[Array]:
        """Those of the poses that are left when each leads straight as far on as halving the rest finds."""
        at, kept = 0, [path[0]]
        while at < len(path) - 1:
            there = len(path) - 1
            while there > at + 1 and not self.space.free(path[at], path[there]):
                there = (at + there) // 2
            kept.append(path[there])
            at = there
        return kept

    def _grow(self, box: tuple[Array, Array]) -> None:
        grown = 0
        for _ in range(20 * BATCH):
            pose = np.append(self.rng.uniform(*box), self.rng.uniform(-np.pi, np.pi))
            if self.space.stands(pose):
                self.edges.extend((k, len(self.nodes), length) for k, length in self._ways(pose))
                self.nodes.append(pose)
                grown += 1
                if grown == BATCH:
                    return

    def _ways(self, pose: Array) -> list[tuple[int, float]]:
        """Nodes near a pose that a free straight piece joins to it, each with its length."""
        if not self.nodes:
            return []
        apart = self.space.distance(pose, np.array(self.nodes))
        near = np.argsort(apart, kind="stable")[:NEIGHBOURS]
        return [(int(k), float(apart[k])) for k in near if self.space.free(self.nodes[k], pose)]

    def _path(self, first: list[tuple[int, float]], last: list[tuple[int, float]]) -> list[Array] | None:
        """Shortest way over nodes from one of the first to one of the last."""
        if not first or not last:
            return None
        count = len(self.nodes)
        links = [*self.edges, *((k, count, d) for k, d in first), *((k, count + 1, d) for k, d in last)]
        path = shortest(links, count, count + 1)
        return None if path is None else [self.nodes[k] for k in path[1:-1]]

    def _shortened(self, path: list[Array]) -> Array:
        for _ in range(SHORTCUTS):
            if len(path) < 3:
                break
            i, j = sorted(self.rng.choice(len(path), 2, replace=False))
            if j - i > 1 and self.space.free(path[i], path[j]):
                path = path[: i + 1] + path[j:]
        corners = [path[0][None]]
        corners.extend(self.space.edge(one, other)[1:] for one, other in pairwise(path))
        return np.concatenate(corners)


Known = dict[tuple[str, bool], Roads]
"""Those of a scene, by gripper, and whether its arm is parked."""


def make_roads(world: World, limb: Limb, posture: Array, rules: Rules, drive: Drive) -> Roads:
    """An empty roadmap for the robot with that limb carried so, its hand open."""
    space = DriveSpace(Parked(world, limb.q(posture), rules), drive)
    return Roads(space, posture, Lattice(space))


def shortest(links: list[tuple[int, int, float]], start: int, goal: int) -> list[int] | None:
    """The shortest way over links (one, other, length), start and goal included (Dijkstra 1959)."""
    beside: dict[int, list[tuple[int, float]]] = {}
    for one, other, length in links:
        beside.setdefault(one, []).append((other, length))
        beside.setdefault(other, []).append((one, length))
    came: dict[int, int] = {}
    ahead = [(0.0, start, start)]
    while ahead and goal not in came:
        far, node, before = heapq.heappop(ahead)
        if node not in came:
            came[node] = before
            for other, length in beside.get(node, ()):
                if other not in came:
                    heapq.heappush(ahead, (far + length, other, node))
    if goal not in came:
        return None
    path = [goal]
    while path[-1] != start:
        path.append(came[path[-1]])
    return path[::-1]
