"""Motions in holds that a descent finds, put together, tried where the base stands.

Each hold is kept over a span of the container's way. As few as overlap from its first value to its last are
taken, each let go where it and the next can be left; then all is as for several holds. Planning keeps smaller
distances here than elsewhere: what fits by less than a millimetre is what the other stages miss.
"""

import time
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from services.embodiment.body.demands import Margins
from services.embodiment.descent.changes import Changes
from services.embodiment.descent.depths import make_depths, unmoved
from services.embodiment.descent.pinch import Pose, grips
from services.embodiment.descent.posture import make_descent
from services.embodiment.descent.row import Part, cover, plans
from services.embodiment.descent.spans import PIECES, Hold, Spans
from services.embodiment.hold.fit import inward
from services.embodiment.hold.holding import WAYPOINTS
from services.embodiment.hold.parts import parts
from services.embodiment.search.attempt import Attempt
from services.embodiment.search.leg import Leg
from services.embodiment.search.plan import Planner
from services.embodiment.search.planned import Lack, Planned
from services.embodiment.search.several import Legs
from services.embodiment.setting import Setting
from services.embodiment.ways.roads import Known
from services.embodiment.ways.timing import farthest, turns_back

FINE = Margins(0.00025, 0.00025, 0.0001)
"""[m] that planning keeps here beyond what certification demands: half of what a descent does."""
LEAVES = 0.1, 0.05, 0.025
"""[m] The open hand backs off from the bar, one after the other where there is no room."""
STARTS = 240
"""[1] Descents in a turn."""

FINER = WAYPOINTS, 2 * WAYPOINTS - 1, 4 * WAYPOINTS - 3
"""[1] Waypoints of a part, one after the other: a spline through few may touch something between them."""

Array = NDArray[np.float64]
Ends = tuple[float, float]


class Descended:
    """Plans in holds that a descent finds, of one gripper and the other, or of both in turn."""

    def __init__(self, planner: Planner) -> None:
        self._planner = planner
        self._each: list[_Search] = []

    def plans(self, turns: int, idle: int) -> Iterator[Planned]:
        """Those that are found while the budget lasts.

        Args:
            turns: Of each gripper, at most.
            idle: In a row, of which no hold reaches a value that none did: then a gripper is out.
        """
        self._each = self._each or self._begun()
        late = self._planner.late
        for _ in range(turns):
            for one in self._each:
                if late():
                    return
                if one.contact is None and one.idle < idle:
                    yield from one.turn()
            yield from self._taken_over([one for one in self._each if one.contact is None])

    def _taken_over(self, hands: "list[_Search]") -> Iterator[Planned]:
        """Plans in which hands take over from each other, once holds reach everywhere, but of none alone."""
        if not hands or any(one.spans.cover().all() for one in hands) or not cover(hands).all():
            return
        for one in hands:
            one.idle = 0
        yield from plans(hands, self._planner.late)

    def _begun(self) -> "list[_Search]":
        """Of each gripper, first who has followed the handle farthest; none where times are required."""
        planner, setting, start = self._planner, self._planner.setting, self._planner.mechanics.start
        straight = not setting.motion.timed and not turns_back(setting.motion)
        fine = replace(setting, kits=replace(setting.kits, margins=FINE), roads=Known())
        ends = start, farthest(setting.motion, start, setting.container)
        order = sorted(planner.attempts if straight else (), key=lambda one: -one.searcher.tally.came)
        return [_Search(planner, fine, one.limb.gripper.name, ends) for one in order]

    def lacking(self) -> Iterator[Lack]:
        """Where grippers have no hold, of those for which some were looked for, or looking is in vain."""
        for one in self._each:
            if one.contact is not None or one.spans.descent.starts > 0:
                yield one.lack()


class _Search:
    """The search with one gripper.

    Attributes:
        spans: The holds that were found.
        changes: Ways to them, and from one to another.
        idle: The last turns of which no hold reached a value that none did before.
        contact: What is too near wherever the arm is, so that going on is in vain.
    """

    def __init__(self, whole: Planner, setting: Setting, gripper: str, ends: Ends) -> None:
        self._whole, self._ends, self._gripper = whole, ends, gripper
        self._planner = Planner(setting, whole.deadline, whole.seed, whole.spent, only=gripper)
        self._legs = Legs(self._planner, gripper, ends[1])
        self.idle = 0
        self._attempts: dict[int, Attempt] = {}
        self._attempt = self._of(self._planner)
        self.spans = self._spans(self._attempt)
        self.changes = Changes(self.spans.depths.hand, self._at, self._planner.late)
        mechanics, start = self._planner.mechanics, np.array(setting.start)
        self.contact = unmoved(self._attempt.limb, mechanics, start, self.spans.values)
        whole.parts.append(self._planner)

    def lack(self) -> Lack:
        """The first values that no hold reaches, or the first at which it is in vain to look for one."""
        values = self.spans.values
        if self.contact is not None:
            at = float(values[self.contact.index])
            return Lack(self._gripper, (at, at), shapes=self.contact.shapes)
        none = np.flatnonzero(self.spans.cover() == 0).tolist()
        if not none:
            return Lack(self._gripper, self._ends, held=True)
        last = next(k for k in none if k + 1 not in none)
        return Lack(self._gripper, (float(values[none[0]]), float(values[last])))

    def turn(self) -> Iterator[Planned]:
        """Plans in the holds that are found in one turn more, as soon as some reach everywhere."""
        spans, late, before = self.spans, self._planner.late, np.count_nonzero(self.spans.cover())
        spans.descent.scant = self.idle > 0
        self.changes.turn()
        until = spans.descent.starts + STARTS
        while spans.descent.starts < until and not late():
            at = time.perf_counter()
            spans.grow(until - spans.descent.starts, late)
            self._attempt.searcher.tally.seeds = spans.descent.starts
            self._planner.spent("descent", at)
            for planned in plans([self], late):
                before = 0  # others may be certified: it goes on
                yield planned
        yield from self._come_to()
        farther = np.count_nonzero(spans.cover()) > before
        self.idle = 0 if farther or spans.cover().all() else self.idle + 1

    def _come_to(self) -> Iterator[Planned]:
        """Plans in holds that last all the way, to some of which ways are looked for longer."""
        whole = [one for one in self.spans.holds if one.first == 0 and one.last == PIECES]
        for hold in whole:
            if not self._planner.late() and self.changes.longer(hold):
                yield from plans([self], self._planner.late)

    def _at(self, index: int) -> Attempt:
        """The search with the container at a value."""
        if index not in self._attempts:
            at = float(self.spans.values[index]), self._ends[1] if index < PIECES else self._ends[0]
            self._attempts[index] = self._of(self._legs.at(at, self._planner.deadline))
        return self._attempts[index]

    def _of(self, planner: Planner) -> Attempt:
        """The one attempt of who plans with one gripper."""
        attempt = planner.attempt(next(iter(planner.kits())))
        assert attempt is not None, "the handle was held"
        attempt.approacher.backs_off = LEAVES
        planner.attempts.append(attempt)
        return attempt

    def leg(self, part: Part, end: int, *, parks: bool) -> Leg | None:
        """One part of the way, in one hold."""
        hold, begin, come = part.hold, part.begin, part.come
        values = float(self.spans.values[begin]), float(self.spans.values[end])
        planner = self._legs.at(values, self._planner.deadline)
        self._whole.parts.append(planner)
        attempt, changes = self._of(planner), self.changes
        back = changes.near(hold, begin) if come else changes.back(hold, begin)
        assert back is not None, "the way begins where one comes to it"
        xs, value = self._followed(attempt, hold)
        if value is not None:
            self.spans.cut(hold, value)
            return None
        xs[0] = back.holding.xs[0]  # to within what a hold may be off
        holding = replace(back.holding, limb=attempt.limb, xs=xs)
        if not attempt.searcher.free(xs, holding.rest):
            return None
        if come:
            planned = planner.approached(attempt, holding, come.approach, come.begins)
        else:
            by = back.approach, None
            planned = next(filter(None, (planner.approached(attempt, holding, one) for one in by)), None)
        if planned is None:
            return None
        left = changes.back if parks else changes.near
        return Leg(planned, None if end == PIECES else left(hold, end), onwards=come is not None)

    def _followed(self, attempt: Attempt, hold: Hold) -> tuple[Array, float | None]:
        """Postures that keep a hold at as many waypoints as a spline needs; where it is not free with all."""
        for waypoints in FINER:
            attempt.through(waypoints)
            values = attempt.searcher.problem.values
            xs = self.spans.between(hold, values)
            value = self.spans.amid(hold, values, xs)
            if value is None:
                break
        return xs, value

    def _spans(self, attempt: Attempt) -> Spans:
        """The holds of the gripper: none as yet."""
        setting, mechanics, limb = self._planner.setting, self._planner.mechanics, attempt.limb
        start, bar = np.array(setting.start), attempt.fitter.bar
        depths = make_depths(setting.world, limb, attempt.fitter.hand, mechanics, start)
        held = grips(parts(setting.world, setting.container.handle, bar))
        handle = _handle(self._planner, attempt)
        rng = np.random.default_rng(self._planner.seed)
        descent = make_descent(depths, held, handle, start, rng, inward(attempt.fitter.facing))
        return Spans(descent, np.linspace(*self._ends, PIECES + 1))


def _handle(planner: Planner, attempt: Attempt) -> Callable[[float], Pose]:
    """World pose of a handle's joint at a value of the container."""
    q, joint = attempt.limb.q(attempt.limb.parked), attempt.fitter.bar.joint

    def at(value: float) -> Pose:
        r, p = planner.mechanics.handle_poses(q, joint, np.array([value]))
        return r[0], p[0]

    return at
