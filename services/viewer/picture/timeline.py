"""A motion as a film: its phases, and where everything is at a time."""

from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline, CubicSpline

from sdt_kg.entities.coupling import Coupling
from sdt_kg.iri import Iri
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.state import State

WHOLE = "whole motion"
"""Name of the phase of a body motion that names none."""
KITCHEN_ALONE = "container alone, no robot"


@dataclass(frozen=True, slots=True)
class Phase:
    """A named part of the motion, [start, end] in s."""

    name: str
    start: float
    end: float


@dataclass(frozen=True, slots=True)
class Posture:
    """Where everything is at one time.

    Attributes:
        base: x, y [m], yaw [rad]; None: the robot does not take part.
        robot: Joint name → position [rad or m]; joints that are not listed are parked.
        kitchen: Joint IRI → position, of every movable joint.
    """

    base: tuple[float, float, float] | None
    robot: dict[str, float]
    kitchen: dict[Iri, float]


class Timeline:
    """A body motion, or where there is none the container's motion, in time.

    Attributes:
        duration: [s].
        phases: In order, without gaps.
    """

    def __init__(self, motion: BodyMotion | Motion, state: State, coupling: Coupling) -> None:
        self._state, self._coupling = state, coupling
        self._first = float(motion.times[0])
        self.duration = float(motion.times[-1]) - self._first
        self._robot: tuple[str, ...] = ()
        self._base: CubicHermiteSpline | None = None
        if isinstance(motion, BodyMotion):
            self._robot, self._kitchen = motion.joints, motion.kitchen_joints
            self._base = CubicHermiteSpline(motion.times, motion.base, motion.base_v)
            self._q = CubicHermiteSpline(motion.times, motion.q, motion.v)
            still = np.zeros((len(motion.times), 0))
            listed = (motion.kitchen_q, motion.kitchen_v) if motion.kitchen_joints else (still, still)
            self._kitchen_q = CubicHermiteSpline(motion.times, *listed)
            self.phases = self._phases(motion)
        else:
            assert not motion.is_poses, "Causes answers with positions of the joint"
            self._kitchen = (motion.of,)
            rates = motion.velocities
            self._kitchen_q = (
                CubicSpline(motion.times, motion.values, bc_type="clamped")
                if rates is None
                else CubicHermiteSpline(motion.times, motion.values, rates)
            )
            self.phases = (Phase(KITCHEN_ALONE, 0.0, self.duration),)

    def _phases(self, motion: BodyMotion) -> tuple[Phase, ...]:
        named = motion.phases or ((WHOLE, 0),)
        starts = [float(motion.times[min(first, len(motion.times) - 1)]) - self._first for _, first in named]
        ends = [*starts[1:], self.duration]
        return tuple(
            Phase(name, start, end) for (name, _), start, end in zip(named, starts, ends, strict=True)
        )

    def phase(self, time: float) -> Phase:
        """The phase that a time [s] lies in; a bound belongs to the later one."""
        return self.phases[max(bisect_right([each.start for each in self.phases], time) - 1, 0)]

    def at(self, time: float) -> Posture:
        """Where everything is, `time` s after the motion begins."""
        t = self._first + float(np.clip(time, 0.0, self.duration))
        changes = dict(zip(self._kitchen, map(float, self._kitchen_q(t)), strict=True))
        kitchen = followed(self._coupling, self._state, changes)
        if self._base is None:
            return Posture(None, {}, kitchen)
        x, y, yaw = map(float, self._base(t))
        return Posture((x, y, yaw), dict(zip(self._robot, map(float, self._q(t)), strict=True)), kitchen)

    def since_start(self, time: float) -> float:
        """A time of the motion's own clock, as evidence has it, in s after it begins."""
        return time - self._first


def followed(
    coupling: Coupling, state: Mapping[Iri, float], changes: Mapping[Iri, float]
) -> dict[Iri, float]:
    """Positions of all kitchen joints after these changes, also beyond limits: wrong motions are shown."""
    whole = dict(state)
    for joint, position in changes.items():
        follower = coupling.followers.get(joint)
        if follower is None:
            whole[joint] = position
        elif follower.active not in changes and follower.multiplier:
            whole[follower.active] = (position - follower.offset) / follower.multiplier
    for joint, follower in coupling.followers.items():
        whole[joint] = follower.multiplier * whole[follower.active] + follower.offset
    return whole
