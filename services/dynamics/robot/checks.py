"""Whether the robot bears a motion: joint efforts, grip, slip and tipping; and what is not checked."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from predicates.case import Evidence, Quantity
from sdt_kg.errors import InputError
from sdt_kg.iri import Iri, joint_iri, local_name
from sdt_kg.mechanism import JointType
from sdt_kg.naming import few
from sdt_kg.triples import Facts
from sdt_kg.twin import Twin
from services.dynamics.model import Array
from services.dynamics.robot.load import Loads
from services.dynamics.robot.tipping import tipping, unweighed
from services.embodiment.proof_check.geometry.interval import Interval
from services.physics.model import Scene

PARALLEL = "the faces that hold are taken to look along the way in which pads close: there is no certificate"

NAMED = 4  # of bodies or joints that a note is about; of more it says how many
LEAST = 1e-9  # [rad] half of a cone in which nothing is held


@dataclass(frozen=True, slots=True)
class Bound:
    """A quantity that the robot has to keep within a bound, as far as the handle's force is known.

    Attributes:
        name: What it is, for people.
        least: Every value of the container's parameters makes so much of it at some time.
        most: No value makes more of it at any time.
        bound: What is surely allowed.
        unit: Of all of them.
        entity: Joint, gripper or robot.
        time: Middle of the span of `most` [s].
        farthest: What may be allowed at most, not below `bound`.
    """

    name: str
    least: float
    most: float
    bound: float
    unit: str
    entity: Iri
    time: float
    farthest: float

    @property
    def decided(self) -> bool:
        """Whether it is surely kept, or surely not."""
        return self.most <= self.bound or self.least > self.farthest

    def evidence(self, value: float, bound: float) -> Evidence:
        """The value against a bound."""
        return Evidence(Quantity.FORCE, value, bound, self.unit, entity=self.entity, time=self.time)


@dataclass(frozen=True, slots=True)
class _Allowed:
    """What a quantity is called, and how much of it is allowed."""

    name: str
    bound: float
    unit: str
    entity: Iri
    farthest: float | None = None

    def over(self, loads: Loads, value: Interval) -> Bound:
        """Its worst over all spans."""
        worst = int(np.argmax(value.hi))
        time = float(loads.begin[worst] + loads.end[worst]) / 2
        least, most = float(value.lo.max()), float(value.hi[worst])
        farthest = self.bound if self.farthest is None else self.farthest
        return Bound(self.name, least, most, self.bound, self.unit, self.entity, time, farthest)


Check = Callable[[Loads], Iterator[Bound]]


@dataclass(frozen=True, slots=True)
class Checks:
    """What can be checked of a robot with the data that the twin has.

    Attributes:
        of: What each check says of a motion.
        missing: What is not checked, and for want of what, one sentence each.
    """

    of: tuple[Check, ...]
    missing: tuple[str, ...]

    def bounds(self, loads: Loads) -> list[Bound]:
        """What all of them say."""
        return [each for check in self.of for each in check(loads)]


def checks(scene: Scene, twin: Twin, gripper: str, slant: float | None) -> Checks:
    """All checks for which there are data.

    Args:
        scene: Kitchen and robot.
        twin: What is known of both.
        gripper: Name of the one that holds.
        slant: How far the faces that hold look away from the way in which pads close, at most [rad];
            None where nobody knows.
    """
    found, missing = list[Check](), list[str]()
    for make in (_efforts, partial(_grip, slant), _slip, _tip):
        check, absent = make(scene, twin, gripper)
        found += [] if check is None else [check]
        missing += absent
    light = [name for part in unweighed(scene) for name in part]
    if found and light:
        names = few(light, NAMED)
        missing.append(f"not counted: the mass of {names}, which the model does not give")
    return Checks(tuple(found), tuple(missing))


_Made = tuple[Check | None, list[str]]


def _efforts(scene: Scene, twin: Twin, gripper: str) -> _Made:
    """Joints whose effort limit the twin knows to be one of the hardware."""
    del gripper  # arms that hold nothing bear their own weight
    known, unknown = _motors(scene, twin)
    absent = list[str]()
    if unknown:
        names = few(unknown, NAMED)
        absent = [f"not checked: efforts of {names}, whose limits are not known to be the hardware's"]
    if not known:
        return None, absent

    def check(loads: Loads) -> Iterator[Bound]:
        for each in known:
            k, name = each.coordinate, f"effort of {local_name(each.iri)}"
            effort = (loads.weightless if each.balanced else loads.without)[k]
            if k in loads.each:
                effort = effort + loads.each[k] * loads.force
            yield _Allowed(name, each.limit, each.unit, each.iri).over(loads, effort.magnitude())

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
    fingers = scene.annotation.finger_joints
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


def _range(facts: Facts, subject: Iri, name: str) -> tuple[float, float]:
    """What is surely there, and what is there at most (unknown: without end); NaN where nothing is known.

    Raises:
        InputError: It is no range of positive numbers.
    """
    least, most = facts.number(subject, name, math.nan), facts.number(subject, f"{name}Most", math.inf)
    if not math.isnan(least) and not 0 < least <= most:
        raise InputError(
            f"sdt:{name} of {local_name(subject)} is {least:g} to {most:g}",
            allowed=f"above 0, and not above sdt:{name}Most",
        )
    return least, most


def _grip(slant: float | None, scene: Scene, twin: Twin, gripper: str) -> _Made:
    """Friction of two pads, which close along the tool's y, against what pulls across them: the cone.

    Where faces look elsewhere, by `slant`, the cone about y that is surely within theirs is so much narrower,
    and that which theirs are in so much wider.
    """
    iri = f"{scene.robot_iri}/gripper/{gripper}"
    facts = twin.entities.facts
    (grip, strongest), (friction, roughest) = (
        _range(facts, iri, name) for name in ("gripForce", "padFriction")
    )
    if math.isnan(grip) or math.isnan(friction):
        given = (("gripForce", grip), ("padFriction", friction))
        absent = " and no sdt:".join(name for name, value in given if math.isnan(value))
        return None, [f"not checked: grip at the handle, since {gripper} has no sdt:{absent}"]

    off = 0.0 if slant is None else slant
    surely, perhaps = (_friction(each, turned) for each, turned in ((friction, -off), (roughest, off)))

    def check(loads: Loads) -> Iterator[Bound]:
        # two pads press; what pushes one of them off takes from what friction holds
        force = loads.force.magnitude()
        least = np.nextafter(_pulling(loads.beside, perhaps).lo * force.lo / 2, 0.0)
        most = np.nextafter(_pulling(loads.beside, surely).hi * force.hi / 2, np.inf)
        what = _Allowed("press of the pads that the pull across them takes", grip, "N", iri, strongest)
        yield what.over(loads, Interval(least, most))

    return check, [PARALLEL] if slant is None else []


def _friction(coefficient: float, turned: float) -> float:
    """The coefficient of a cone that is wider by that angle [rad]: nearly none, or infinite, at its ends."""
    angle = math.atan(coefficient) + turned
    return math.inf if angle >= math.pi / 2 else math.tan(max(angle, LEAST))


def _pulling(beside: Interval, friction: float) -> Interval:
    """sqrt(1 - b²) / friction + b: rises up to its top, then falls."""

    def share(b: Array) -> Array:
        return np.sqrt(np.maximum(1 - b**2, 0.0)) / friction + b

    low, high = (np.clip(each, 0.0, 1.0) for each in (beside.lo, beside.hi))
    steepest = 1.0 if math.isinf(friction) else friction / math.hypot(1.0, friction)
    top, ends = np.clip(np.full_like(low, steepest), low, high), (share(low), share(high))
    return Interval(np.nextafter(np.minimum(*ends), 0.0), np.nextafter(share(top), np.inf))


def _slip(scene: Scene, twin: Twin, gripper: str) -> _Made:
    """Wheels hold what pushes the robot sideways."""
    del gripper
    friction, roughest = _range(twin.entities.facts, scene.robot_iri, "wheelFriction")
    if math.isnan(friction):
        return None, ["not checked: slip of the base, since the robot has no sdt:wheelFriction"]
    base, _ = unweighed(scene)
    if base:
        return None, [
            f"not checked: slip of the base, since the model gives no mass of {', '.join(base[:4])}"
        ]

    def check(loads: Loads) -> Iterator[Bound]:
        spread = loads.floor.radius + loads.force.magnitude().hi * loads.along.radius
        floors = [
            loads.floor.centre + force[:, None] * loads.along.centre
            for force in (loads.force.lo, loads.force.hi)
        ]
        # convex in the force: the most is at an end, the least need not be
        slips = [np.hypot(each[:, 0], each[:, 1]) - friction * each[:, 2] for each in floors]
        most = np.maximum(*slips) + (1 + friction) * spread
        heaviest = np.maximum(np.maximum(floors[0][:, 2], floors[1][:, 2]) + spread, np.finfo(float).tiny)
        least = _least_sideways(loads) - spread - roughest * heaviest
        what = _Allowed("sideways push on the wheels beyond their friction", 0.0, "N", scene.robot_iri)
        yield what.over(loads, Interval(least, most))

    return check, []


def _least_sideways(loads: Loads) -> Array:
    """The least horizontal force of the floor over all forces at the handle, of the centres [N]."""
    own, along = loads.floor.centre[:, :2], loads.along.centre[:, :2]
    square = (along**2).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        free = np.nan_to_num(-(own * along).sum(axis=1) / square, nan=0.0, posinf=0.0, neginf=0.0)
    best = np.clip(free, loads.force.lo, loads.force.hi)
    return np.linalg.norm(own + best[:, None] * along, axis=1)


def _tip(scene: Scene, twin: Twin, gripper: str) -> _Made:
    """What the floor gives keeps within the wheels: the zero-moment point."""
    del gripper
    over, absent = tipping(scene, twin)
    if over is None:
        return None, [f"not checked: tipping of the base, {absent}"]

    def check(loads: Loads) -> Iterator[Bound]:
        what = _Allowed("moment that tips the base beyond what weight holds", 0.0, "N m", scene.robot_iri)
        yield what.over(loads, over(loads))

    return check, []
