"""Whether the robot bears a moment: joint efforts, grip, wheels on the floor; and what is not checked."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from predicates.case import Evidence, Quantity
from sdt_kg.iri import Iri, joint_iri, local_name
from sdt_kg.mechanism import JointType
from sdt_kg.twin import Twin
from services.dynamics.robot.load import Moment
from services.physics.model import Scene


@dataclass(frozen=True, slots=True)
class Bound:
    """A quantity that the robot has to keep within a bound, as far as the handle's force is known.

    Attributes:
        name: What it is, for people.
        least: What every value of the container's parameters makes of it.
        most: What no value exceeds.
        bound: What is allowed.
        unit: Of all three.
        entity: Joint, gripper or robot.
        time: When [s].
    """

    name: str
    least: float
    most: float
    bound: float
    unit: str
    entity: Iri
    time: float

    def evidence(self, value: float) -> Evidence:
        """The value against the bound."""
        return Evidence(Quantity.FORCE, value, self.bound, self.unit, entity=self.entity, time=self.time)


@dataclass(frozen=True, slots=True)
class Checks:
    """What can be checked of a robot with the data that the twin has.

    Attributes:
        of: What each check says of a moment.
        missing: What is not checked, and for want of what, one sentence each.
    """

    of: tuple[Callable[[Moment], Iterator[Bound]], ...]
    missing: tuple[str, ...]


def checks(scene: Scene, twin: Twin, gripper: str) -> Checks:
    """All checks for which there are data."""
    found, missing = list[Callable[[Moment], Iterator[Bound]]](), list[str]()
    for make in (_efforts, _grip, _slip):
        check, absent = make(scene, twin, gripper)
        found += [] if check is None else [check]
        missing += absent
    missing.append("not checked: tipping of the base, since nothing says where wheels touch the floor")
    return Checks(tuple(found), tuple(missing))


_Made = tuple[Callable[[Moment], Iterator[Bound]] | None, list[str]]


def _efforts(scene: Scene, twin: Twin, gripper: str) -> _Made:
    """Joints whose effort limit the twin knows to be one of the hardware."""
    del gripper  # arms that hold nothing bear their own weight
    known, unknown = _motors(scene, twin)
    absent = list[str]()
    if unknown:
        names = ", ".join(unknown[:4]) + (f" and {len(unknown) - 4} more" if len(unknown) > 4 else "")
        absent = [f"not checked: efforts of {names}, whose limits are not known to be the hardware's"]
    if not known:
        return None, absent

    def check(moment: Moment) -> Iterator[Bound]:
        for each in known:
            k, name = each.coordinate, f"effort of {local_name(each.iri)}"
            base = moment.without[k] - (moment.weight[k] if each.balanced else 0.0)
            ends = [float(base + moment.each[k] * force) for force in moment.force]
            low, high = min(ends), max(ends)
            least = 0.0 if low <= 0 <= high else min(abs(low), abs(high))
            yield Bound(name, least, max(-low, high), each.limit, each.unit, each.iri, moment.time)

    return check, absent


@dataclass(frozen=True, slots=True)
class _Motor:
    """A joint's effort limit; balanced where springs or counterweights bear what weight asks of it."""

    coordinate: int
    limit: float
    balanced: bool
    unit: str
    iri: Iri


def _motors(scene: Scene, twin: Twin) -> tuple[list[_Motor], list[str]]:
    """Joints with a known limit, and names of those whose limit is not known."""
    facts, robot = twin.entities.facts, scene.robot.mechanism
    fingers = {each.joint for gripper in scene.annotation.grippers for each in gripper.finger_joints}
    known, unknown = list[_Motor](), list[str]()
    for k, joint in enumerate(scene.robot.joints, scene.robot.first):
        if joint.name in fingers or joint.mimic is not None:
            continue
        iri, limit = joint_iri(robot.name, joint.name), joint.limits.effort
        if facts.one(iri, "effortLimitKnown") is True and math.isfinite(limit):
            unit = "N" if joint.type is JointType.PRISMATIC else "N m"
            known.append(_Motor(k, limit, facts.one(iri, "weightBalanced") is True, unit, iri))
        elif joint.name not in scene.annotation.held:
            unknown.append(joint.name)
    return known, unknown


def _grip(scene: Scene, twin: Twin, gripper: str) -> _Made:
    """Friction of two pads, which close along the tool's y, against what pulls across them: the cone."""
    iri = f"{scene.robot_iri}/gripper/{gripper}"
    facts = twin.entities.facts
    grip, friction = (facts.number(iri, name, math.nan) for name in ("gripForce", "padFriction"))
    if math.isnan(grip) or math.isnan(friction):
        given = (("gripForce", grip), ("padFriction", friction))
        absent = " and no sdt:".join(name for name, value in given if math.isnan(value))
        return None, [f"not checked: grip at the handle, since {gripper} has no sdt:{absent}"]

    def check(moment: Moment) -> Iterator[Bound]:
        local = moment.tool[1].T @ moment.along
        beside, across = abs(float(local[1])), math.hypot(float(local[0]), float(local[2]))
        # two pads press with `grip`; what pushes one of them off takes from what friction holds
        sizes = sorted(abs(force) for force in moment.force)
        low = 0.0 if moment.force[0] <= 0 <= moment.force[1] else sizes[0]
        share = across + friction * beside
        least, most, holds = share * low, share * sizes[1], 2 * friction * grip
        yield Bound("pull across the pads", least, most, holds, "N", iri, moment.time)

    return check, []


def _slip(scene: Scene, twin: Twin, gripper: str) -> _Made:
    """Wheels hold what pushes the robot sideways."""
    del gripper
    friction = twin.entities.facts.number(scene.robot_iri, "wheelFriction", math.nan)
    if math.isnan(friction):
        return None, ["not checked: slip of the base, since the robot has no sdt:wheelFriction"]

    def check(moment: Moment) -> Iterator[Bound]:
        floors = [moment.floor + force * moment.along for force in moment.force]
        slips = [float(np.hypot(each[0], each[1])) - friction * float(each[2]) for each in floors]
        # convex in the force: the most is at an end, the least need not be
        least = _least_sideways(moment) - friction * max(float(each[2]) for each in floors)
        what = "sideways push on the wheels beyond their friction"
        yield Bound(what, least, max(slips), 0.0, "N", scene.robot_iri, moment.time)

    return check, []


def _least_sideways(moment: Moment) -> float:
    """The least horizontal force of the floor over all forces at the handle [N]."""
    own, along = moment.floor[:2], moment.along[:2]
    square = float(along @ along)
    best = 0.0 if square == 0 else float(np.clip(-(own @ along) / square, *moment.force))
    return float(np.linalg.norm(own + best * along))
