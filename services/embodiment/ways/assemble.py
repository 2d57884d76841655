"""Paths become a BodyMotion: phases in order, each from rest to rest."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sdt_kg.iri import Iri, joint_iri, local_name
from sdt_kg.motion import BodyMotion, Motion
from services.embodiment.body.limb import BASE, Limb, rate_limits
from services.embodiment.body.world import World
from services.embodiment.hold.holding import Holding, Problem
from services.embodiment.ways import timing
from services.embodiment.ways.bound import Bound, Timed
from services.embodiment.ways.spaces import reaches
from services.embodiment.ways.timing import Followed
from services.embodiment.ways.way import Approach

Array = NDArray[np.float64]

SPACING = 0.08  # [m] that any point moves between samples on the way to the handle
FINGER_REACH = 0.1  # [m] of a finger, for the number of samples only
FOLLOW_SAMPLES = 121
REACH_SAMPLES = 25


@dataclass(frozen=True, slots=True, eq=False)
class Assembled:
    """A body motion with the container's motion as it is executed in it.

    Attributes:
        excess: Largest ratios of velocity and acceleration to their limits while following.
        outside: How far a variable leaves its position limits on the way [rad or m].
    """

    body: BodyMotion
    motion: Motion
    excess: tuple[float, float]
    outside: float


class Assembler:
    """Body motions of one limb: y = [x, positions of the finger joints]."""

    def __init__(self, world: World, limb: Limb, robot: Iri, problem: Problem, motion: Motion) -> None:
        self.world, self.limb, self.robot, self.problem, self.motion = world, limb, robot, problem, motion
        scene = world.scene
        name = scene.robot.mechanism.name
        fingers = limb.gripper.finger_joints
        self.fingers = [scene.coordinate[joint_iri(name, one.joint)] for one in fingers]
        self.open = np.array([one.open for one in fingers])
        parked = scene.q((0.0, 0.0, 0.0), {})
        self.parked = parked[self.fingers]
        self.body_bound = Bound(limb.velocity, limb.acceleration, limb.lower, limb.upper, limb.gain)
        self.bound = self.body_bound.beside(self._finger_bound())
        self.reach = np.append(reaches(limb), np.full(len(fingers), FINGER_REACH))
        self.reach[BASE] = 1.0

    def _finger_bound(self) -> Bound:
        scene = self.world.scene
        units = np.zeros((len(self.fingers), scene.model.nq))
        units[np.arange(len(self.fingers)), self.fingers] = 1.0
        velocity, acceleration, gain = rate_limits(scene, scene.coupling.rates(units).T)
        own = scene.bounds.lower[self.fingers], scene.bounds.upper[self.fingers]
        return Bound(velocity, acceleration, *own, gain)

    def assemble(self, approach: Approach, holding: Holding, begins: Array | None = None) -> Assembled:
        """The whole motion; it begins with the fingers parked, or at these positions, near the handle."""
        turns = approach.reach[-1, 2] - holding.xs[0, 2]
        xs = holding.xs.copy()
        xs[:, 2] += turns
        closed = np.array([value for _, value in holding.grasp.fingers])
        opened = np.array([value for _, value in holding.grasp.opened])
        follow, values, rates, excess = self._follow(xs)
        reach = self._reach(approach)
        phases = [
            ("drive", self._drive(approach, opened, begins=begins)),
            ("approach", self._with_fingers(timing.joined([self._raised(approach), reach]), opened)),
            ("grasp", self._grasp(xs[0], opened, closed, follow.x[0])),
            ("follow", self._with_fingers(follow, closed)),
        ]
        whole, marks = _chained(phases)
        still = len(whole.times) - len(values)
        container = np.concatenate([np.full(still, values[0]), values])
        speed = np.concatenate([np.zeros(still), rates])
        body = self._body(whole, marks, container, speed)
        of, timed = self.motion.of, self.motion.timed
        executed = Motion(of, follow.times, values[:, None], timed, rates[:, None])
        outside = max(map(self._outside, (reach, follow)))
        return Assembled(body, executed, excess, outside)

    def stays(self, approach: Approach) -> bool:
        """Whether variables keep their position limits in the last centimetres."""
        return self._outside(self._reach(approach)) <= 0

    def _outside(self, timed: Timed) -> float:
        return timing.outside(timed, self.limb.lower, self.limb.upper)

    def retreat(self, approach: Approach, holding: Holding, *, home: bool = True) -> BodyMotion:
        """From a hold back to parked at the start, or only away, as an approach came; the container stays."""
        x = holding.xs[0].copy()
        x[2] = approach.reach[-1, 2]
        closed = np.array([value for _, value in holding.grasp.fingers])
        opened = np.array([value for _, value in holding.grasp.opened])
        leave = [self._reach(approach, back=True), *([self._raised(approach, back=True)] if home else [])]
        phases = [
            ("let go", self._grasp(x, closed, opened)),
            ("leave", self._with_fingers(timing.joined(leave), opened)),
            *([("return", self._drive(approach, opened, back=True))] if home else []),
        ]
        whole, marks = _chained(phases)
        values = np.full(len(whole.times), self.problem.values[0])
        return self._body(whole, marks, values, np.zeros_like(values))

    def _with_fingers(self, timed: Timed, fingers: Array) -> Timed:
        count = len(timed.times)
        x = np.hstack([timed.x, np.repeat(fingers[None], count, axis=0)])
        return Timed(timed.times, x, np.hstack([timed.v, np.zeros((count, len(fingers)))]))

    def _drive(
        self, approach: Approach, opened: Array, *, back: bool = False, begins: Array | None = None
    ) -> Timed:
        ways = approach.drive
        opening = np.append(ways[0], self.parked if begins is None else begins)[None]
        corners = np.hstack([ways, np.repeat(self.open[None], len(ways), axis=0)])
        narrowed = np.append(ways[-1], opened)[None]
        every = np.concatenate([opening, *([corners] if begins is None else []), narrowed])
        return timing.along(every[::-1] if back else every, self.bound, self.reach, SPACING)

    def _raised(self, approach: Approach, *, back: bool = False) -> Timed:
        corners = np.concatenate([approach.raise_arm, approach.drive_in])
        reach = self.reach[: corners.shape[1]]
        return timing.along(corners[::-1] if back else corners, self.body_bound, reach, SPACING)

    def _reach(self, approach: Approach, *, back: bool = False) -> Timed:
        way = approach.reach[::-1] if back else approach.reach
        path = Followed.through(np.linspace(0.0, 1.0, len(way)), way)
        return timing.fastest(path, self.body_bound, (np.inf, np.inf), REACH_SAMPLES)[0]

    def _grasp(self, x: Array, opened: Array, closed: Array, begins: Array | None = None) -> Timed:
        """Fingers close, or open, at x; or where the motion begins, if that is beside the kitchen's state."""
        at = x if begins is None else begins
        corners = np.stack([np.append(x, opened), np.append(at, opened), np.append(at, closed)])
        return timing.along(corners, self.bound, self.reach, SPACING)

    def _follow(self, xs: Array) -> tuple[Timed, Array, Array, tuple[float, float]]:
        """(robot, container's values, their rates, ratios to the limits)."""
        path = Followed.through(self.problem.values, xs)
        container = self.problem.mechanics.container
        most = container.velocity, container.acceleration
        motion = self.motion
        if not motion.timed and not timing.turns_back(motion):
            samples = max(FOLLOW_SAMPLES, 2 * len(xs) - 1)
            timed, values, rates = timing.fastest(path, self.body_bound, most, samples)
            return timed, values, rates, timing.excess(timed, self.body_bound)
        if not motion.timed:  # what counts is its way, from where the kitchen is
            motion = replace(motion, values=np.vstack((self.problem.values[0], motion.values[1:])))
        times, values, rates = timing.as_timed(motion, FOLLOW_SAMPLES)
        timed = timing.at_values(path, times, values, rates)
        if not motion.timed:
            timed, values, rates = timing.stretched(timed, self.body_bound, (values, rates), most)
        return timed, values, rates, timing.excess(timed, self.body_bound)

    def _body(
        self, whole: Timed, marks: tuple[tuple[str, int], ...], values: Array, rates: Array
    ) -> BodyMotion:
        limb, scene = self.limb, self.world.scene
        n = len(limb.lower)
        q = limb.q(whole.x[:, :n])
        v = whole.v[:, :n] @ limb.expansion.T
        q[:, self.fingers], v[:, self.fingers] = whole.x[:, n:], whole.v[:, n:]
        q, v = scene.coupling.positions(q), scene.coupling.rates(v)
        listed = np.flatnonzero(np.abs(limb.expansion[:, 3:]).any(axis=1)).tolist()
        listed = sorted({*listed, *self.fingers})
        mechanics = self.problem.mechanics
        return BodyMotion(
            self.robot,
            limb.gripper.name,
            tuple(local_name(scene.names[k]) for k in listed),
            whole.times,
            whole.x[:, BASE],
            q[:, listed],
            v[:, listed],
            whole.v[:, BASE],
            mechanics.parts,
            mechanics.positions(values),
            mechanics.rates(rates),
            marks,
        )


def _chained(phases: list[tuple[str, Timed]]) -> tuple[Timed, tuple[tuple[str, int], ...]]:
    """The phases joined, and the first sample of each."""
    marks, count = [], 0
    for name, part in phases:
        marks.append((name, count))
        count += len(part.times) - 1
    return timing.joined([part for _, part in phases]), tuple(marks)
