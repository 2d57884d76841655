"""Free postures of many grasps at some values of the container, from many seeds of inverse kinematics.

A hand is closed in a grasp only once a posture is found there that touches nothing but for its fingers: of a
thousand grasps that an open hand has room for, some hundred are needed.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.embodiment.body import ik
from services.embodiment.body.demands import without_fingers
from services.embodiment.body.track import EXACT
from services.embodiment.body.world import Rules
from services.embodiment.hold.fit import Fitted, Fitter, Opened
from services.embodiment.hold.following import Following
from services.embodiment.hold.holding import SEEDS, STEPS, Searcher

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

LOOKED_AT = 5  # values of the container at which free postures are counted first
ENOUGH = 24  # free postures at a value that tell how many of its seeds lead to one
HOPELESS = 24  # batches that lead to no posture at all, of one value
TRIES = 4  # looks for a free posture of a grasp at another value
EACH = 4  # seeds for each grasp at such a look


@dataclass(frozen=True, slots=True)
class Effort:
    """How much is looked at.

    Attributes:
        first: Batches of seeds at each value.
        batches: The same at the value where the fewest lead to a free posture, until one does.
        few: The same where some do.
        enough: Free postures at that value, with which its narrowness is known.
        together: Batches that are looked at together.
        common: Whether only grasps go on that a posture is found of at other values too.
        fronts: How many postures go on at once, one try after the other, until some arrive.
    """

    first: int
    batches: int
    few: int
    enough: int
    together: int
    common: bool
    fronts: tuple[int, ...]

    @property
    def most(self) -> int:
        """Postures that are looked for where they start."""
        return self.fronts[0]


QUICK = Effort(first=2, batches=8, few=8, enough=2, together=2, common=False, fronts=(16, 96))
FULL = Effort(first=36, batches=36, few=24, enough=24, together=4, common=True, fronts=(128, 128, 128))


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

    def some(self, chosen: NDArray[np.bool_] | Indices | slice) -> "Layer":
        """Those of them."""
        return Layer(self.xs[chosen], self.grasps[chosen], self.parents[chosen])


class Sampler:
    """Free postures of one limb at single waypoints.

    Args:
        searcher: What is held, by what, and at which distances.
        fitter: Closes the hand in a grasp, which is done only where a posture is free but for its fingers.
        opened: Grasps that may fit.
        rng: Draws seeds and turns.
        late: Whether time is up.

    Attributes:
        following: How the limb may move while the handle does.
        last: The last waypoint.
    """

    def __init__(
        self,
        searcher: Searcher,
        fitter: Fitter,
        opened: list[Opened],
        rng: np.random.Generator,
        late: Callable[[], bool],
    ) -> None:
        self.searcher, self.limb, self.rng, self.late = searcher, searcher.limb, rng, late
        self._fitter, self.opened = fitter, opened
        self._fitted: dict[int, Fitted | None] = {}
        self._rotation = np.stack([grasp.rotation for grasp, _ in opened])
        self._translation = np.stack([grasp.translation for grasp, _ in opened])
        self._may_fit = np.ones(len(opened), np.bool_)
        self._rests = np.repeat(self.limb.rest[None], len(opened), axis=0)
        self._bare = without_fingers(searcher.world, self.limb, searcher.rules)
        self.last = len(searcher.problem.values) - 1
        self.following = Following(searcher)

    def fitted(self, grasp: int) -> Fitted:
        """A grasp of which a posture was found, closed."""
        fitted = self._fitted[grasp]
        assert fitted is not None, "a posture that holds it was found"
        return fitted

    def hardest(self, effort: Effort) -> tuple[int, Layer] | None:
        """The waypoint with the fewest free postures, and these, of grasps that others have too if some do.

        Waypoints where none is found count for nothing: postures of others may come there. None where no
        posture is found at all, or no seed leads to the handle at some waypoint.
        """
        found = self._found(effort)
        if not found:
            return None
        hardest, *others = found
        some, rest = found[hardest], (effort, effort.batches)
        among = np.unique(some.grasps) if len(found) == LOOKED_AT else np.arange(len(self.opened))
        start = both(some, self._sampled(hardest, among, effort.most, *rest)[0])
        common = np.unique(start.grasps)
        for index in others if effort.common else ():
            shared = self._shared(index, common)
            if self.late():
                return None
            if not len(shared):  # too few seeds for values so narrow: postures tell that are led there
                break
            common = shared
        start = start.some(np.isin(start.grasps, common))
        if len(start.xs) < effort.most:
            start = both(start, self._sampled(hardest, common, effort.most, *rest)[0])
        return hardest, Layer(start.xs, start.grasps, np.arange(len(start.xs)))

    def _found(self, effort: Effort) -> dict[int, Layer]:
        """Free postures at waypoints where some are found, by the share of seeds that lead to them.

        None at all where no seed leads to the handle at some waypoint. Where little is looked at, the last is
        looked at first: mostly it is the narrow one, and the only one if some are found there.
        """
        every, solved = np.arange(len(self.opened)), dict[int, int]()
        found, share = dict[int, Layer](), dict[int, float]()

        def look(index: int, enough: int, batches: int) -> None:
            before = self.searcher.tally.solved
            layer, share[index] = self._sampled(index, every, enough, effort, batches)
            found[index] = both(found[index], layer) if index in found else layer
            solved[index] = solved.get(index, 0) + self.searcher.tally.solved - before

        if quick := effort.first < effort.batches:
            look(self.last, effort.enough, effort.batches)
            if len(found[self.last].xs) >= effort.enough:
                return found
        for index in np.linspace(0, self.last, LOOKED_AT).astype(int).tolist()[::-1]:
            if index not in found:
                look(index, ENOUGH, effort.first)
            if self.late() or not (solved[index] or quick):
                return {}
        narrow = min(found, key=lambda index: share[index])
        if quick and narrow != self.last and len(found[narrow].xs) < effort.enough:
            look(narrow, effort.enough, effort.batches)
        free = sorted((one for one in found if len(found[one].xs)), key=lambda index: share[index])
        return {index: found[index] for index in free} if all(solved.values()) else {}

    def _shared(self, index: int, grasps: Indices) -> Indices:
        """Those of the grasps for which a free posture is found at another waypoint."""
        known = np.empty(0, np.intp)
        for _ in range(TRIES):
            open_ones = np.setdiff1d(grasps, known)
            if not len(open_ones):
                break
            known = np.union1d(known, self._free_seeds(index, np.repeat(open_ones, EACH)).grasps)
        return known

    def _sampled(
        self, index: int, grasps: Indices, enough: int, effort: Effort, batches: int
    ) -> tuple[Layer, float]:
        """Free postures at a waypoint, as many as are enough if they are found, and their share of the seeds.

        Half of the seeds are for grasps that a posture was found for.
        """
        layer, seeds, solved = self._free_seeds(index, grasps[:0]), 0, self.searcher.tally.solved
        for batch in range(0, batches, effort.together):
            left = grasps[self._may_fit[grasps]]
            if not len(left):
                break
            more = self.rng.choice(left, effort.together * SEEDS)
            if len(layer.xs):
                more[::2] = self.rng.choice(layer.grasps, len(more[::2]))
            layer = both(layer, self._free_seeds(index, more))
            seeds += len(more)
            hopeless = batch >= HOPELESS and self.searcher.tally.solved == solved
            few = batch >= effort.few and len(layer.xs)
            if len(layer.xs) >= enough or few or hopeless or self.late():
                break
        return layer, len(layer.xs) / max(seeds, 1)

    def _free_seeds(self, index: int, grasps: Indices) -> Layer:
        """Free postures at a waypoint that one seed for each of these grasps leads to."""
        batches = -(-len(grasps) // SEEDS)
        none = np.empty((0, len(self.searcher.weight)))
        xs = np.concatenate([none, *(self.searcher.seeds(index, self.rng) for _ in range(batches))])[
            : len(grasps)
        ]
        layer = Layer(xs, grasps, np.arange(len(xs)))
        met = self.meet(layer, index)
        self.searcher.tally.seeds += len(xs)
        self.searcher.tally.solved += int(met.sum())
        layer = layer.some(met)
        layer = layer.some(self.clear(layer, index, self._bare))
        layer = layer.some(np.array([self.fits(one) for one in layer.grasps.tolist()], dtype=np.bool_))
        layer = layer.some(self.meet(layer, index))
        return layer.some(self.clear(layer, index))

    def fits(self, grasp: int) -> bool:
        """Whether a grasp fits and is a hold; its tool is then where the hand is closed, not as meant."""
        if grasp not in self._fitted:
            fitted = self._fitter.fitted(self.opened[grasp])
            if fitted is not None and not self._fitter.engaged(fitted[0]):
                fitted = None
            self._fitted[grasp], self._may_fit[grasp] = fitted, fitted is not None
            if fitted is not None:
                self._translation[grasp], self._rests[grasp] = fitted[0].translation, fitted[1]
        return self._fitted[grasp] is not None

    def meet(self, layer: Layer, index: int) -> NDArray[np.bool_]:
        """Which postures were moved to where the tool is in their grasp, the base anywhere it may stand."""
        one = self.searcher
        limits = one.lower, one.upper
        target = self._targets(layer, index)
        return ik.solve_many(layer.xs, *target, self.limb.chain, one.weight, *limits, STEPS, EXACT)

    def follow(self, layer: Layer, index: int | Indices) -> NDArray[np.bool_]:
        """The same, as the limb may move while the handle does."""
        return self.following.met(layer.xs, *self._targets(layer, index))

    def _targets(self, layer: Layer, index: int | Indices) -> tuple[Array, Array]:
        """World tool poses of the grasps of postures at a waypoint, or at one of each."""
        problem, there = self.searcher.problem, self._translation[layer.grasps]
        turn, place = problem.handle_r[index], problem.handle_p[index]
        return turn @ self._rotation[layer.grasps], (turn @ there[:, :, None])[:, :, 0] + place

    def clear(self, layer: Layer, index: int | Indices, rules: Rules | None = None) -> NDArray[np.bool_]:
        """Which postures touch nothing, at the distances demanded while they hold or at these."""
        one = self.searcher
        if not len(layer.xs):
            return np.empty(0, np.bool_)
        q = self.limb.q(layer.xs, self._rests[layer.grasps])
        values = np.broadcast_to(one.problem.values[index], len(q))
        q = one.problem.mechanics.put_each(q, values)
        return np.array(
            [pair is None for pair in one.world.contact_each(q, rules or one.rules)], dtype=np.bool_
        )


def both(one: Layer, other: Layer) -> Layer:
    """The postures of two layers of one waypoint."""
    return Layer(
        np.concatenate([one.xs, other.xs]),
        np.concatenate([one.grasps, other.grasps]),
        np.concatenate([one.parents, other.parents]),
    )
