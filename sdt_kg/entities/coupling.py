"""Coupling: how positions of a kitchen's joints depend on each other, and which are possible."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final

from sdt_kg.errors import StateError, UnknownEntityError
from sdt_kg.iri import Iri, joint_iri, local_name
from sdt_kg.mechanism import Joint, JointType, Mechanism
from sdt_kg.numbers import told_apart
from sdt_kg.state import State

LIMIT_TOLERANCE: Final = 1e-9
"""[rad or m] Rounding of a limit times a multiplier; below any encoder's resolution."""


@dataclass(frozen=True, slots=True)
class _Follower:
    """A mimicking joint: position = multiplier · position of `active` + offset."""

    active: Iri
    multiplier: float
    offset: float


@dataclass(frozen=True, slots=True)
class Contradiction:
    """A joint that is beyond a limit of its own wherever another, with which it moves, keeps its limits.

    Attributes:
        other: Which of those; the joint itself, where its lower limit is above its upper one.
        limit: The joint's own [rad or m].
        reached: How near it comes to that [rad or m].
    """

    joint: Iri
    other: Iri
    limit: float
    reached: float

    @property
    def is_lower(self) -> bool:
        """Whether it is the joint's lower limit."""
        return self.limit > self.reached


@dataclass(frozen=True)
class Coupling:
    """Movable joints of one mechanism."""

    joints: Mapping[Iri, Joint]
    followers: Mapping[Iri, _Follower]

    @staticmethod
    def of(mechanism: Mechanism) -> "Coupling":
        """Coupling of the mechanism's movable joints."""
        model = mechanism.name
        movable = [joint for joint in mechanism.joints if joint.type is not JointType.FIXED]
        return Coupling(
            {joint_iri(model, joint.name): joint for joint in movable},
            {
                joint_iri(model, joint.name): _Follower(
                    joint_iri(model, joint.mimic.joint), joint.mimic.multiplier, joint.mimic.offset
                )
                for joint in movable
                if joint.mimic is not None
            },
        )

    def start(self) -> State:
        """Every joint at 0 where its limits allow that, else at its lower limit; mimicking ones follow.

        Where those would leave their limits, the joint which they mimic is as much elsewhere as that asks.
        """
        free = {iri: self._at_first(iri) for iri in self.joints if iri not in self.followers}
        return State.of(self._complete(free))

    def _at_first(self, active: Iri) -> float:
        """Where a joint starts that mimics none: where it alone would, if no position suits all."""
        limits = self.joints[active].limits
        alone = 0.0 if limits.lower <= 0 <= limits.upper else limits.lower
        low, high, fits = limits.lower, limits.upper, True
        for iri, each in self.followers.items():
            if each.active == active and each.multiplier != 0:
                own = self.joints[iri].limits
                one, other = sorted((end - each.offset) / each.multiplier for end in (own.lower, own.upper))
                slack = LIMIT_TOLERANCE / abs(each.multiplier)
                fits &= one - slack <= alone <= other + slack
                low, high = max(low, one), min(high, other)
        return alone if fits or low - high > LIMIT_TOLERANCE else min(max(alone, low), high)

    @cached_property
    def contradictions(self) -> tuple[Contradiction, ...]:
        """Of joints that move together and have no position that keeps all their limits, one pair each."""
        found = (self._contradiction(iri) for iri in self.joints if iri not in self.followers)
        return tuple(sorted((each for each in found if each is not None), key=lambda each: each.joint))

    def _contradiction(self, active: Iri) -> Contradiction | None:
        """The pair of a group whose intervals for the active joint are farthest apart, if these are so."""
        group = {active: _Follower(active, 1.0, 0.0)}
        group |= {iri: each for iri, each in self.followers.items() if each.active == active}
        ends = [(*self._ends(iri, each), iri) for iri, each in group.items()]
        (low, _, one), (_, high, other) = max(ends), min(ends, key=lambda each: each[1])
        joint, beside, own_end, at = (other, one, high, low) if one == active else (one, other, low, high)
        own = group[joint]
        limit, reached = (own.multiplier * end + own.offset for end in (own_end, at))
        if low <= high or abs(limit - reached) <= LIMIT_TOLERANCE:
            return None
        return Contradiction(joint, beside, limit, reached)

    def _ends(self, iri: Iri, follower: _Follower) -> tuple[float, float]:
        """Between which positions of the active joint a mimicking one keeps its limits."""
        limits = self.joints[iri].limits
        if follower.multiplier == 0:
            return -math.inf, math.inf
        one, other = ((end - follower.offset) / follower.multiplier for end in (limits.lower, limits.upper))
        return min(one, other), max(one, other)

    def moved(self, state: State, changes: Mapping[Iri, float]) -> State:
        """The state with these joints elsewhere.

        A mimicking joint may be given: where its active joint is not, that one is set; where both
        are, they must agree. A value equal to the present one is no change.

        Raises:
            UnknownEntityError: No such movable joint.
            StateError: Not a number, outside limits, or two values that contradict each other.
        """
        self._check(changes)
        now = dict(state.positions)
        changed = {joint: float(value) for joint, value in changes.items() if value != now[joint]}
        for joint, value in list(changed.items()):
            follower = self.followers.get(joint)
            if follower is not None and follower.active not in changed and follower.multiplier != 0:
                changed[follower.active] = (value - follower.offset) / follower.multiplier
        free = {iri: changed.get(iri, now[iri]) for iri in self.joints if iri not in self.followers}
        complete = self._complete(free)
        for joint, value in changed.items():
            if abs(complete[joint] - value) > LIMIT_TOLERANCE:
                active = local_name(self.followers[joint].active)
                raise StateError(
                    f"joint '{local_name(joint)}' at {value:g} contradicts '{active}', which it mimics",
                    allowed=f"{complete[joint]:g} with that one at {free[self.followers[joint].active]:g}",
                    remedy="give one of the two",
                )
        for joint in complete:
            if complete[joint] != now[joint]:  # what stays is where it was, and nobody moved it there
                self._check_limits(joint, complete[joint])
        return State.of(complete)

    def together(self, joint: Iri) -> dict[Iri, tuple[float, float]]:
        """Ratio and offset of every other joint that moves with this one: q = ratio · q_this + offset."""
        own = self.followers.get(joint, _Follower(joint, 1.0, 0.0))
        others = {own.active: _Follower(own.active, 1.0, 0.0), **self.followers}
        return {
            iri: (
                each.multiplier / own.multiplier,
                each.offset - each.multiplier / own.multiplier * own.offset,
            )
            for iri, each in others.items()
            if iri != joint and each.active == own.active and each.multiplier != 0 != own.multiplier
        }

    def _complete(self, free: Mapping[Iri, float]) -> dict[Iri, float]:
        followed = {
            iri: follower.multiplier * free[follower.active] + follower.offset
            for iri, follower in self.followers.items()
        }
        return {**free, **followed}

    def _check(self, changes: Mapping[Iri, float]) -> None:
        for joint, value in changes.items():
            if joint not in self.joints:
                raise UnknownEntityError("joint", local_name(joint), map(local_name, self.joints))
            if not math.isfinite(value):
                raise StateError(f"joint '{local_name(joint)}' at {value}", allowed="a finite number")

    def _check_limits(self, joint: Iri, value: float) -> None:
        limits, turned = self.joints[joint].limits, self.joints[joint].turned
        if limits.lower - LIMIT_TOLERANCE <= value <= limits.upper + LIMIT_TOLERANCE:
            return
        unit = "m" if self.joints[joint].type is JointType.PRISMATIC else "rad"
        beyond = value > limits.upper
        at, end = told_apart(value, limits.upper if beyond else limits.lower, 6)
        lower, upper = (f"{limits.lower:g}", end) if beyond else (end, f"{limits.upper:g}")
        raise StateError(
            f"joint '{local_name(joint)}' at {at} {unit} is outside its limits",
            allowed=f"{lower} to {upper} {unit}",
            remedy=f"in its file it has {turned}" if turned and value < 0 else "",
        )
