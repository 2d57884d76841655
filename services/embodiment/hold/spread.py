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
from services.embodiment.hold.holding import SEEDS, STEPS, Holding, Searcher

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

LOOKED_AT = 5  # values of the container at which free postures are counted first
ENOUGH = 24  # free postures at a value that tell how many of its seeds lead to one
BATCHES = 4  # of seeds that are looked at together
MOST_BATCHES = 144  # at one value, until one is free
FEW_BATCHES = 96  # at one value, where some are
HOPELESS = 24  # batches that lead to no posture at all, of one value
TRIES = 4  # looks for a free posture of a grasp at another value
EACH = 4  # seeds for each grasp at such a look
MOST = 128  # postures that go on
TOGETHER = 64  # that are looked at together, until there are as many
CHILDREN = 2  # of each, beside the one that moves least
STRIDE = 3  # [1] waypoints from one layer to the next
FAR = 2 * JUMP  # [rad or m] largest change of a variable between two layers
BESIDE = 0.2  # [rad or m] standard deviation of a child from its parent, before it meets the handle
PATHS = 6  # that are straightened
STRIDES = (4, 2, 1, 4, 2, 1)  # layers over which a path is straightened, one after the other
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
        (grasp, _), rest = self.grasps[index], self._rests[index]
        filled = self._filled(self._straightened(path, at, index), at, index)
        if filled is not None and self.searcher.free(filled, rest):
            yield Holding(self.limb, grasp, filled, rest, "followed among many")

    def _filled(self, path: Array, at: Indices, grasp: int) -> Array | None:
        """The path through all waypoints; None where it leaves the handle or jumps."""
        every = np.arange(self._last + 1)
        xs = np.stack([np.interp(every, at, column) for column in path.T], axis=1)
        layer = Layer(xs, np.full(len(every), grasp), every)
        met = self._meet(layer, every)
        jumps = np.abs(np.diff(layer.xs, axis=0)).max() >= JUMP
        return layer.xs if met.all() and not jumps else None

    def _hardest(self) -> tuple[int, Layer] | None:
        """The waypoint with the fewest free postures, and these, of grasps that all waypoints looked at have.

        None where there are none.
        """
        every = np.arange(len(self.grasps))
        looked_at = np.linspace(0, self._last, LOOKED_AT).astype(int).tolist()[::-1]
        found: dict[int, Layer] = {}
        share: dict[int, float] = {}
        for index in looked_at:
            found[index], share[index] = self._sampled(index, every, ENOUGH)
            if not len(found[index].xs) or self._late():
                return None
        looked_at.sort(key=lambda index: share[index])
        hardest = looked_at[0]
        start = _both(found[hardest], self._sampled(hardest, np.unique(found[hardest].grasps), MOST)[0])
        common = np.unique(start.grasps)
        for index in looked_at[1:]:
            common = self._shared(index, common)
            if not len(common) or self._late():
                return None
        start = start.some(np.isin(start.grasps, common))
        if len(start.xs) < MOST:
            start = _both(start, self._sampled(hardest, common, MOST)[0])
        return hardest, Layer(start.xs, start.grasps, np.arange(len(start.xs)))

    def _shared(self, index: int, grasps: Indices) -> Indices:
        """Those of the grasps for which a free posture is found at another waypoint."""
        known = np.empty(0, np.intp)
        for _ in range(TRIES):
            open_ones = np.setdiff1d(grasps, known)
            if not len(open_ones):
                break
            known = np.union1d(known, self._free_seeds(index, np.repeat(open_ones, EACH)).grasps)
        return known

    def _sampled(self, index: int, grasps: Indices, enough: int) -> tuple[Layer, float]:
        """Free postures at a waypoint, as many as are enough if they are found, and their share of the seeds.

        Half of the seeds are for grasps that a posture was found for.
        """
        layer, seeds, solved = self._free_seeds(index, grasps[:0]), 0, self.searcher.tally.solved
        for batch in range(0, MOST_BATCHES, BATCHES):
            more = self._rng.choice(grasps, BATCHES * SEEDS)
            if len(layer.xs):
                more[::2] = self._rng.choice(layer.grasps, len(more[::2]))
            layer = _both(layer, self._free_seeds(index, more))
            seeds += len(more)
            hopeless = batch >= HOPELESS and self.searcher.tally.solved == solved
            few = batch >= FEW_BATCHES and len(layer.xs)
            if len(layer.xs) >= enough or few or hopeless or self._late():
                break
        return layer, len(layer.xs) / seeds

    def _free_seeds(self, index: int, grasps: Indices) -> Layer:
        """Free postures at a waypoint that one seed for each of these grasps leads to."""
        batches = -(-len(grasps) // SEEDS)
        none = np.empty((0, len(self._weight)))
        xs = np.concatenate([none, *(self.searcher.seeds(index, self._rng) for _ in range(batches))])[
            : len(grasps)
        ]
        layer = Layer(xs, grasps, np.arange(len(xs)))
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

    def _spread(self, start: Layer, waypoints: list[int]) -> list[Layer] | None:
        """Layers from the start on; None where no posture goes on."""
        layers = [start]
        for index in waypoints:
            if self._late():
                return None
            before = layers[-1]
            layer = self._children(before)
            met = self._meet(layer, index)
            met &= np.abs(layer.xs - before.xs[layer.parents]).max(axis=1) < FAR
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

    def _straightened(self, path: Array, at: Indices, grasp: int) -> Array:
        """The path with each posture nearer to its neighbours' middle, where it stays free of contact."""
        path, inner = path.copy(), np.arange(1, len(path) - 1)
        for stride in STRIDES:
            low, high = np.maximum(inner - stride, 0), np.minimum(inner + stride, len(path) - 1)
            share = ((at[inner] - at[low]) / (at[high] - at[low]))[:, None]
            for _ in range(SWEEPS):
                nearer = path[low] * (1 - share) + path[high] * share
                layer = Layer(nearer, np.full(len(inner), grasp), inner)
                layer = layer.some(self._meet(layer, at[inner]))
                if not len(layer.xs):
                    return path
                free = self._clear(layer, at[layer.parents])
                path[layer.parents[free]] = layer.xs[free]
        return path


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
