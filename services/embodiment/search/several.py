"""Motions in several holds: the container is brought a part of the way, let go, and held anew.

Where no one hold was found, the way is cut in parts, and each is planned as if it were all: from parked, with
the container where the part before has left it. In between the hand leaves the handle as it would have come
to it there, backwards, and comes to it as it does from parked: straight from one to the other where a way of
the arm is found, else by way of parking. All that is where the base stands. What one hold can do of the
whole, it can do of each part: so short ones are looked for first, and a gripper that lacks one is out; then
as few as lead all the way.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sdt_kg.iri import local_name
from sdt_kg.motion import Motion
from services.embodiment.body.world import World
from services.embodiment.hold.holding import Holding
from services.embodiment.search.leg import Back, Leg, joined, orders
from services.embodiment.search.plan import Planner
from services.embodiment.search.planned import Planned
from services.embodiment.setting import Setting
from services.embodiment.ways.roads import Known
from services.embodiment.ways.timing import farthest, turns_back
from services.embodiment.ways.way import Approach
from services.kernel import worked
from services.physics.model import Scene

PARTS = 4
"""[1] In which the way is cut at first, and each of them that is not found in two."""
PLANS = 24
"""[1] Of one part, until one can be left again."""

Array = NDArray[np.float64]
Ends = tuple[float, float]


@dataclass(slots=True)
class Legs:
    """The parts that one gripper was asked for.

    Attributes:
        known: What was found of a part, and how long it was looked for [s]; infinite once all was tried.
        settings: The kitchen with the container at a value.
        lacks: A part that was not found, without which there is no way.
    """

    planner: Planner
    gripper: str
    last: float
    known: dict[Ends, tuple[Leg | None, float]] = field(default_factory=dict[Ends, tuple[Leg | None, float]])
    settings: dict[float, Setting] = field(default_factory=dict[float, Setting])
    lacks: Ends | None = None

    @property
    def found(self) -> int:
        """How many parts are known."""
        return sum(leg is not None for leg, _ in self.known.values())

    def ways(self, first: float, limit: float) -> Iterator[list[Leg]]:
        """Legs that lead all the way, in few holds, then in many; so long is looked for each part [s]."""
        edges = self._fine(first, limit)
        if not edges:
            return
        few, at = [0], 0
        while at < len(edges) - 1:
            farthest = len(edges) - 1 if at else len(edges) - 2  # all of it was looked for
            at = next(k for k in range(farthest, at, -1) if self._leg((edges[at], edges[k]), limit))
            few.append(at)
        for chosen in dict.fromkeys((tuple(few), tuple(range(len(edges))))):
            legs = [self._leg((edges[i], edges[k]), limit) for i, k in pairwise(chosen)]
            yield [leg for leg in legs if leg is not None]

    def _fine(self, first: float, limit: float) -> list[float]:
        """Ends of parts each of which is found; empty where one is not. The last is mostly the narrow one."""
        ends = np.linspace(first, self.last, PARTS + 1).tolist()
        parts, edges = [*pairwise(ends)], [*ends]
        for part in (parts[-1], *parts[:-1]):
            if self._leg(part, limit) is None:
                middle = sum(part) / 2
                halves = (middle, part[1]), (part[0], middle)
                self.lacks = next((each for each in halves if self._leg(each, limit) is None), None)
                if self.lacks is not None:
                    return []
                edges.append(middle)
        return sorted(edges, reverse=self.last < first)

    def _leg(self, ends: Ends, limit: float) -> Leg | None:
        leg, looked = self.known.get(ends, (None, 0.0))
        if leg is None and looked < limit and not self.planner.late():
            leg, looked = self.known[ends] = self._planned(ends, limit)
        return leg

    def _planned(self, ends: Ends, limit: float) -> tuple[Leg | None, float]:
        """One part in one hold, which can be let go at its end."""
        planner = self.at(ends, min(worked() + limit, self.planner.deadline))
        self.planner.parts.append(planner)
        for number, planned in enumerate(planner.plans(), 1):
            if ends[1] == self.last:
                return Leg(planned, None), limit
            back = self._back(planned.holding, ends[1])
            if back is not None:
                return Leg(planned, back), limit
            if number == PLANS or planner.late():
                return None, limit
        return None, limit if planner.late() else np.inf

    def at(self, ends: Ends, deadline: float) -> Planner:
        """Who plans one part."""
        whole = self.planner
        return Planner(self._setting(ends), deadline, whole.seed, whole.spent, only=self.gripper)

    def _back(self, holding: Holding, value: float) -> Back | None:
        """How the end of a holding is left, the container at a value; None if no way was found."""
        planner = self.at((value, self.last), self.planner.deadline)
        attempt = next((planner.attempt(kit) for kit in planner.kits()), None)
        if attempt is None:
            return None
        here, problem = replace(holding, limb=attempt.limb, xs=holding.xs[-1:]), attempt.searcher.problem
        if not attempt.approacher.lets_go(here, problem):
            return None
        approach = attempt.approacher.approach(here, problem, attempt.rng)
        return Back(here, approach, attempt) if isinstance(approach, Approach) else None

    def _setting(self, ends: Ends) -> Setting:
        """Of one part: the kitchen as it is when that begins."""
        value, end = ends
        if value not in self.settings:
            begins = value == self.planner.mechanics.start
            self.settings[value] = _moved(self.planner.setting, value, begins=begins)
        setting = self.settings[value]
        motion = Motion(setting.motion.of, np.array([0.0, 1.0]), np.array([[value], [end]]), timed=False)
        return replace(setting, motion=motion)


class Several:
    """Plans of one gripper after the other: first that of which more parts are known, or that came farther.

    What is known of a part is kept from one time to the next.
    """

    def __init__(self, planner: Planner) -> None:
        self._planner, setting = planner, planner.setting
        self._first = planner.mechanics.start
        last = farthest(setting.motion, self._first, setting.container)
        straight = not setting.motion.timed and not turns_back(setting.motion)
        order = sorted(planner.attempts if straight else (), key=lambda one: -one.searcher.tally.came)
        self._every = [Legs(planner, attempt.limb.gripper.name, last) for attempt in order]

    def lacking(self) -> Iterator[tuple[str, Ends]]:
        """Grippers for which a part of the way was not found, and from which value to which [rad or m]."""
        for legs in self._every:
            if legs.lacks is not None:
                yield legs.gripper, legs.lacks

    def plans(self, limit: float) -> Iterator[Planned]:
        """Those that are found if each part is looked for so long [s]."""
        for legs in sorted(self._every, key=lambda one: -one.found):
            if self._planner.proofs.whole is not None:
                return
            for way in legs.ways(self._first, limit):
                for bodies in orders(way, self._planner.late):
                    yield joined([leg.planned for leg in way], bodies)
                if self._planner.late():
                    return


def _moved(setting: Setting, value: float, *, begins: bool) -> Setting:
    """The setting with the container at a value when it begins.

    If that is not its first, arms and head are parked aside, if planning moves them too.
    """
    was = setting.world.scene
    twin = was.twin.at({setting.container.joint: value})
    aside = {} if begins else {local_name(joint): at for joint, at in setting.kits.beside.items()}
    parked = replace(was.annotation, parked=was.annotation.parked | aside)
    world = World(Scene(twin, setting.robot, parked))
    container = twin.container(setting.container.iri).by_handle(setting.container.handle)
    kits = replace(setting.kits, world=world)
    return replace(setting, world=world, container=container, kits=kits, roads=Known())
