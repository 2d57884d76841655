"""Triples → RobotAnnotation and KitchenAnnotation."""

import math

from sdt_kg.annotation import BaseLimits, Drive, FingerJoint, Gripper, KitchenAnnotation, RobotAnnotation
from sdt_kg.iri import RDFS, Iri, local_name
from sdt_kg.mechanism import ShapeType
from sdt_kg.triples.facts import Facts
from sdt_kg.triples.from_mechanism import POSE, SIZES
from sdt_kg.triples.to_mechanism import geometry_of, notes_of, shapes_of


def read_robot(facts: Facts, robot: Iri) -> RobotAnnotation:
    """What the graph says of a robot beyond its mechanism."""
    joints = _joints(facts, robot)
    grippers = sorted(facts.iris(robot, "hasGripper"))
    base = [
        facts.number(robot, f"base{name}")
        for name in ("LinearVelocity", "AngularVelocity", "LinearAcceleration", "AngularAcceleration")
    ]
    coupled = tuple(
        tuple(sorted(local_name(joint) for joint in facts.iris(coupling, "couples")))
        for coupling in sorted(facts.iris(robot, "hasCoupling"))
    )
    return RobotAnnotation(
        robot=local_name(robot),
        drive=Drive(local_name(str(facts.one(robot, "drive"))).lower()),
        base_body=local_name(str(facts.one(robot, "baseBody"))),
        base_height=facts.number(robot, "baseHeight"),
        base_limits=BaseLimits(*base),
        grippers=tuple(_gripper(facts, gripper) for gripper in grippers),
        parked=_parked(facts, joints, coupled),
        held=tuple(local_name(joint) for joint in joints if facts.one(joint, "held") is True),
        acceleration=_numbers(facts, joints, "accelerationLimit"),
        coupled=coupled,
        allowed_contacts=frozenset(
            frozenset((local_name(body), local_name(other)))
            for body in facts.having("partOf", robot)
            for other in facts.iris(body, "mayTouch")
        ),
        overhang=facts.number(robot, "overhang", 0.0),
        notes=(*map(str, facts.all(robot, "assumption")), *notes_of(facts, robot)),
        base_notes=tuple(map(str, facts.all(robot, "baseAssumption"))),
        cores=tuple(
            (local_name(body), geometry_of(facts, core))
            for body in sorted(facts.having("partOf", robot))
            for core in sorted(facts.iris(body, "hasCore"))
        ),
    )


def read_kitchen(facts: Facts, kitchen: Iri) -> KitchenAnnotation:
    """What the graph says of a kitchen beyond its mechanism."""
    start = facts.pose(str(facts.one(kitchen, "startPose")))
    _, _, qz, qw = start.orientation
    return KitchenAnnotation(
        kitchen=local_name(kitchen),
        start=(start.position[0], start.position[1], 2 * math.atan2(qz, qw)),
        acceleration=_numbers(facts, _joints(facts, kitchen), "accelerationLimit"),
        notes=(*map(str, facts.all(kitchen, "assumption")), *notes_of(facts, kitchen)),
    )


def _joints(facts: Facts, model: Iri) -> list[Iri]:
    parts = facts.having("partOf", model)
    return sorted(
        (part for part in parts if facts.one(part, "child") is not None),
        key=lambda joint: facts.number(joint, "index"),
    )


def _parked(facts: Facts, joints: list[Iri], coupled: tuple[tuple[str, ...], ...]) -> dict[str, float]:
    """Where joints are parked, as far as it is said, or follows from what shares a motor with them."""
    parked = _numbers(facts, joints, "parkedPosition")
    low = {local_name(joint): facts.number(joint, "lowerLimit", -math.inf) for joint in joints}
    high = {local_name(joint): facts.number(joint, "upperLimit", math.inf) for joint in joints}
    for group in coupled:
        least, most = max(low[name] for name in group), min(high[name] for name in group)
        said = {parked[name] for name in group if name in parked} or {min(max(0.0, least), most)}
        at = min(said)
        if len(said) == 1 and least <= at <= most:
            parked |= dict.fromkeys(group, at)
    return parked


def _numbers(facts: Facts, joints: list[Iri], name: str) -> dict[str, float]:
    return {
        local_name(joint): facts.number(joint, name) for joint in joints if facts.one(joint, name) is not None
    }


def _gripper(facts: Facts, gripper: Iri) -> Gripper:
    finger_joints = (
        FingerJoint(
            local_name(joint), facts.number(joint, "openPosition"), facts.number(joint, "closedPosition")
        )
        for joint in sorted(facts.iris(gripper, "hasFingerJoint"))
    )
    return Gripper(
        name=str(facts.one(gripper, RDFS + "label")),
        tool_body=local_name(str(facts.one(gripper, "toolBody"))),
        tool=facts.pose(str(facts.one(gripper, "toolFrame"))),
        fingers=tuple(sorted(local_name(finger) for finger in facts.iris(gripper, "hasFinger"))),
        finger_joints=tuple(finger_joints),
        opening=facts.number(gripper, "opening"),
        difference=facts.number(gripper, "fingerDifference", math.inf),
    )


ROBOT_NEEDS = (
    "drive",
    "baseBody",
    "baseHeight",
    "baseLinearVelocity",
    "baseAngularVelocity",
    "baseLinearAcceleration",
    "baseAngularAcceleration",
    "hasGripper",
)
"""Properties without which a robot's annotation is of no use."""

GRIPPER_NEEDS = (RDFS + "label", "toolBody", "toolFrame", "hasFinger", "hasFingerJoint", "opening")
"""Properties without which a gripper is of no use."""

CORE_NEEDS = ("hasPose", *SIZES[ShapeType.BOX])
"""Properties without which a core is no box."""


def missing_of(facts: Facts, model: Iri, kind: str) -> list[str]:
    """What the annotation of an `Environment` or `Robot` needs and lacks: subject and property, by name."""
    needed = [(model, name) for name in (ROBOT_NEEDS if kind == "Robot" else ("startPose",))]
    grippers, named = sorted(facts.iris(model, "hasGripper")), dict[str, Iri]()
    poses = facts.iris(model, "startPose")
    for gripper in grippers:
        needed += [(gripper, name) for name in GRIPPER_NEEDS]
        poses += facts.iris(gripper, "toolFrame")
        for joint in facts.iris(gripper, "hasFingerJoint"):
            needed += [(joint, "openPosition"), (joint, "closedPosition")]
    needed += [(coupling, "couples") for coupling in sorted(facts.iris(model, "hasCoupling"))]
    cores = sorted({core for subject in facts.subjects() for core in facts.iris(subject, "hasCore")})
    for core in cores:
        needed += [(core, name) for name in CORE_NEEDS]
        poses += facts.iris(core, "hasPose")
    needed += [(pose, name) for pose in dict.fromkeys(poses) for name in POSE]
    lacking = [
        f"{local_name(iri)} sdt:{local_name(name)}" for iri, name in needed if facts.one(iri, name) is None
    ]
    lacking += [
        f"{local_name(core)} a sdt:Box" for core in cores if shapes_of(facts, core) != [ShapeType.BOX]
    ]
    return lacking + [
        f"{local_name(gripper)} rdfs:label of its own ('{label}' is that of {local_name(first)})"
        for gripper in grippers
        if (label := facts.one(gripper, RDFS + "label")) is not None
        and (first := named.setdefault(str(label), gripper)) != gripper
    ]
