"""Holdings by a population of postures that follows the handle together, where single paths come to an end.

A path that is followed step by step makes its choices as it goes: which way the arm swings decides whether
a limit or a panel stops it much later. Here many postures, of all grasps, go to both ends from the value of
the container at which the fewest are free, of those at which some were found. At each step every posture has
children beside it, as its redundancy allows; those that meet the handle and touch nothing go on. A path that
arrives is straightened. A base that does not move sideways drives straight while the handle moves.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from services.embodiment.body.track import JUMP
from services.embodiment.hold.holding import Holding
from services.embodiment.hold.sampling import Effort, Layer, Sampler, both

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

CHILDREN = 2  # of each, beside the one that moves least
STRIDE = 3  # [1] waypoints from one layer to the next
FAR = 2 * JUMP  # [rad or m] largest change of a variable between two layers
BESIDE = 0.2  # [rad or m] standard deviation of a child from its parent, before it meets the handle
PATHS = 6  # that are straightened
STRIDES = (4, 2, 1, 4, 2, 1)  # layers over which a path is straightened, one after the other
LOOKS = 2  # for contacts, at each
SWEEPS = 3  # before each look


class Spreader:
    """The search for one limb, whose free postures the sampler knows."""

    def __init__(self, sampler: Sampler, effort: Effort) -> None:
        self.searcher, self.limb = sampler.searcher, sampler.limb
        self._sampler, self._effort = sampler, effort
        self._rng, self._late, self._last = sampler.rng, sampler.late, sampler.last

    def holdings(self) -> Iterator[Holding]:
        """Holdings from the first waypoint to the last."""
        started = self._sampler.hardest(self._effort)
        if started is not None:
            yield from self._from(*started)

    def holdings_from(self, pivot: int, xs: Array) -> Iterator[Holding]:
        """The same, from free postures at a waypoint, one of each grasp, shape (N, n)."""
        every = np.arange(len(xs))
        assert all(self._sampler.fits(one) for one in every.tolist()), "a posture that holds it is known"
        yield from self._from(pivot, Layer(xs, every, every))

    def _from(self, pivot: int, start: Layer) -> Iterator[Holding]:
        by_grasp = Layer(start.xs, start.grasps, start.grasps)
        start = start.some(self._in_turn(by_grasp)[: self._effort.most])
        waypoints_on = [
            *range(pivot + STRIDE, self._last, STRIDE),
            *([self._last] if pivot < self._last else []),
        ]
        waypoints_back = [*range(pivot - STRIDE, 0, -STRIDE), *([0] if pivot else [])]
        on = self._spread(start, waypoints_on)
        if on is None:
            return
        traced_on = _traced(on)
        roots = np.unique(traced_on[0])
        back = self._spread(start.some(roots), waypoints_back)
        if back is None:
            return
        traced_back = _traced(back)
        at = np.array([*waypoints_back[::-1], pivot, *waypoints_on])
        _, ends = np.unique(traced_back[0], return_index=True)
        for end in self._rng.permutation(ends)[:PATHS].tolist():
            root = int(roots[traced_back[0][end]])
            other = int(np.flatnonzero(traced_on[0] == root)[0])
            way = [layer.xs[k[end]] for layer, k in zip(back, traced_back, strict=True)][:0:-1]
            way += [layer.xs[k[other]] for layer, k in zip(on, traced_on, strict=True)]
            yield from self._held(np.stack(way), at, int(start.grasps[root]))
            if self._late():
                return

    def _held(self, path: Array, at: Indices, index: int) -> Iterator[Holding]:
        """The path through waypoints `at` as a holding, straightened, if it is free."""
        grasp, rest = self._sampler.fitted(index)
        filled = self._filled(self._straightened(path, at, index), at, index)
        if filled is not None and self.searcher.free(filled, rest):
            yield Holding(self.limb, grasp, filled, rest, "followed among many")

    def _filled(self, path: Array, at: Indices, grasp: int) -> Array | None:
        """The path through all waypoints; None where it leaves the handle or jumps."""
        every = np.arange(self._last + 1)
        xs = np.stack([np.interp(every, at, column) for column in path.T], axis=1)
        layer = Layer(self.searcher.stood(xs), np.full(len(every), grasp), every)
        met = self._sampler.follow(layer, every)
        jumps = np.abs(np.diff(layer.xs, axis=0)).max() >= JUMP
        return layer.xs if met.all() and not jumps else None

    def _spread(self, start: Layer, waypoints: list[int]) -> list[Layer] | None:
        """Layers from the start on; None where no posture goes on, however often it is tried."""
        tries = (self._spread_once(start.some(slice(most)), waypoints, most) for most in self._effort.fronts)
        return next((layers for layers in tries if layers is not None), None)

    def _spread_once(self, start: Layer, waypoints: list[int], most: int) -> list[Layer] | None:
        """The same, tried once."""
        layers = [start]
        for index in waypoints:
            if self._late():
                return None
            layer = self._next(layers[-1], index, most)
            if not len(layer.xs):
                return None
            layers.append(layer)
        return layers

    def _next(self, before: Layer, index: int, most: int) -> Layer:
        """At most so many that touch nothing at a waypoint; one of each parent is looked at first."""
        layer = self._children(before)
        order, found = self._in_turn(layer), before.some(slice(0))
        for k in range(0, len(order), most):
            some = layer.some(order[k : k + most])
            met = self._sampler.follow(some, index)
            met &= np.abs(some.xs - before.xs[some.parents]).max(axis=1) < FAR
            some = some.some(met)
            found = both(found, some.some(self._sampler.clear(some, index)))
            if len(found.xs) >= most:
                break
        return found.some(slice(most))

    def _children(self, layer: Layer) -> Layer:
        """Each posture as it is, and others beside it."""
        parents = np.tile(np.arange(len(layer.xs)), 1 + CHILDREN)
        beside = self._rng.normal(scale=BESIDE, size=(len(parents), layer.xs.shape[1]))
        beside[: len(layer.xs)] = 0.0
        xs = self._sampler.following.beside(layer.xs[parents], beside)
        return Layer(xs, layer.grasps[parents], parents)

    def _in_turn(self, layer: Layer) -> Indices:
        """The postures in random order, one of each parent first."""
        order = self._rng.permutation(len(layer.xs))
        _, first = np.unique(layer.parents[order], return_index=True)
        return np.concatenate([order[self._rng.permutation(first)], np.delete(order, first)])

    def _straightened(self, path: Array, at: Indices, grasp: int) -> Array:
        """The path with each posture nearer to its neighbours' middle, where it stays free of contact."""
        path, inner = path.copy(), np.arange(1, len(path) - 1)
        for stride in np.repeat(STRIDES, LOOKS).tolist():
            low, high = np.maximum(inner - stride, 0), np.minimum(inner + stride, len(path) - 1)
            share = ((at[inner] - at[low]) / (at[high] - at[low]))[:, None]
            nearer, met = path.copy(), np.ones(len(inner), np.bool_)
            for _ in range(SWEEPS):
                nearer[inner] = nearer[low] * (1 - share) + nearer[high] * share
                layer = Layer(nearer[inner], np.full(len(inner), grasp), inner)
                met &= self._sampler.follow(layer, at[inner])
                nearer[inner] = layer.xs
            layer = Layer(nearer[inner], np.full(len(inner), grasp), inner).some(met)
            free = self._sampler.clear(layer, at[layer.parents])
            path[layer.parents[free]] = layer.xs[free]
        return path


def _traced(layers: list[Layer]) -> list[Indices]:
    """Where the postures of the last layer were in each, from the first on."""
    indices = [np.arange(len(layers[-1].xs))]
    for layer in layers[:0:-1]:
        indices.append(layer.parents[indices[-1]])
    return indices[::-1]
