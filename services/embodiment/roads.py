"""Roads: how a parked robot drives among the furniture.

A probabilistic roadmap (Kavraki et al. 1996) of one scene, grown only as far as questions need it
and kept for the next question: containers of one kitchen share their roads.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from sdt_kg.annotation import Drive
from services.embodiment.limb import Limb
from services.embodiment.spaces import DriveSpace
from services.embodiment.world import Rules, World

Array = NDArray[np.float64]

NEIGHBOURS = 7  # nodes that a new node is joined to, if it can be
BATCH = 24  # nodes by which a roadmap grows at once
LARGEST = 240  # nodes in all
SHORTCUTS = 30
DETOUR = 2.0  # [m] beyond start and goal that nodes are drawn


@dataclass(slots=True, eq=False)
class Roads:
    """A roadmap of base poses (x, y, yaw).

    Attributes:
        space: Decides what is free.
        nodes: Free base poses.
        edges: (one, other, length) of nodes that a free straight piece joins.
    """

    space: DriveSpace
    rng: np.random.Generator
    nodes: list[Array] = field(default_factory=list[Array])
    edges: list[tuple[int, int, float]] = field(default_factory=list[tuple[int, int, float]])

    def road(self, start: Array, goal: Array, late: Callable[[], bool]) -> Array | None:
        """Corners of a free drive, shape (K, 3), or None when the roadmap is as large as it may be."""
        if self.space.free(start, goal):
            return self.space.edge(start, goal)
        mine = [self._add(start), self._add(goal)]
        ends = np.stack([start, goal])[:, :2]
        box = (ends.min(axis=0) - DETOUR, ends.max(axis=0) + DETOUR)
        while True:
            path = self._path(*mine)
            if path is not None:
                return self._shortened(path)
            if len(self.nodes) > LARGEST or late():
                return None
            self._grow(box)

    def _grow(self, box: tuple[Array, Array]) -> None:
        grown = 0
        for _ in range(20 * BATCH):
            pose = np.append(self.rng.uniform(*box), self.rng.uniform(-np.pi, np.pi))
            if self.space.stands(pose):
                self._add(pose)
                grown += 1
                if grown == BATCH:
                    return

    def _add(self, pose: Array) -> int:
        """Index of a pose, joined to those near it."""
        for known, other in enumerate(self.nodes):
            if np.array_equal(other, pose):
                return known
        index = len(self.nodes)
        if self.nodes:
            apart = self.space.distance(pose, np.array(self.nodes))
            for other in np.argsort(apart, kind="stable")[:NEIGHBOURS]:
                if self.space.free(self.nodes[other], pose):
                    self.edges.append((int(other), index, float(apart[other])))
        self.nodes.append(pose)
        return index

    def _path(self, start: int, goal: int) -> list[Array] | None:
        if not self.edges:
            return None
        one, other, length = (np.array(column) for column in zip(*self.edges, strict=True))
        graph = coo_matrix((length, (one, other)), shape=(len(self.nodes),) * 2)
        far, before = dijkstra(graph, directed=False, indices=start, return_predecessors=True)
        if not np.isfinite(far[goal]):
            return None
        path = [goal]
        while path[-1] != start:
            path.append(int(before[path[-1]]))
        return [self.nodes[k] for k in path[::-1]]

    def _shortened(self, path: list[Array]) -> Array:
        for _ in range(SHORTCUTS):
            if len(path) < 3:
                break
            i, j = sorted(self.rng.choice(len(path), 2, replace=False))
            if j - i > 1 and self.space.free(path[i], path[j]):
                path = path[: i + 1] + path[j:]
        corners = [path[0][None]]
        corners.extend(self.space.edge(one, other)[1:] for one, other in zip(path, path[1:], strict=False))
        return np.concatenate(corners)


def make_roads(world: World, limb: Limb, rules: Rules, drive: Drive, seed: int) -> Roads:
    """An empty roadmap for the robot with that limb parked and its hand open."""
    outside = Rules(rules.environment, rules.pairs[:0], rules.own[:0])
    space = DriveSpace(world, limb, outside, limb.rest, limb.parked.copy(), drive)
    return Roads(space, np.random.default_rng(seed))
