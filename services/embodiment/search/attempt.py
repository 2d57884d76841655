"""The search with one gripper: its grasps as they come due, and when it has gone on for long enough."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Drive
from services.embodiment.body.limb import Limb
from services.embodiment.hold.bred import Breeder
from services.embodiment.hold.fit import Fitter, Opened
from services.embodiment.hold.grasp import Grasp
from services.embodiment.hold.holding import Holding, Problem, Searcher
from services.embodiment.hold.parts import around, parts
from services.embodiment.hold.pool import anyhow
from services.embodiment.hold.sampling import FULL, Effort, Sampler
from services.embodiment.hold.spread import Spreader
from services.embodiment.ways.approach import Approacher
from services.embodiment.ways.assemble import Assembler

Array = NDArray[np.float64]

GRASPS = (6, 12, 36)  # grasps of one gripper that are searched in the first rounds, and from then on
ROUNDS = 24  # batches of seeds for one gripper before the search gives up
BLOCKED = 24  # holdings of one gripper that cannot be approached before its search gives up


@dataclass(slots=True, eq=False)
class Attempt:
    """The search with one gripper.

    Attributes:
        grasps: Those that are searched so far.
        more: Those that may follow.
        steep, steeper: The same for those that come from far above or below, which high and low handles
            and those that tip over may need.
        wide: Those that many postures search together.
        bred: Those that were looked at in between, by number.
        blocked: Holdings that could not be approached.
    """

    limb: Limb
    fitter: Fitter
    grasps: list[tuple[Grasp, Array]]
    more: Iterator[tuple[Grasp, Array]]
    steep: list[tuple[Grasp, Array]]
    steeper: Iterator[tuple[Grasp, Array]]
    searcher: Searcher
    approacher: Approacher
    assembler: Assembler
    rng: np.random.Generator
    wide: list[Opened] = field(default_factory=list[Opened])
    bred: dict[int, Opened] = field(default_factory=dict[int, Opened])
    blocked: int = 0

    def saturated(self, number: int) -> bool:
        """Whether so much was tried for nothing that round `number` would hardly be another."""
        return self.blocked >= BLOCKED or (number >= ROUNDS and not self.searcher.tally.paths)

    def through(self, waypoints: int) -> None:
        """Paths are through so many waypoints."""
        problem, limb = self.searcher.problem, self.limb
        values = np.linspace(problem.values[0], problem.values[-1], waypoints)
        finer = Problem.through(problem.mechanics, self.fitter.bar, limb.q(limb.parked), values)
        self.searcher.problem = self.assembler.problem = finer

    def widen(self, number: int) -> None:
        """Round `number` searches as many grasps as it is due."""
        due = GRASPS[min(number, len(GRASPS) - 1)]
        self.grasps.extend(islice(self.more, max(due - len(self.grasps), 0)))
        if self._tries_steep(number):
            self.steep.extend(islice(self.steeper, max(due - len(self.steep), 0)))
        self._count()

    def spread(self, late: Callable[[], bool], effort: Effort) -> Iterator[Holding]:
        """Holdings of listed grasps, if any fits at all, that many postures find together."""
        if self.fitter.has_room and not self.wide:
            self.wide = self.fitter.wide(late)
            self._count()
        if self.wide:
            yield from self._spreader(self.fitter, self.wide, effort, late).holdings()

    def breed(self, late: Callable[[], bool]) -> Iterator[Holding]:
        """The same of grasps between these, which can be had at every value of the container."""
        yield from self._bred(Breeder(self.searcher, self.fitter, self.rng, late), late)

    def breed_anyhow(self, late: Callable[[], bool]) -> Iterator[Holding]:
        """The same of any part of the handle, held anyhow.

        With a free base nothing is looked for after that, where it stands proofs are.
        """
        one, problem = self.fitter, self.fitter.problem
        every = parts(self.searcher.world, problem.mechanics.container.handle, one.bar)
        fitter = Fitter(one.hand, problem, around(every), one.demands, one.unfit, one.facing)
        more = 1 if self.searcher.drive is Drive.FIXED else 2
        pool = anyhow(every, one.has_room, more)
        yield from self._bred(Breeder(self.searcher, fitter, self.rng, late, pool), late)

    def _bred(self, breeder: Breeder, late: Callable[[], bool]) -> Iterator[Holding]:
        for opened in breeder.litters():
            self.bred |= {one[0].index: one for one in breeder.looked_at}
            self._count()
            for pivot, xs in breeder.postures():
                yield from self._spreader(breeder.fitter, opened, FULL, late).holdings_from(pivot, xs)

    def listed(self) -> Iterator[Grasp]:
        """Listed grasps that were searched; those of the wide set that no posture has as they were meant."""
        for grasp, _ in (*self.grasps, *self.steep):
            yield grasp
        for opened in self.wide:
            closed = self.fitter.known(opened)
            yield opened[0] if closed is None else closed[0]

    def _spreader(
        self, fitter: Fitter, opened: list[Opened], effort: Effort, late: Callable[[], bool]
    ) -> Spreader:
        return Spreader(Sampler(self.searcher, fitter, opened, self.rng, late), effort)

    def _count(self) -> None:
        every = self.grasps, self.steep, self.wide, self.bred
        self.searcher.tally.grasps = sum(map(len, every))

    def _tries_steep(self, number: int) -> bool:
        return number >= len(GRASPS) - 1 and number % 2 == 1 and not self.searcher.tally.paths

    def due(self, number: int) -> list[tuple[Grasp, Array]]:
        """The grasps of round `number`."""
        return self.steep if self._tries_steep(number) and self.steep else self.grasps
