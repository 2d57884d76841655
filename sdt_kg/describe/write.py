"""An annotation as Turtle."""

import math
from collections.abc import Iterator, Mapping
from urllib.parse import quote

import pyoxigraph as ox

from sdt_kg.annotation import Gripper, RobotAnnotation
from sdt_kg.iri import PREFIXES, body_iri, joint_iri, model_iri
from sdt_kg.mechanism import Pose

FINGERS = "the fingers of one gripper close upon each other"


def turtle(robot: RobotAnnotation, source: str, why: Mapping[frozenset[str], str] | None = None) -> str:
    """Turtle text of an annotation.

    Args:
        robot: What it says.
        source: Name of the file that the robot was read from.
        why: For pairs that may touch, the reason; it is written above them.
    """
    prefixes = "\n".join(f"@prefix {name}: <{PREFIXES[name]}> ." for name in ("dcterms", "rdfs", "sdt"))
    blocks = (
        prefixes,
        _robot(robot, source),
        *(_gripper(robot.robot, gripper) for gripper in robot.grippers),
        *(_coupling(robot.robot, k, joints) for k, joints in enumerate(robot.coupled)),
        *_joints(robot),
        *_pairs(robot, why or {}),
    )
    return "\n\n".join(blocks) + "\n"


def _robot(robot: RobotAnnotation, source: str) -> str:
    base = robot.base_limits
    iris = (_gripper_iri(robot.robot, gripper) for gripper in robot.grippers)
    couplings = (_coupling_iri(robot.robot, k) for k in range(len(robot.coupled)))
    lines = [
        f"<{model_iri(robot.robot)}> a sdt:Robot ;",
        f"  rdfs:label {ox.Literal(robot.robot)} ;",
        f"  dcterms:source {ox.Literal(source)} ;",
        *(f"  sdt:assumption {ox.Literal(note)} ;" for note in robot.notes),
        *(f"  sdt:baseAssumption {ox.Literal(note)} ;" for note in robot.base_notes),
        f"  sdt:baseAngularAcceleration {base.angular_acceleration} ;",
        f"  sdt:baseAngularVelocity {base.angular_velocity} ;",
        f"  sdt:baseBody <{body_iri(robot.robot, robot.base_body)}> ;",
        f"  sdt:baseHeight {robot.base_height} ;",
        f"  sdt:baseLinearAcceleration {base.linear_acceleration} ;",
        f"  sdt:baseLinearVelocity {base.linear_velocity} ;",
        *(f"  sdt:hasCoupling <{iri}> ;" for iri in couplings),
        *(f"  sdt:hasGripper <{iri}> ;" for iri in iris),
        f"  sdt:drive sdt:{robot.drive.value.capitalize()} ;",
        f"  sdt:overhang {robot.overhang} .",
    ]
    return "\n".join(lines)


def _gripper_iri(model: str, gripper: Gripper) -> str:
    return f"{model_iri(model)}/gripper/{quote(gripper.name, safe='')}"


def _gripper(model: str, gripper: Gripper) -> str:
    iri = _gripper_iri(model, gripper)
    fingers = " , ".join(f"<{body_iri(model, finger)}>" for finger in gripper.fingers)
    joints = " , ".join(f"<{joint_iri(model, finger.joint)}>" for finger in gripper.finger_joints)
    lines = [
        f"<{iri}> a sdt:Gripper ;",
        f"  rdfs:label {ox.Literal(gripper.name)} ;",
        *(
            [f"  sdt:fingerDifference {gripper.difference:.4f} ;"]
            if math.isfinite(gripper.difference)
            else []
        ),
        f"  sdt:hasFinger {fingers} ;",
        f"  sdt:hasFingerJoint {joints} ;",
        f"  sdt:opening {gripper.opening:.4f} ;",
        f"  sdt:toolBody <{body_iri(model, gripper.tool_body)}> ;",
        f"  sdt:toolFrame <{iri}/tool> .",
        "",
        _pose(f"{iri}/tool", gripper.tool),
    ]
    for finger in gripper.finger_joints:
        joint = joint_iri(model, finger.joint)
        opened, closed = _decimal(finger.open), _decimal(finger.closed)
        lines += ["", f"<{joint}> sdt:closedPosition {closed} ;", f"  sdt:openPosition {opened} ."]
    return "\n".join(lines)


def _pose(iri: str, pose: Pose) -> str:
    names = ("x", "y", "z", "qx", "qy", "qz", "qw")
    values = zip(names, (*pose.position, *pose.orientation), strict=True)
    return f"<{iri}> a sdt:Pose ;\n" + " ;\n".join(f"  sdt:{n} {_decimal(v)}" for n, v in values) + " ."


def _decimal(value: float) -> str:
    return f"{value:.6f}"


def _coupling_iri(model: str, k: int) -> str:
    return f"{model_iri(model)}/coupling/telescope{k + 1}"


def _coupling(model: str, k: int, joints: tuple[str, ...]) -> str:
    couples = " , ".join(f"<{joint_iri(model, joint)}>" for joint in joints)
    return f"<{_coupling_iri(model, k)}> a sdt:Coupling ;\n  sdt:couples {couples} ."


def _joints(robot: RobotAnnotation) -> Iterator[str]:
    """A block for each of: limits of acceleration, what is held, where it is parked."""
    said = (
        {name: f"sdt:accelerationLimit {_decimal(limit)}" for name, limit in robot.acceleration.items()},
        dict.fromkeys(robot.held, "sdt:held true"),
        {name: f"sdt:parkedPosition {_decimal(at)}" for name, at in robot.parked.items()},
    )
    for words in said:
        if words:
            yield "\n".join(f"<{joint_iri(robot.robot, name)}> {words[name]} ." for name in words)


def _pairs(robot: RobotAnnotation, why: Mapping[frozenset[str], str]) -> Iterator[str]:
    """A block for each reason why pairs may touch."""
    groups: dict[str, list[tuple[str, str]]] = {}
    for pair in robot.allowed_contacts:
        groups.setdefault(why.get(pair, FINGERS), []).append((min(pair), max(pair)))
    for reason, pairs in sorted(groups.items()):
        lines = (
            f"<{body_iri(robot.robot, one)}> sdt:mayTouch <{body_iri(robot.robot, other)}> ."
            for one, other in sorted(pairs)
        )
        yield "\n".join((f"# check: {reason}", *lines))
