"""Grasps that can be had at every value of the container, bred where no listed grasp can.

Listed grasps are some 20° apart, and close straight across the bar. Where an arm is at the end of its reach
at one value and at a limit at another, the few grasps that both have lie between the listed ones. Here random
grasps, turned and placed anyhow, are changed little by little. What a grasp costs is how far the tool stays
from it at some values, or that something is touched there; each keeps its best posture at each value, from
which its children's are looked for.
"""

import itertools
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from services.embodiment.body import ik
from services.embodiment.body.track import EXACT
from services.embodiment.hold.fit import OPENINGS, Fitted, Fitter, Opened
from services.embodiment.hold.holding import SEEDS, STEPS, Searcher
from services.embodiment.hold.pool import Pool, straight
from services.embodiment.hold.sets import free_grasps

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

LOOKED_AT = 5  # values of the container
BLOCK = 96  # grasps that are drawn together
FIRST = 4  # seeds of each for each value
GENERATIONS = 120
ENOUGH = (8, 24)  # that can be had at all values: tried when there are so many, and then
STALLED = 20  # generations that bring neither a cheaper one than the cheapest nor one more that costs nothing
CHEAPER = 0.95  # [1] of what the cheapest costs counts as cheaper
WORTH = 0.06  # [m] where none is cheaper, another is not bred
BOUND = 0.3  # [m] more than this counts no more, at one value
TOUCHES = 0.05  # [m] what a contact counts as, or that it is not known whether there is one
NEAR = 0.02  # [m] a tool that is nearer to its place is looked at for contacts
CROWD = 480  # seeds that are looked at together for grasps that are in place everywhere but touch something
CROWDS = 32  # of them at one value, at most
FEW = 6  # such grasps of which a free posture is then found
CHANGE = np.array([0.25, 0.25, 0.1, 0.3, 0.006])  # [rad, rad, rad, 1, m] standard deviations of a child
SCALES = (0.03, 0.1, 0.3, 1.0)  # [1] of these, drawn anew for each generation


class Breeder:
    """The search for grasps of one limb.

    Args:
        searcher: What is held, by what, and at which distances.
        fitter: Tells whether the kitchen leaves room for a hand.
        pool: What grasps are drawn from; None for grasps of the fitter's bar.
    """

    def __init__(
        self,
        searcher: Searcher,
        fitter: Fitter,
        rng: np.random.Generator,
        late: Callable[[], bool],
        pool: Pool | None = None,
    ) -> None:
        self.searcher, self.fitter, self._rng, self._late = searcher, fitter, rng, late
        self._pool = pool or straight(fitter.bar)
        self._at = np.linspace(0, len(searcher.problem.values) - 1, LOOKED_AT).astype(int).tolist()
        self._numbers = itertools.count(self._pool.first)

    def litters(self) -> Iterator[list[Opened]]:
        """Grasps with a free posture known at each value that was looked at, one litter after the other.

        A litter may have none; where the cheapest is far from free there is no other.
        """
        for _ in range(self._pool.litters):
            cheapest = np.inf
            for least in self._litter():
                cheapest = least and self._freed()
                yield [one for one, cost in zip(self.looked_at, self._total(), strict=True) if cost == 0.0]
            if cheapest > WORTH or self._late():
                return

    def postures(self) -> Iterator[tuple[int, Array]]:
        """Waypoints, and a free posture of each of these grasps there, shape (N, n)."""
        free = np.array(self._total()) == 0.0
        if free.any():
            yield from ((index, self._xs[free, k]) for k, index in enumerate(self._at))

    def _total(self) -> list[float]:
        return self._costs.sum(axis=1).tolist()

    def _litter(self) -> Iterator[float]:
        """What the cheapest of a new litter costs [m], each time that enough are free and at its end."""
        self._fitted, self._shares = [], []
        self._flips, self._held = np.empty(0, np.int64), np.empty(0, np.int64)
        self._genes, self._costs = np.empty((0, len(self._pool.most))), np.empty((0, LOOKED_AT))
        self._draw()
        if not self._fitted:
            yield np.inf
            return
        count = len(self._fitted)
        seeds = np.stack([self._seeds(index, count) for index in self._at], axis=1)
        self._xs, self._costs = self._judged(self._fitted, seeds, FIRST, np.full(count, np.inf))
        cheapest, free, stalled, enough = np.inf, 0, 0, [min(each, count) for each in ENOUGH]
        for number in range(GENERATIONS):
            total = self._total()
            least, found = min(total), total.count(0.0)
            stalled += 1
            if least < CHEAPER * cheapest or found > free:
                cheapest, free, stalled = least, found, 0
            if free >= enough[-1] or stalled > STALLED or self._late():
                break
            if free >= enough[0]:
                enough = enough[1:]
                yield least
            self._breed(number % 2 == 0)
        yield min(self._total())

    def _freed(self) -> float:
        """What the cheapest costs once those that are in place everywhere were tried from many seeds [m].

        That something is touched says nothing of how nearly it is not: at the end of a door that tips over
        one of thousands of postures may be free.
        """
        left = np.flatnonzero(np.isin(self._costs, (0.0, TOUCHES)).all(axis=1))
        for k in np.argsort(-self._costs.sum(axis=0), kind="stable").tolist():
            for _ in range(CROWDS):
                touched = left[self._costs[left, k] > 0.0]
                if not len(touched) or len(left) - len(touched) >= FEW or self._late():
                    break
                self._crowd(np.resize(self._rng.permutation(touched), CROWD), k)
            left = left[self._costs[left, k] == 0.0]
        return min(self._total(), default=np.inf)

    def _crowd(self, grasps: Indices, k: int) -> None:
        """One seed for each of these grasps at value k; free postures that are found are kept."""
        tried = self._seeds(self._at[k], len(grasps))
        cost = self._missed([self._fitted[one] for one in grasps.tolist()], tried, self._at[k])
        free = cost == 0.0
        self._xs[grasps[free], k], self._costs[grasps[free], k] = tried[free], 0.0

    @property
    def looked_at(self) -> list[Opened]:
        """The grasps of the last generation."""
        return [(grasp, share) for (grasp, _), share in zip(self._fitted, self._shares, strict=True)]

    def _draw(self) -> None:
        """Random grasps that fit."""
        for block in range(self._pool.blocks):
            left = self._pool.grasps - len(self._fitted)
            if not left or self._late() or (block >= self._pool.empty and not self._fitted):
                return
            genes, flips, held = (
                self._drawn() if block < self._pool.fresh or not self._fitted else self._like()
            )
            found = self._fit(genes, flips, held)
            engaged = (k for k, one in enumerate(found) if one is not None and self.fitter.engaged(one[0][0]))
            fit = list(itertools.islice(engaged, left))
            self._fitted += [one[0] for k in fit if (one := found[k])]
            self._shares += [one[1] for k in fit if (one := found[k])]
            self._genes = np.concatenate((self._genes, genes[fit]))
            self._flips = np.concatenate((self._flips, flips[fit]))
            self._held = np.concatenate((self._held, held[fit]))

    def _drawn(self) -> tuple[Array, NDArray[np.int64], Indices]:
        """Numbers of random grasps, which way each is turned, and the part that it holds."""
        genes = self._rng.uniform(-self._pool.most, self._pool.most, (BLOCK, len(self._pool.most)))
        flips = self._rng.choice((1, -1), BLOCK)
        return genes, flips, self._rng.integers(len(self._pool.bars), size=BLOCK)

    def _like(self) -> tuple[Array, NDArray[np.int64], Indices]:
        """The same of grasps that are like those that were found to fit."""
        some = self._rng.integers(len(self._fitted), size=BLOCK)
        return self._changed(some), self._flips[some], self._held[some]

    def _changed(self, grasps: Indices) -> Array:
        """The numbers of these grasps, changed a little."""
        change = self._rng.normal(size=(len(grasps), len(CHANGE))) * CHANGE * self._rng.choice(SCALES)
        return np.clip(self._genes[grasps] + change, -self._pool.most, self._pool.most)

    def _fit(
        self, genes: Array, flips: NDArray[np.int64], held: Indices
    ) -> list[tuple[Fitted, float] | None]:
        """The grasps (N, 5) of these parts that the hand alone can take, no narrower than needed.

        Whether fingers reach over the bar is asked of those that are kept: it takes as long as closing them.
        """
        numbers = np.array(list(itertools.islice(self._numbers, len(genes))), np.int64)
        grasps = free_grasps([self._pool.bars[k] for k in held.tolist()], genes, flips, numbers)
        found: dict[int, tuple[Fitted, float]] = {}
        for share in OPENINGS:
            left = [k for k, number in enumerate(numbers.tolist()) if number not in found]
            if not left or self._late():
                break
            for grasp in self.fitter.screened(grasps.some(left), share):
                fitted = self.fitter.fitted((grasp, share))
                if fitted is not None:
                    found[grasp.index] = fitted, share
        return [found.get(number) for number in numbers.tolist()]

    def _seeds(self, index: int, count: int) -> Array:
        """So many seeds at a waypoint."""
        batches = [np.empty((0, len(self.searcher.weight)))]
        batches += [self.searcher.seeds(index, self._rng) for _ in range(-(-count // SEEDS))]
        return np.concatenate(batches)[:count]

    def _judged(self, grasps: list[Fitted], xs: Array, more: int, most: Array) -> tuple[Array, Array]:
        """Postures (N, V, n) at each value, and what each costs (N, V) [m].

        Args:
            grasps: The scene of each is looked at where the tool is in place.
            xs: From where they are looked for.
            more: So many more seeds for each.
            most: What each may cost in all; the value that is dearest so far is looked at first, and one
                that costs as much is not looked at any further, so that it costs no end.
        """
        best, costs, spent = xs.copy(), np.full(xs.shape[:2], np.inf), np.zeros(len(xs))
        for k in np.argsort(-self._costs.sum(axis=0), kind="stable").tolist():
            for n in range(1 + more):
                left = np.flatnonzero((costs[:, k] > 0) & (spent < most))
                tried = best[left, k] if n == 0 else self._seeds(self._at[k], len(left))
                cost = self._missed([grasps[one] for one in left.tolist()], tried, self._at[k])
                better = cost < costs[left, k]
                best[left[better], k], costs[left[better], k] = tried[better], cost[better]
            spent += costs[:, k]
        return best, costs

    def _missed(self, grasps: list[Fitted], xs: Array, index: int) -> Array:
        """What the postures (N, n) that these lead to at a waypoint cost [m]; they are in xs."""
        one, problem = self.searcher, self.searcher.problem
        if not grasps:
            return np.empty(0)
        turn, place = problem.handle_r[index], problem.handle_p[index]
        tool_r = turn @ np.stack([grasp.rotation for grasp, _ in grasps])
        tool_p = np.stack([grasp.translation for grasp, _ in grasps]) @ turn.T + place
        target, chain = (tool_r, tool_p), one.limb.chain
        met = ik.solve_many(xs, *target, chain, one.weight, one.lower, one.upper, STEPS, EXACT)
        missed = np.where(met, 0.0, np.minimum(ik.misses(xs, *target, chain), BOUND))
        cost, near = missed + TOUCHES, np.flatnonzero(missed < NEAR)
        if len(near):
            q = one.limb.q(xs[near], np.stack([grasps[k][1] for k in near]))
            q = problem.mechanics.put_each(q, np.repeat(problem.values[index], len(near)))
            free = [pair is None for pair in one.world.contact_each(q, one.rules)]
            cost[near[free]] = missed[near[free]]
        one.tally.seeds += len(xs)
        one.tally.solved += int(met.sum())
        return cost

    def _breed(self, among_best: bool) -> None:
        """Children that are cheaper replace their parents, or the dearest if only the best have any."""
        total = self._costs.sum(axis=1)
        order = np.argsort(total, kind="stable")
        half = len(order) // 2
        parents = np.concatenate((order[:half], order[:half])) if among_best and half else order
        genes = self._changed(parents)
        found = self._fit(genes, self._flips[parents], self._held[parents])
        fit = np.array([k for k, one in enumerate(found) if one is not None], np.intp)
        if not len(fit):
            return
        children = [one for one in found if one is not None]
        about = [fitted for fitted, _ in children], self._xs[parents[fit]]
        xs, costs = self._judged(*about, 1, total[parents[fit]])
        dearest = order[::-1].tolist() if among_best else []
        for k, cost in enumerate(costs.sum(axis=1).tolist()):
            parent = parents[fit[k]]
            other = dearest.pop(0) if dearest else parent
            if cost < min(total[parent], total[other]) and self.fitter.engaged(children[k][0][0]):
                self._genes[other], self._flips[other] = genes[fit[k]], self._flips[parent]
                self._held[other] = self._held[parent]
                self._fitted[other], self._shares[other] = children[k]
                self._xs[other], self._costs[other] = xs[k], costs[k]
                total[other] = cost
