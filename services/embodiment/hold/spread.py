"""Holdings by a population of postures that follows the handle together, where single paths come to an end.

A path that is followed step by step makes its choices as it goes: which way the arm swings decides whether
a limit or a panel stops it much later. Here many postures, of all grasps, go from the value of the container
at which the fewest are free to both ends. At each step every posture has children beside it, as its
redundancy allows; those that meet the handle and touch nothing go on. A path that arrives is straightened.
A base that does not move sideways stands while the handle moves.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Drive
from services.embodiment.body import ik
from services.embodiment.body.limb import BASE
from services.embodiment.body.track import EXACT, JUMP
from services.embodiment.hold.grasp import Grasp
from services.embodiment.hold.holding import STEPS, Holding, Searcher

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

LOOKED_AT = 5  # values of the container at which free postures are counted first
BATCHES = 16  # of seeds at each of them
MORE = 3  # [1] times as many, where all values have free postures
MOST = 192  # postures that go on
TOGETHER = 64  # that are looked at together, until there are as many
CHILDREN = 2  # of each, beside the one that moves least
BESIDE = 0.12  # [rad or m] standard deviation of a child from its parent, before it meets the handle
PATHS = 6  # that are straightened
STRIDES = (8, 4, 2, 1, 8, 4, 2, 1)  # waypoints over which a path is straightened, one after the other
SWEEPS = 6  # over each


@dataclass(frozen=True, slots=True, eq=False)
class Layer:
    """Postures at one waypoint.

    Attributes:
        xs: Shape (N, n).
        grasps: Which grasp each holds, shape (N,).
        parents: Which posture of the layer before each comes from, shape (N,).
    """

    xs: Array
    grasps: Indices
    parents: Indices

    def some(self, chosen: NDArray[np.bool_] | Indices) -> "Layer":
        """Those of them."""
        return Layer(self.xs[chosen], self.grasps[chosen], self.parents[chosen])


class Spreader:
    """The search for one limb.

    Args:
        searcher: What is held, by what, and at which distances.
        grasps: Each with its closed scene rest.
    """

    def __init__(
        self,
        searcher: Searcher,
        grasps: list[tuple[Grasp, Array]],
        rng: np.random.Generator,
        late: Callable[[], bool],
    ) -> None:
        self.searcher, self.limb, self._rng, self._late = searcher, searcher.limb, rng, late
        self.grasps = grasps
        problem = searcher.problem
        tools = [grasp.tool(problem.handle_r, problem.handle_p) for grasp, _ in grasps]
        self._tool_r, self._tool_p = (np.stack([one[k] for one in tools]) for k in (0, 1))
        self._rests = np.stack([rest for _, rest in grasps])
        self._last = len(problem.values) - 1
        self._weight = searcher.weight.copy()
        if searcher.drive is not Drive.OMNI:
            self._weight[BASE] = 0.0

    def holdings(self) -> Iterator[Holding]:
        """Holdings from the first waypoint to the last."""
        started = self._hardest()
        if started is None:
            return
        pivot, start = started
        start = start.some(self._in_turn(start)[:MOST])
        on = self._spread(start, range(pivot + 1, self._last + 1))
        if on is None:
            return
        traced_on = _traced(on)
        roots = np.unique(traced_on[0])
        back = self._spread(start.some(roots), range(pivot - 1, -1, -1))
        if back is None:
            return
        traced_back = _traced(back)
        _, ends = np.unique(traced_back[0], return_index=True)
        for end in self._rng.permutation(ends)[:PATHS].tolist():
            root = int(roots[traced_back[0][end]])
            other = int(np.flatnonzero(traced_on[0] == root)[0])
            way = [layer.xs[k[end]] for layer, k in zip(back, traced_back, strict=True)][:0:-1]
            way += [layer.xs[k[other]] for layer, k in zip(on, traced_on, strict=True)]
            yield from self._held(np.stack(way), int(start.grasps[root]))
            if self._late():
                return

    def _held(self, path: Array, index: int) -> Iterator[Holding]:
        """The path as a holding, straightened, if it is free."""
        (grasp, _), rest = self.grasps[index], self._rests[index]
        path = self._straightened(path, index)
        if self.searcher.free(path, rest):
            yield Holding(self.limb, grasp, path, rest, "followed among many")

    def _hardest(self) -> tuple[int, Layer] | None:
        """The waypoint with the fewest free postures, and these, of grasps that all waypoints looked at have.

        None where there are none.
        """
        every = np.arange(len(self.grasps))
        looked_at = np.linspace(0, self._last, LOOKED_AT).astype(int).tolist()[::-1]
        found: dict[int, Layer] = {}
        for index in looked_at:
            found[index] = self._free_seeds(index, every, 1)
            if not len(found[index].xs) or self._late():
                return None
        hardest = min(found, key=lambda index: len(found[index].xs))
        start = _both(found[hardest], self._free_seeds(hardest, every, MORE))
        common = np.unique(start.grasps)
        for index in sorted(looked_at, key=lambda index: len(found[index].xs))[1:]:
            common = np.intersect1d(common, self._free_seeds(index, common, MORE).grasps)
            if not len(common) or self._late():
                return None
        start = _both(start.some(np.isin(start.grasps, common)), self._free_seeds(hardest, common, MORE))
        return hardest, Layer(start.xs, start.grasps, np.arange(len(start.xs)))

    def _free_seeds(self, index: int, grasps: Indices, times: int) -> Layer:
        """Free postures at a waypoint that some batches of seeds for these grasps lead to."""
        xs = np.concatenate([self.searcher.seeds(index, self._rng) for _ in range(BATCHES * times)])
        layer = Layer(xs, self._rng.choice(grasps, len(xs)), np.arange(len(xs)))
        met = self._meet(layer, index, self.searcher.weight)
        self.searcher.tally.seeds += len(xs)
        self.searcher.tally.solved += int(met.sum())
        layer = layer.some(met)
        return layer.some(self._clear(layer, index)) if len(layer.xs) else layer

    def _meet(self, layer: Layer, index: int | Indices, weight: Array | None = None) -> NDArray[np.bool_]:
        """Which postures were moved to where the tool is in their grasp; without a weight as they follow."""
        one = self.searcher
        target = self._tool_r[layer.grasps, index], self._tool_p[layer.grasps, index]
        limits = one.lower, one.upper
        weight = self._weight if weight is None else weight
        return ik.solve_many(layer.xs, *target, self.limb.chain, weight, *limits, STEPS, EXACT)

    def _clear(self, layer: Layer, index: int | Indices) -> NDArray[np.bool_]:
        """Which postures touch nothing."""
        one = self.searcher
        q = self.limb.q(layer.xs, self._rests[layer.grasps])
        values = np.broadcast_to(one.problem.values[index], len(q))
        q = one.problem.mechanics.put_each(q, values)
        return np.array([pair is None for pair in one.world.contact_each(q, one.rules)], dtype=np.bool_)

    def _spread(self, start: Layer, waypoints: range) -> list[Layer] | None:
        """Layers from the start on; None where no posture goes on."""
        layers = [start]
        for index in waypoints:
            if self._late():
                return None
            before = layers[-1]
            layer = self._children(before)
            met = self._meet(layer, index)
            met &= np.abs(layer.xs - before.xs[layer.parents]).max(axis=1) < JUMP
            layer = self._free(layer.some(met), index)
            if not len(layer.xs):
                return None
            layers.append(layer)
        return layers

    def _free(self, layer: Layer, index: int) -> Layer:
        """At most MOST that touch nothing, of which one of each parent is looked at first."""
        order, found = self._in_turn(layer), [np.empty(0, np.intp)]
        for k in range(0, len(order), TOGETHER):
            some = order[k : k + TOGETHER]
            found.append(some[self._clear(layer.some(some), index)])
            if sum(map(len, found)) >= MOST:
                break
        return layer.some(np.concatenate(found)[:MOST])

    def _children(self, layer: Layer) -> Layer:
        """Each posture as it is, and others beside it."""
        parents = np.tile(np.arange(len(layer.xs)), 1 + CHILDREN)
        beside = self._rng.normal(scale=BESIDE, size=(len(parents), layer.xs.shape[1]))
        beside[: len(layer.xs)] = 0.0
        beside[:, self._weight == 0.0] = 0.0
        xs = np.clip(layer.xs[parents] + beside, self.searcher.lower, self.searcher.upper)
        return Layer(xs, layer.grasps[parents], parents)

    def _in_turn(self, layer: Layer) -> Indices:
        """The postures in random order, one of each parent first."""
        order = self._rng.permutation(len(layer.xs))
        _, first = np.unique(layer.parents[order], return_index=True)
        return np.concatenate([order[self._rng.permutation(first)], np.delete(order, first)])

    def _straightened(self, path: Array, grasp: int) -> Array:
        """The path with each posture nearer to its neighbours' middle, where it stays free of contact."""
        given, path = path, path.copy()
        inner = np.arange(1, len(path) - 1)
        for stride in STRIDES:
            low, high = np.maximum(inner - stride, 0), np.minimum(inner + stride, self._last)
            share = ((inner - low) / (high - low))[:, None]
            for _ in range(SWEEPS):
                nearer = path[low] * (1 - share) + path[high] * share
                layer = Layer(nearer, np.full(len(inner), grasp), inner)
                layer = layer.some(self._meet(layer, inner))
                if not len(layer.xs):
                    return path
                free = self._clear(layer, layer.parents)
                path[layer.parents[free]] = layer.xs[free]
        return path if np.abs(np.diff(path, axis=0)).max() < JUMP else given


def _both(one: Layer, other: Layer) -> Layer:
    """The postures of two layers of one waypoint."""
    return Layer(
        np.concatenate([one.xs, other.xs]),
        np.concatenate([one.grasps, other.grasps]),
        np.concatenate([one.parents, other.parents]),
    )


def _traced(layers: list[Layer]) -> list[Indices]:
    """Where the postures of the last layer were in each, from the first on."""
    indices = [np.arange(len(layers[-1].xs))]
    for layer in layers[:0:-1]:
        indices.append(layer.parents[indices[-1]])
    return indices[::-1]
