"""Parts of a way in several holds, and one motion of them.

A part begins parked, or where the one before is left.
"""

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sdt_kg.iri import joint_iri
from sdt_kg.motion import BodyMotion
from services.embodiment.body.limb import BASE
from services.embodiment.hold.grasp import Positions
from services.embodiment.hold.holding import Holding
from services.embodiment.search.attempt import Attempt
from services.embodiment.search.planned import Planned
from services.embodiment.ways.approach import ARM_ITERATIONS
from services.embodiment.ways.paths import connect
from services.embodiment.ways.spaces import ArmSpace
from services.embodiment.ways.way import Approach
from services.physics.model import Scene

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Leg:
    """One part of the way to its end, from parked or from where the part before is left.

    Attributes:
        back: How it is left there; None at the end of all.
        onwards: Whether it begins there.
    """

    planned: Planned
    back: "Back | None"
    onwards: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Onwards:
    """The way to a hold from another that was left beside it.

    Attributes:
        begins: Where the fingers are then [rad or m], shape (F,).
    """

    approach: Approach
    begins: Array


@dataclass(frozen=True, slots=True, eq=False)
class Back:
    """The end of a holding, and the way by which one would come to it there."""

    holding: Holding
    approach: Approach
    attempt: Attempt

    def parked(self) -> BodyMotion:
        """Back to parked."""
        return self.attempt.assembler.retreat(self.approach, self.holding)

    def away(self) -> BodyMotion:
        """Away from the handle only."""
        return self.attempt.assembler.retreat(self.approach, self.holding, home=False)

    def to(self, other: "Back", samples: int, late: Callable[[], bool]) -> Onwards | None:
        """From where this one has left the handle to where the other comes to it; None if no way is found."""
        return self._onwards(other.approach.reach, other.holding.grasp.opened, samples, late)

    def on(self, planned: Planned, late: Callable[[], bool]) -> list[BodyMotion]:
        """Away from the handle, and on to the next hold; nothing where no way of the arm is found."""
        way = self._onwards(planned.approach.reach, planned.holding.grasp.opened, ARM_ITERATIONS, late)
        if way is None:
            return []
        return [self.away(), planned.assembler.assemble(way.approach, planned.holding, way.begins).body]

    def _onwards(
        self, reach: Array, opens: Positions, samples: int, late: Callable[[], bool]
    ) -> Onwards | None:
        """To where the open hand comes to the handle, its waypoints (R, n)."""
        approacher, opened = self.attempt.approacher, self.holding.grasp.opened
        ends = self.approach.reach[0], reach[0]
        if not approacher.swings(ends[0], opened, opens):
            return None
        rest = approacher.hand.configuration(dict(opens))
        about = approacher.world, approacher.limb, approacher.rules, rest, approacher.weight
        space = ArmSpace(*about, ends[0][BASE])
        corners = connect(space, ends, self.attempt.rng, samples, late)
        if corners is None or not all(space.finely_free(*edge) for edge in pairwise(corners)):
            return None
        come = Approach(np.stack([ends[0]] * 2), corners, np.stack([ends[1]] * 2), reach)
        return Onwards(come, np.array([value for _, value in opened]))


def orders(legs: list[Leg], late: Callable[[], bool]) -> Iterator[list[BodyMotion]]:
    """Motions through all of them: straight from one to the next where there is a way, then by parking."""
    straight, parking = [legs[0].planned.body], [legs[0].planned.body]
    for one, other in pairwise(legs):
        assert one.back is not None, "only the last is not left"
        if other.onwards:
            on = [one.back.away(), other.planned.body]
            straight, parking = straight + on, parking + on
            continue
        by_parking = [one.back.parked(), other.planned.body]
        same = one.planned.body.gripper == other.planned.body.gripper
        straight += (same and one.back.on(other.planned, late)) or by_parking
        parking += by_parking
    yield straight
    if parking != straight:
        yield parking


def joined(planned: list[Planned], bodies: list[BodyMotion]) -> Planned:
    """All of them in order, and the motion of the container from when it begins to move to its end."""
    first, *others = planned
    scene = first.assembler.world.scene
    body = _in_a_row(bodies if len({one.gripper for one in bodies}) == 1 else _of_all(bodies, scene))
    parts = [one.motion for one in (first, *others)]
    begins = np.array([body.times[sample] for name, sample in body.phases if name.startswith("follow")])
    velocities = [part.velocities for part in parts if part.velocities is not None]
    motion = replace(
        first.motion,
        times=np.concatenate([at + part.times for at, part in zip(begins - begins[0], parts, strict=True)]),
        values=np.concatenate([part.values for part in parts]),
        velocities=np.concatenate(velocities),
    )
    style = first.style
    for one in others:
        gripper = one.assembler.limb.gripper.name
        by = "" if body.gripper else f" by gripper {gripper}"
        style += f"; let go at {one.motion.values[0, 0]:.3g}, then grasp {one.grasp}{by}, {one.style}"
    return replace(first, body=body, motion=motion, style=style)


def _of_all(bodies: list[BodyMotion], scene: Scene) -> list[BodyMotion]:
    """The same with the joints of all of them, parked where one does not move them; no gripper is named."""
    names = tuple(dict.fromkeys(name for body in bodies for name in body.joints))
    parked, robot = scene.q((0.0, 0.0, 0.0), {}), scene.robot.mechanism.name
    rest = np.array([parked[scene.coordinate[joint_iri(robot, name)]] for name in names])
    found = list[BodyMotion]()
    for body in bodies:
        q, v = np.tile(rest, (len(body.times), 1)), np.zeros((len(body.times), len(names)))
        own = [names.index(name) for name in body.joints]
        q[:, own], v[:, own] = body.q, body.v
        found.append(replace(body, gripper="", joints=names, q=q, v=v))
    return found


def _in_a_row(bodies: list[BodyMotion]) -> BodyMotion:
    """One after the other, each from where the one before ends; phases of one name are numbered."""
    times, phases = [bodies[0].times], [*bodies[0].phases]
    seen = Counter(name for name, _ in phases)
    for body in bodies[1:]:
        count = sum(map(len, times)) - 1
        times.append(times[-1][-1] + body.times[1:] - body.times[0])
        for name, sample in body.phases:
            seen[name] += 1
            phases.append((f"{name} {seen[name]}" if seen[name] > 1 else name, count + sample))
    rows = {
        name: np.concatenate([getattr(body, name)[min(k, 1) :] for k, body in enumerate(bodies)])
        for name in ("base", "q", "v", "base_v", "kitchen_q", "kitchen_v")
    }
    return replace(bodies[0], times=np.concatenate(times), phases=tuple(phases), **rows)
