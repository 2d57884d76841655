"""Collision-free paths between two configurations: straight, or by two random trees that meet.

RRT-Connect (Kuffner and LaValle 2000) with shortcuts. A space says what an edge is and whether it
is free; arms and bases differ only there.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

GOAL_SHARE = 0.1  # [1] of samples that are the other tree's root
SHORTCUTS = 40


class Edges(Protocol):
    """What a motion from one configuration to another is, and whether it is free."""

    def edge(self, start: Array, end: Array) -> Array:
        """Corners of the motion from start to end, both included, shape (K, n)."""
        ...

    def free(self, start: Array, end: Array) -> bool:
        """Whether that motion touches nothing."""
        ...


class Space(Edges, Protocol):
    """What a tree grows in."""

    def sample(self, rng: np.random.Generator) -> Array:
        """A random configuration within limits."""
        ...

    def distance(self, one: Array, others: Array) -> Array:
        """Distances from one configuration to others (N, n), shape (N,)."""
        ...

    def towards(self, start: Array, end: Array) -> Array:
        """The end, or as far towards it as one extension goes."""
        ...


@dataclass(slots=True)
class _Tree:
    nodes: list[Array]
    parents: list[int] = field(default_factory=lambda: [-1])

    def nearest(self, space: Space, x: Array) -> int:
        return int(np.argmin(space.distance(x, np.array(self.nodes))))

    def add(self, x: Array, parent: int) -> int:
        self.nodes.append(x)
        self.parents.append(parent)
        return len(self.nodes) - 1

    def to_root(self, index: int) -> list[Array]:
        path = []
        while index >= 0:
            path.append(self.nodes[index])
            index = self.parents[index]
        return path


def connect(
    space: Space,
    ends: tuple[Array, Array],
    rng: np.random.Generator,
    iterations: int,
    late: Callable[[], bool] = lambda: False,
) -> Array | None:
    """Corners of a free path between the ends, shape (K, n), or None when the search gave up."""
    start, goal = ends
    if space.free(start, goal):
        return space.edge(start, goal)
    trees = (_Tree([start]), _Tree([goal]))
    for i in range(iterations):
        if late():
            return None
        grow, other = trees[i % 2], trees[1 - i % 2]
        target = other.nodes[0] if rng.random() < GOAL_SHARE else space.sample(rng)
        new = _extend(space, grow, target)
        if new is None:
            continue
        met = _reach(space, other, grow.nodes[new])
        if met is None:
            continue
        forth, back = grow.to_root(new)[::-1], other.to_root(met)[1:]
        nodes = forth + back if i % 2 == 0 else (forth + back)[::-1]
        return shortened(space, nodes, rng, SHORTCUTS)
    return None


def _extend(space: Space, tree: _Tree, target: Array) -> int | None:
    nearest = tree.nearest(space, target)
    step = space.towards(tree.nodes[nearest], target)
    return tree.add(step, nearest) if space.free(tree.nodes[nearest], step) else None


def _reach(space: Space, tree: _Tree, target: Array) -> int | None:
    """Node at the target if repeated extensions come there."""
    nearest = tree.nearest(space, target)
    while True:
        step = space.towards(tree.nodes[nearest], target)
        if not space.free(tree.nodes[nearest], step):
            return None
        nearest = tree.add(step, nearest)
        if np.array_equal(step, target):
            return nearest


def shortened(space: Edges, nodes: list[Array], rng: np.random.Generator, tries: int) -> Array:
    """Corners of a motion through some of the nodes, shape (K, n): two of them are joined where that is free.

    Args:
        space: Tells where it is.
        nodes: Of a free motion.
        rng: Draws which two.
        tries: How often.
    """
    shut: set[tuple[int, int]] = set()  # of few nodes the same two are often drawn
    for _ in range(tries):
        if len(nodes) < 3:
            break
        i, j = sorted(rng.choice(len(nodes), 2, replace=False).tolist())
        if j - i < 2 or (i, j) in shut:
            continue
        if space.free(nodes[i], nodes[j]):
            nodes, shut = nodes[: i + 1] + nodes[j:], set()
        else:
            shut.add((i, j))
    corners = [nodes[0][None]]
    corners.extend(space.edge(one, other)[1:] for one, other in pairwise(nodes))
    return np.concatenate(corners)


def between(start: Array, end: Array, pieces: int) -> Array:
    """Configurations after start up to and including end, evenly spaced, shape (pieces, n)."""
    share = np.arange(1, pieces + 1)[:, None] / pieces
    return start + share * (end - start)
