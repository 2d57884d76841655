"""The search: grippers, grasps, holdings, approaches, in rounds until a budget is spent."""

import time
from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial
from itertools import chain, islice

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Drive
from services.embodiment.body.limb import Limb
from services.embodiment.hold.handle import Bar, Mechanics, find_bar
from services.embodiment.hold.holding import WAYPOINTS, Holding
from services.embodiment.hold.kit import Kit, stuck
from services.embodiment.hold.sampling import FULL, QUICK, Effort
from services.embodiment.prove import out_of_reach
from services.embodiment.search.attempt import Attempt
from services.embodiment.search.attempts import make_attempt
from services.embodiment.search.beside import freed
from services.embodiment.search.planned import Anew, Descents, Planned
from services.embodiment.search.proving import EARLY_BOXES, Proofs
from services.embodiment.setting import Setting
from services.embodiment.ways.assemble import Assembled
from services.embodiment.ways.start import contact_at
from services.embodiment.ways.way import Approach, Blocked
from services.kernel import worked

Array = NDArray[np.float64]

MORE_ROUNDS = 48  # of single paths at most, where postures are found but no way on from them
ALONE = 3  # rounds of single paths before many postures search together; a few do so after the first of them
TRIES = 4  # holdings of one batch that are approached
LIMITS = 1.5, 4.0, 16.0  # [s] for each part of a way in several holds, one after the other
FIRST = 24, 2  # turns of descents before several holds are planned, and of those in vain
LAST = 48, 4  # the same at last
BESIDE = 1 / 2, 3 / 4  # [1] of the time that is left in which the head moves too, then other arms
WITHIN = 1.02  # [1] ratio to a limit that a required time may lead to, before certification

Regrasping = tuple[Callable[["Planner"], Anew], Callable[["Planner"], Descents]]


class Planner:
    """Plans for one setting, until the thread that asks has `worked` for the deadline's seconds of CPU.

    Args:
        only: Name of the gripper that is to hold; empty for any, and then proofs may be looked for.

    Attributes:
        attempts: One for each gripper that has a grasp.
        blocked: Stage at which an approach failed → how often.
        holdings: How many were found.
        refused: How many of them led to a motion that was not certified.
        unfit: Pairs of shapes in contact that ruled grasps out → how often.
        proofs: That nothing will do, as far as it was proved.
        start_contact: Shapes of robot and kitchen in contact at the start, and their distance [m].
        parts: Who planned parts of the way, in several holds.
        several: Who put them together, if it was tried.
        descended: Who planned by descent, if it was tried.
        freed: Who planned with what hangs beside the arm, a head, moving too; so, too.
        rough: Motions that leave limits: too fast where times are required, or beyond a joint's end.
    """

    def __init__(
        self,
        setting: Setting,
        deadline: float,
        seed: int,
        spent: Callable[[str, float], None],
        only: str = "",
    ) -> None:
        self.setting, self.deadline, self.seed, self.spent = setting, deadline, seed, spent
        self._only = only
        self.mechanics = Mechanics(setting.world, setting.container)
        self.attempts: list[Attempt] = []
        self.blocked: list[Blocked] = []
        self.rough: list[Assembled] = []
        self.bar: Bar | None = None
        self.holdings = self.refused = self.placements = 0
        self.proofs = Proofs(setting, spent, sought=setting.proves and not only)
        self.parts: list[Planner] = []
        self.several: Anew | None = None
        self.descended: Descents | None = None
        self.freed: Planner | None = None
        self.start_contact: tuple[tuple[int, int], float] | None = None
        self.unfit: Counter[tuple[int, int]] = Counter()

    def kits(self) -> list[Kit]:
        """Those of the grippers that may hold, and can close."""
        scene = self.setting.world.scene
        may = [one for one in scene.annotation.grippers if self._only in {"", one.name}]
        return [self.setting.kits.of(one) for one in may if not stuck(scene, one)]

    def late(self) -> bool:
        """Whether the budget is spent."""
        return worked() > self.deadline

    def plans(self, regrasping: "Regrasping | None" = None) -> Iterator[Planned]:
        """Body motions, one after the other, until the search gives up.

        Args:
            regrasping: Who plans in several holds, where no one hold was found, and who does so by descent.
        """
        at = time.perf_counter()
        kits = self.kits()
        self._prove_at_once([kit.limb for kit in kits])
        self.start_contact = contact_at(self.setting.kits, self.setting.start)
        self.spent("grasp", at)
        if self.start_contact is not None:
            self.proofs.give_up(few=True, deadline=self.deadline)
            return
        stands = self.setting.drive is Drive.FIXED
        descends = stands and regrasping is not None and bool(self.setting.kits.beside)
        for number in range(1 if descends else MORE_ROUNDS):
            yield from self._between(number)
            if self.proofs.ended:
                return
            for attempt in self._attempts(kits, number):
                if attempt.saturated(number):
                    continue
                if self.late():
                    self.proofs.give_up(few=self._has_ways(), deadline=self.deadline)
                    self.proofs.look_at_last(followed=self._has_ways(), late=self.late)
                    self.proofs.look_at_grasps(self.bar)
                    return
                yield from self._round(attempt, number)
        self.proofs.give_up(few=self._has_ways(), deadline=self.deadline)
        spread, bred = self._spread(FULL), self._bred()
        if stands:
            yield from self._standing(spread, bred, regrasping)
        else:  # bred ones first where nothing could be followed: many have found nothing before
            yield from chain(*((spread, bred) if self._has_ways() else (bred, spread)))
            yield from self._beside(regrasping)
        self.proofs.look_at_last(followed=self._has_ways(), late=self.late)
        yield from self._descended(LAST)
        self.proofs.look_at_grasps(self.bar)

    def _standing(
        self, spread: Iterator[Planned], bred: Iterator[Planned], regrasping: "Regrasping | None"
    ) -> Iterator[Planned]:
        """The last plans where the base stands: bred grasps take longer there than all else."""
        if regrasping is None:
            yield from chain(spread, bred, self._beside(None))
            return
        self.several = several = regrasping[0](self)
        self.descended = regrasping[1](self)
        if self.setting.kits.beside:  # what descents do not find there nothing else does
            yield from chain(self._descended(FIRST), self._descended(LAST))
            return
        *quick, last = map(several.plans, LIMITS)
        yield from chain(spread, self._descended(FIRST), self._beside(regrasping), *quick, bred, last)

    def _beside(self, regrasping: "Regrasping | None") -> Iterator[Planned]:
        """Plans in which what hangs beside the arm, a head, moves too, for part of the time that is left."""
        held = any(attempt.searcher.tally.grasps for attempt in self.attempts)
        if self._only or self.proofs.ended or not held:
            return
        for setting, share in zip(freed(self.setting, self.mechanics), BESIDE, strict=False):
            until = worked() + share * (self.deadline - worked())
            self.freed = planner = Planner(setting, until, self.seed, self.spent)
            for planned in planner.plans(regrasping):
                yield planned
                self.refused += 1
            self.parts += [planner, *planner.parts]

    def _descended(self, turns: tuple[int, int]) -> Iterator[Planned]:
        """Plans by descent, where that is tried, nothing is proved and there is time."""
        if self.descended is not None and self.proofs.whole is None and not self.late():
            yield from self.descended.plans(*turns)

    def _between(self, number: int) -> Iterator[Planned]:
        """Before round `number`, an early look for proofs, and plans that many postures find together."""
        if number == 1:
            solved = any(attempt.searcher.tally.solved for attempt in self.attempts)
            self.proofs.look_early(solved=solved, deadline=self.deadline)
        if 0 < number <= ALONE and not self.proofs.ended:
            yield from self._spread(FULL if number == ALONE else QUICK)

    def _spread(self, effort: Effort) -> Iterator[Planned]:
        """Plans from holdings of listed grasps that many postures find together."""
        yield from self._with(partial(Attempt.spread, effort=effort))

    def _bred(self) -> Iterator[Planned]:
        """Plans from holdings of bred grasps: they hold the bar, then any part of the handle anyhow.

        Proofs about holds come before, or after where the base stands: there they take longer.
        """
        stands = self.setting.drive is Drive.FIXED
        if not stands:
            self._prove_of_holds()
        for way in (Attempt.breed, Attempt.breed_anyhow):
            yield from self._with(way)
        if stands:
            self._prove_of_holds()

    def _with(self, way: Callable[..., Iterator[Holding]]) -> Iterator[Planned]:
        """Plans of each gripper, first of the one that has followed the handle farthest.

        A base that found no way to a holding needs no others, but ways.
        """
        stands = self.setting.drive is Drive.FIXED
        shut = not stands and any(one.stage == "drive" for one in self.blocked)
        for attempt in () if shut else sorted(self.attempts, key=lambda one: -one.searcher.tally.came):
            if not self.proofs.ended and not self.late():
                yield from self._of(attempt, way(attempt, late=self.late))

    def _prove_at_once(self, limbs: list[Limb]) -> None:
        """Look for a proof where one is likely: times may be too short, or the handle far from any hand."""
        if self.setting.motion.timed:
            self.proofs.look(0)
        if out_of_reach(self.setting.world, self.mechanics, limbs, self.setting.motion.values[:, 0]):
            self.proofs.look(EARLY_BOXES)

    def _prove_of_holds(self) -> None:
        """Look for a proof that no hold, or none in hand, can be had all along, where none was found."""
        if not self._has_ways():
            tools = [grasp.translation for attempt in self.attempts for grasp in attempt.listed()]
            self.proofs.look_at_holds(tools, sum(len(attempt.bred) for attempt in self.attempts), self.late)

    def _has_ways(self) -> bool:
        """Whether a handle could be followed in hand all along."""
        return any(attempt.searcher.tally.paths for attempt in self.attempts)

    def _attempts(self, kits: list[Kit], number: int) -> Iterator[Attempt]:
        """Every gripper's, with the grasps for this round; the first round makes them."""
        for k, kit in enumerate(kits):
            at = time.perf_counter()
            if number == 0:
                attempt = self.attempt(kit)
                if attempt is None:
                    return
                self.attempts.append(attempt)
            self.attempts[k].widen(number)
            self.spent("grasp", at)
            yield self.attempts[k]

    def attempt(self, kit: Kit) -> Attempt | None:
        """The search with one gripper; None if the handle has nothing to hold."""
        q = kit.limb.q(kit.limb.parked)
        self.bar = self.bar or find_bar(self.setting.world, self.mechanics, q)
        if self.bar is None:
            return None
        about = self.setting, self.mechanics, self.bar, kit
        return make_attempt(*about, unfit=self.unfit, seed=self.seed, late=self.late)

    def _round(self, attempt: Attempt, number: int) -> Iterator[Planned]:
        """Plans from one batch of seeds."""
        if grasps := attempt.due(number):
            pivot = (WAYPOINTS // 2, WAYPOINTS - 1, 0)[number % 3]
            yield from self._of(attempt, attempt.searcher.batch(grasps, pivot, attempt.rng))

    def _of(self, attempt: Attempt, holdings: Iterator[Holding]) -> Iterator[Planned]:
        """Plans with some of these holdings."""
        at = time.perf_counter()
        for holding in islice(holdings, TRIES):
            self.spent("holding", at)
            self.holdings += 1
            planned = self.approached(attempt, holding)
            if planned is not None:
                yield planned
                self.refused += 1
            if self.late():
                return
            at = time.perf_counter()
        self.spent("holding", at)

    def approached(
        self, attempt: Attempt, holding: Holding, by: Approach | None = None, begins: Array | None = None
    ) -> Planned | None:
        """The motion with this holding, by a way to it that is known, or found; None if it leaves limits."""
        at = time.perf_counter()
        self.placements += 1
        approach = by or attempt.approacher.approach(holding, attempt.searcher.problem, attempt.rng)
        self.spent("approach", at)
        if isinstance(approach, Blocked):
            self.blocked.append(approach)
            attempt.blocked += 1
            return None
        at = time.perf_counter()
        assembled = attempt.assembler.assemble(approach, holding, begins)
        self.spent("timing", at)
        if max(assembled.excess) > WITHIN or assembled.outside > 0:
            self.rough.append(assembled)
            return None
        made = holding, approach, attempt.assembler
        return Planned(assembled.body, assembled.motion, holding.grasp.index, holding.style, *made)
