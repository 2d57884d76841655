"""From the start pose, parked, to the handle: drive, raise the arm with room around, come near, take hold.

Built backwards: the hand leaves the bar along its approach axis or aslant, the base backs off, there the
arm folds to its parked posture, and from there the robot drives home. Where it is too wide for that, the
arm folds to the slimmest posture that is known, and is parked only at home.
"""

from collections.abc import Callable, Iterator
from functools import cached_property, partial
from itertools import pairwise, product

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Drive
from services.embodiment.body.demands import touching
from services.embodiment.body.limb import BASE
from services.embodiment.body.track import bases, track
from services.embodiment.body.world import Contact, Rules
from services.embodiment.hold.grasp import Positions
from services.embodiment.hold.holding import Holding, Problem, inside
from services.embodiment.hold.kit import Kit
from services.embodiment.ways.paths import between, connect
from services.embodiment.ways.roads import Roads
from services.embodiment.ways.spaces import FINE_STEP, ArmSpace, reaches
from services.embodiment.ways.way import Approach, Blocked, joined

Array = NDArray[np.float64]

LEAVE = 0.1  # [m] the open hand backs off from the bar
ASLANT = np.radians([0, 30, -30, 60, -60])  # [rad] from its approach axis, between the fingers
PULLS = 11  # waypoints of that
BACK_OFFS = (0.25, 0.5, 0.8, 1.2)  # [m] the base drives back before the arm folds
ARM_ITERATIONS = 60
PLACES = 4  # from which a way around is looked for
OPENING_STEPS = 24
"""[1] Steps at which fingers that open or close are looked at."""


class Approacher:
    """Ways to holdings of one limb.

    Attributes:
        backs_off: By how much the open hand backs off from the bar, one after the other [m].
        samples: Of a path of the arm.

    Args:
        roads: Of the parked robot.
        slim: Of the robot with its arm carried as slim as it can be; asked for where those lead nowhere.
    """

    def __init__(
        self, roads: Roads, slim: Callable[[], Roads], kit: Kit, start: Array, late: Callable[[], bool]
    ) -> None:
        self.roads, self.start, self.late = roads, start, late
        self.hand, self.rules = kit.hand, kit.opened
        self.world, self.limb, self.drive = kit.hand.world, kit.limb, roads.space.drive
        self.weight = reaches(self.limb)
        self.backs_off: tuple[float, ...] = (LEAVE,)
        self.samples = ARM_ITERATIONS
        self.rest = self.limb.rest
        self._slim = slim
        self._tucked: tuple[Array | None, ...] = ()  # one, once it was looked for
        self._contact_there: Contact | None = None

    @cached_property
    def slim(self) -> Roads:
        """Roads of the robot with its arm carried as slim as it can be."""
        return self._slim()

    def approach(self, holding: Holding, problem: Problem, rng: np.random.Generator) -> Approach | Blocked:
        """The way to a holding, or the stage that failed last."""
        left = self._leave(holding, problem)
        if isinstance(left, Blocked):
            return left
        outcome = self._by(self.roads, left, problem, rng)
        if isinstance(outcome, Approach) or outcome.stage != "drive" or self.late():
            return outcome
        other = Blocked("drive") if self.drive is Drive.FIXED else self._by(self.slim, left, problem, rng)
        return other if isinstance(other, Approach) else outcome

    def nearby(self, holding: Holding, problem: Problem) -> Approach | Blocked:
        """The way to a holding from where the open hand is clear of the handle, or what stopped that."""
        left = self._leave(holding, problem)
        if isinstance(left, Blocked):
            return left
        still = left[[-1, -1]]
        return Approach(still, still, still, left[::-1])

    def lets_go(self, holding: Holding, problem: Problem) -> bool:
        """Whether the fingers open where a holding begins, and touch nothing but the handle."""
        handle = problem.mechanics.container.handle
        rules = touching(self.world, self.limb, self.rules, (handle,))
        return self.swings(holding.xs[0], holding.grasp.fingers, holding.grasp.opened, rules)

    def swings(self, x: Array, begin: Positions, end: Positions, rules: Rules | None = None) -> bool:
        """Whether the fingers go from one opening to another at x (n,), and keep their distances or these."""
        names, ends = [name for name, _ in begin], np.array([[at for _, at in each] for each in (begin, end)])
        every = ends[0] + np.linspace(0.0, 1.0, OPENING_STEPS)[:, None] * (ends[1] - ends[0])
        rests = [self.hand.configuration(dict(zip(names, each, strict=True))) for each in every.tolist()]
        q = self.limb.q(np.repeat(x[None], OPENING_STEPS, axis=0), np.stack(rests))
        return self.world.contact(q, rules or self.rules) is None

    def _by(
        self, roads: Roads, left: Array, problem: Problem, rng: np.random.Generator
    ) -> Approach | Blocked:
        """The same, the arm carried as it is on these roads."""
        self._contact_there, failed = None, Blocked("park")
        shut: list[Array] = []
        for back in self._places(left[-1], problem, roads.posture):
            outcome = self._straight(back, left, roads, rng)
            if isinstance(outcome, Approach) or self.late():
                return outcome
            failed = outcome
            if outcome.stage == "drive":
                shut.append(back)
        blocked: list[Blocked] = []
        for back in shut[:PLACES]:
            outcome = self._around(back, left, roads, rng)
            if isinstance(outcome, Approach) or self.late():
                return outcome
            blocked.append(outcome)
        failed = min(blocked, key=lambda one: one.stage != "drive", default=failed)
        return failed if failed.stage != "park" else Blocked("park", self._contact_there)

    def _leave(self, holding: Holding, problem: Problem) -> Array | Blocked:
        """Waypoints from the grasp backwards, shape (PULLS + 1, n); the hand is as open from now on."""
        self.rest = self.hand.configuration(dict(holding.grasp.opened))
        r, p = holding.grasp.tool(problem.handle_r[0], problem.handle_p[0])
        aside = self._aside(holding, problem, r, p)
        if isinstance(aside, Blocked):
            return aside
        p, contact = p if len(aside) == 1 else self.limb.tool(aside[-1])[1], None
        for far, angle in product(self.backs_off, ASLANT.tolist()):
            away = np.sin(angle) * r[:, 2] - np.cos(angle) * r[:, 0]
            for xs in self._leaves(aside[-1], r, p, away, far):
                last = self._contact(xs)
                if last is None:
                    return np.concatenate([aside[:-1], xs])
                contact = contact or last
        return Blocked("leave", contact)

    def _aside(self, holding: Holding, problem: Problem, r: Array, p: Array) -> Array | Blocked:
        """Waypoints from the grasp until a finger that stands still is off the bar, shape (1 + K, n)."""
        here, way = holding.xs[:1], holding.grasp.aside
        if way is None:
            return here
        steps = np.arange(1, PULLS + 1)[:, None] / PULLS
        target = np.repeat(r[None], PULLS, axis=0), p + steps * (problem.handle_r[0] @ way)
        rules = touching(self.world, self.limb, self.rules, (problem.mechanics.container.handle,))
        contact = None
        for base in bases(self.drive, turning=False):
            path = track(self.limb, here[0], target, base, inside(self.limb))
            if path is not None:
                contact = self._contact(path, rules)
                if contact is None:
                    return np.concatenate([here, path])
        return Blocked("leave", contact)

    def _leaves(self, x0: Array, r: Array, p: Array, away: Array, far: float):  # noqa: ANN202 - iterator of arrays
        if self.drive is Drive.OMNI and abs(away[2]) < 1e-3:
            end = x0.copy()
            end[:2] += far * away[:2]
            yield np.concatenate([x0[None], between(x0, end, PULLS)])
        target_p = p + far * np.arange(1, PULLS + 1)[:, None] / PULLS * away
        target = np.repeat(r[None], PULLS, axis=0), target_p
        for base in bases(self.drive, turning=False):
            path = track(self.limb, x0, target, base, inside(self.limb))
            if path is not None:
                yield np.concatenate([x0[None], path])

    def _places(self, x: Array, problem: Problem, folded: Array) -> Iterator[Array]:
        """Configurations with the base backed off, the arm still, with room for the arm `folded`."""
        if self._folds(x, folded):
            yield x
        for way in self._ways(x, problem):
            last = x
            for distance in BACK_OFFS:
                back = x.copy()
                back[:2] += distance * way
                contact = self._contact(np.stack([last, back]))
                if contact is not None:
                    self._contact_there = contact
                    break
                if self._folds(back, folded):
                    yield back
                last = back

    def _folds(self, x: Array, folded: Array) -> bool:
        folded = folded.copy()
        folded[BASE] = x[BASE]
        contact = self.world.contact(self.limb.q(folded, self.rest)[None], self.rules)
        self._contact_there = contact or self._contact_there
        return contact is None

    def _ways(self, x: Array, problem: Problem) -> list[Array]:
        """Directions in which the base may back off, unit vectors (2,), the likeliest first."""
        heading = np.array([np.cos(x[2]), np.sin(x[2])])
        if self.drive is Drive.FIXED:
            return []
        if self.drive is Drive.DIFFERENTIAL:
            return [-heading, heading]
        out = np.arctan2(problem.outward[1], problem.outward[0])
        turns = out + np.radians([0, 45, -45, 90, -90, 135, -135, 180])
        return [-heading, *np.stack([np.cos(turns), np.sin(turns)], axis=1)]

    def _straight(
        self, back: Array, left: Array, roads: Roads, rng: np.random.Generator
    ) -> Approach | Blocked:
        """The rest of the way where the arm folds at `back`, if a straight drive leads there."""
        road = self._road(back, roads.straight)
        if road is None:
            return Blocked("drive")
        arm = self._arm(back, roads, rng)
        return arm if isinstance(arm, Blocked) else joined(road, arm, left, roads.posture)

    def _around(self, back: Array, left: Array, roads: Roads, rng: np.random.Generator) -> Approach | Blocked:
        """The same where none does. Its drive takes longest to find, so that is looked for last."""
        shut = roads.lattice.shut_in(back[BASE])
        arm = Blocked("drive") if shut else self._arm(back, roads, rng)
        if isinstance(arm, Blocked):
            return arm
        road = self._road(back, partial(roads.around, late=self.late))
        return Blocked("drive") if road is None else joined(road, arm, left, roads.posture)

    def _arm(self, back: Array, roads: Roads, rng: np.random.Generator) -> tuple[Array, Array] | Blocked:
        """The arm's ways while the base stands: until carried, at the start, and from then, at `back`."""
        tucked = self._tuck(roads, rng)
        if tucked is None:
            return Blocked("fold")
        folded = roads.posture.copy()
        folded[BASE] = back[BASE]
        straight = np.stack([folded, back])
        if self._contact(straight) is None:
            return tucked, straight
        space = ArmSpace(self.world, self.limb, self.rules, self.rest, self.weight, back[BASE])
        corners = connect(space, (folded, back), rng, self.samples, self.late)
        contact = None if corners is None else self._contact(corners)
        return Blocked("fold", contact) if corners is None or contact is not None else (tucked, corners)

    def _tuck(self, roads: Roads, rng: np.random.Generator) -> Array | None:
        """The arm's way at the start pose from parked until it is carried, without its end, shape (K, n)."""
        if roads is self.roads:
            return np.empty((0, len(self.weight)))
        if not self._tucked:
            space = ArmSpace(self.world, self.limb, self.rules, self.limb.rest, self.weight, self.start)
            ends = self.limb.parked.copy(), roads.posture.copy()
            for one in ends:
                one[BASE] = self.start
            self._tucked = (connect(space, ends, rng, ARM_ITERATIONS, self.late),)
        return None if self._tucked[0] is None else self._tucked[0][:-1]

    def _contact(self, xs: Array, rules: Rules | None = None) -> Contact | None:
        """A contact along straight segments through xs, at the distances of the open hand or at these."""
        parts = [xs[:1]]
        for one, other in pairwise(xs):
            pieces = int(np.ceil(float(np.abs(other - one) @ self.weight) / FINE_STEP)) + 1
            parts.append(between(one, other, pieces))
        return self.world.contact(self.limb.q(np.concatenate(parts), self.rest), rules or self.rules)

    def _road(self, back: Array, drive: Callable[[Array, Array], Array | None]) -> Array | None:
        """Corners of the drive from the start to where the arm folds (its yaw up to whole turns), (K, 3)."""
        goal = back[BASE].copy()
        goal[2] += 2 * np.pi * np.round((self.start[2] - goal[2]) / (2 * np.pi))
        if np.allclose(goal, self.start, atol=1e-9):
            return np.stack([self.start, self.start])
        return None if self.drive is Drive.FIXED else drive(self.start, goal)
