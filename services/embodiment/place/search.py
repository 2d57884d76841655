"""The question `place`: candidates from holdings, each certified by CanPerform as it is asked elsewhere."""

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from predicates.case import Case, Diagnosis
from predicates.causes import causes
from predicates.margins import CLEARANCES
from predicates.meant import by_other_handles, handles_of_no_container
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.iri import Iri
from sdt_kg.motion import Motion
from sdt_kg.task import UNKNOWN, Task
from sdt_kg.twin import Container, Twin
from services.embodiment.body.demands import Margins, touching
from services.embodiment.body.limb import BASE
from services.embodiment.body.world import World
from services.embodiment.floor import check_floor
from services.embodiment.hold.fit import Fitter
from services.embodiment.hold.grasp import Grasp
from services.embodiment.hold.handle import Mechanics, find_bar
from services.embodiment.hold.holding import WAYPOINTS, Problem, Searcher
from services.embodiment.hold.kit import Kit, Kits
from services.embodiment.oracle import WholeBody
from services.embodiment.place.grid import CELLS, SIDE, Cell, Excluder, Status, block, cells
from services.embodiment.place.placement import DECIMALS, Placement, Pose, Spot
from services.embodiment.prove import Prover
from services.kernel import worked
from services.physics.chain import of_own_joint
from services.physics.model import Scene
from services.physics.oracle import Kinematics

Array = NDArray[np.float64]

DRAWN = 0.4  # [1] of the budget may be spent when candidates are drawn for the last time
ASKED = 0.8  # [1] of the budget may be spent when the last candidate is asked about; the rest is the map's
MAPPED = 0.95  # [1] of the budget may be spent when squares are no longer proved impossible
GRASPS = 6  # more of one gripper with each batch
BATCHES = 12  # of seeds for one gripper
EACH = 0.25  # [1] of what is left of the budget may go into one candidate
ENOUGH = 40  # certified poses
DRAWN_FOR_ONE = 3  # candidates that are drawn for each of them
LEAST = 1.0  # [s] for one candidate


def place(  # noqa: PLR0913, PLR0917  # what is asked; the rest has defaults
    twin: Twin,
    robot: Iri,
    task: Task,
    budget: float = 20.0,
    seed: int = 0,
    enough: int = ENOUGH,
    friction: float | None = None,
) -> Placement:
    """Base poses from which the robot can do the task without moving its base, and a map.

    Every pose given is certified by CanPerform, asked with that start and a fixed base. A pose that
    is not given is not impossible, unless its cell of the map says so.

    Args:
        twin: Kitchen and robot, in the state in which the motion begins.
        robot: IRI of a robot of the twin.
        task: About one container.
        budget: Seconds of CPU.
        seed: Of the search.
        enough: Certified poses after which no more are looked for.
        friction: With which coefficient fingers rub on handles [1]; None: a certificate says what it takes.

    Raises:
        InputError: The task is about no container.
    """
    began = worked()
    asked = _question(twin, robot, task, budget, seed, friction)
    if isinstance(asked, _Question):
        asked.enough = enough
        return asked.answered()
    return Placement(asked.name, (), (), 0, asked.diagnoses, worked() - began)


def spots(  # noqa: PLR0913, PLR0917  # what is asked
    twin: Twin, robot: Iri, task: Task, budget: float, seed: int, enough: int, friction: float | None = None
) -> tuple[Spot, ...]:
    """The poses that `place` has, best margin first, without its map: no more time than they take.

    Raises:
        InputError: The task is about no container.
    """
    asked = _question(twin, robot, task, budget, seed, friction)
    if not isinstance(asked, _Question):
        return ()
    asked.enough = enough
    return asked.spots(asked.rows())


@dataclass(frozen=True, slots=True)
class _Still:
    """A container that has no motion to follow, and why."""

    name: str
    diagnoses: tuple[Diagnosis, ...]


def _question(  # noqa: PLR0913, PLR0917  # what is asked
    twin: Twin, robot: Iri, task: Task, budget: float, seed: int, friction: float | None
) -> "_Question | _Still":
    if task.container is UNKNOWN:
        raise InputError("a place for no container", allowed="open:CONTAINER or close:CONTAINER")
    container = twin.container(task.container)
    answer = next(iter(causes(Case(twin, robot=robot, task=task), Kinematics())))
    if not answer.holds or not isinstance(answer.case.motion, Motion):
        return _Still(container.name, answer.diagnoses)
    how = {"regrasps": False, "proves": False}  # the map has proofs of its own
    oracle = WholeBody(Drive.FIXED, (0.0, 0.0, 0.0), seed=seed, friction=friction, **how)
    return _Question(twin, robot, container, answer.case, answer.case.motion, budget, oracle)


class _Question:
    """One question, on its way."""

    def __init__(  # noqa: PLR0913, PLR0917  # what is asked
        self,
        twin: Twin,
        robot: Iri,
        container: Container,
        case: Case,
        motion: Motion,
        budget: float,
        oracle: WholeBody,
    ) -> None:
        self.twin, self.robot, self.container, self.motion = twin, robot, container, motion
        self.case, self.budget, self.oracle = case, budget, oracle
        self.world = World(Scene(twin, robot))
        check_floor(self.world.scene)
        self.kits = Kits(self.world, Margins())
        every = (container, *by_other_handles(twin, container))
        ends = [of_own_joint(self.world.scene, each, motion).values[-1, 0] for each in every]
        self.ways = [(Mechanics(self.world, each), float(end)) for each, end in zip(every, ends, strict=True)]
        self.began = worked()
        self.tried, self.enough = 0, ENOUGH

    def after(self, share: float) -> Callable[[], bool]:
        """Whether that share of the budget is spent."""
        return lambda: worked() > self.began + share * self.budget

    def rows(self) -> list[list[Cell]]:
        """The map of which nothing is known yet."""
        handle = self.world.scene.placement(self.world.scene.q((0.0, 0.0, 0.0), {}), self.container.handle)
        return cells(handle.translation[:2])

    def spots(self, rows: list[list[Cell]]) -> tuple[Spot, ...]:
        """Certified poses, best margin first; the map is marked."""
        return tuple(sorted(self._spots(rows), key=lambda spot: -spot.margin))

    def answered(self) -> Placement:
        rows = self.rows()
        found = self.spots(rows)
        here, values = (0.0, 0.0, 0.0), self.motion.values[:, 0]
        prover = Prover(self.twin, self.robot, self.container, Drive.FIXED, here, values)
        about = self.twin, self.container
        if not (by_other_handles(*about) or handles_of_no_container(*about)):
            Excluder(prover, self.after(MAPPED)).exclude(rows)
        block(rows, self.world, self.kits.outside(), self.after(1.0))
        seconds = worked() - self.began
        return Placement(self.container.name, found, tuple(map(tuple, rows)), self.tried, (), seconds)

    def _spots(self, rows: list[list[Cell]]) -> Iterator[Spot]:
        """Certified poses, those in cells without one first; the map is marked."""
        waiting = list(islice(self._candidates(), self.enough * DRAWN_FOR_ONE))
        found = 0
        late = self.after(ASKED)
        while waiting and found < self.enough and not late():
            waiting.sort(key=lambda pose: self._known(rows, pose))
            pose = waiting.pop(0)
            spot = self._certified(pose)
            if spot is None:
                continue
            found += 1
            yield spot
            where = _cell(rows, pose)
            if where is not None:
                i, j = where
                best = max(spot.margin, rows[i][j].margin or 0.0)
                rows[i][j] = replace(rows[i][j], status=Status.CERTIFIED, margin=best)

    def _known(self, rows: list[list[Cell]], pose: Pose) -> bool:
        where = _cell(rows, pose)
        return where is not None and rows[where[0]][where[1]].status is Status.CERTIFIED

    def _certified(self, pose: Pose) -> Spot | None:
        left = self.began + ASKED * self.budget - worked()
        self.tried += 1
        self.oracle.start, self.oracle.budget = pose, max(EACH * left, min(left, LEAST))
        answer = self.oracle.perform(replace(self.case, robot=self.robot, motion=self.motion))
        if not answer.holds or answer.case.body_motion is UNKNOWN:
            return None
        margin = min(answer.figures[name][0] for name in CLEARANCES if name in answer.figures)
        return Spot(*pose, margin, answer.case.body_motion.gripper)

    def _candidates(self) -> Iterator[Pose]:
        """Base poses of holdings during which the base stands, in turn by each handle and gripper."""
        late = self.after(DRAWN)
        kits = [self.kits.of(gripper) for gripper in self.world.scene.annotation.grippers]
        found = (self._holdings(kit, *way) for way in self.ways for kit in kits)
        searches = [search for search in found if search is not None]
        while searches and not late():
            for search in tuple(searches):
                pose = next(search, None)
                if pose is None:
                    searches.remove(search)
                elif self._stands_free(pose):
                    yield pose

    def _stands_free(self, pose: Pose) -> bool:
        """Whether the robot can be parked there."""
        q = self.world.scene.q(pose, {})
        return self.world.contact(q[None], self.kits.outside()) is None

    def _holdings(self, kit: Kit, mechanics: Mechanics, end: float) -> Iterator[Pose] | None:
        q = kit.limb.q(kit.limb.parked)
        bar = find_bar(self.world, mechanics, q)
        if bar is None:
            return None
        values = np.linspace(mechanics.start, end, WAYPOINTS)
        problem = Problem.through(mechanics, bar, q, values)
        holding = touching(self.world, kit.limb, kit.demands, (mechanics.container.handle,))
        fitted = Fitter(kit.hand, problem, bar, (holding, kit.demands), Counter()).fitting()
        searcher = Searcher(self.world, kit.limb, problem, holding, Drive.FIXED)
        rng = np.random.default_rng(self.oracle.seed)
        return self._poses(searcher, fitted, rng)

    def _poses(
        self, searcher: Searcher, fitted: Iterator[tuple[Grasp, Array]], rng: np.random.Generator
    ) -> Iterator[Pose]:
        grasps: list[tuple[Grasp, Array]] = []
        for number in range(BATCHES):
            grasps.extend(islice(fitted, GRASPS))
            if not grasps:
                return
            pivot = (WAYPOINTS // 2, WAYPOINTS - 1, 0)[number % 3]
            for held in searcher.batch(grasps, pivot, rng):
                x, y, yaw = held.xs[0, BASE]
                turn = (yaw + np.pi) % (2 * np.pi) - np.pi
                yield round(float(x), DECIMALS), round(float(y), DECIMALS), round(float(turn), DECIMALS)


def _cell(rows: list[list[Cell]], pose: Pose) -> tuple[int, int] | None:
    """Row and column of the cell that a pose lies in."""
    width = SIDE / CELLS
    j = int(np.floor((pose[0] - rows[0][0].x) / width + 0.5))
    i = int(np.floor((pose[1] - rows[0][0].y) / width + 0.5))
    return (i, j) if 0 <= i < CELLS and 0 <= j < CELLS else None
