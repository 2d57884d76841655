"""The first annotation of a robot, as Turtle."""

import math
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Final

from sdt_kg.annotation import Gripper
from sdt_kg.describe.grippers import guessed_grippers
from sdt_kg.describe.tree import Tree
from sdt_kg.iri import PREFIXES, body_iri, joint_iri, model_iri
from sdt_kg.mechanism import JointType, Mechanism, Pose
from sdt_kg.urdf import read_mechanism

Contacts = Callable[[Mechanism], Iterable[tuple[str, str]]]
"""Pairs of bodies which touch in every sampled configuration: physics finds them, not this package."""

RISE_TIME: Final = 0.5
"""[s] A joint is assumed to reach its highest speed in this time."""

BASE_SPEED: Final = 0.2
"""[m/s, rad/s] Speed of the base in the paper's experiment."""


def describe(urdf: str | Path, contacts: Contacts) -> str:
    """Turtle text of a first annotation: what is guessed says `check`.

    Args:
        urdf: URDF or xacro file of the robot.
        contacts: Gives the pairs of bodies that touch wherever the robot moves.

    Raises:
        UrdfError: Not a valid URDF.
    """
    tree = Tree(read_mechanism(urdf))
    grippers = guessed_grippers(tree)
    pairs = sorted({(min(pair), max(pair)) for pair in contacts(tree.mechanism)})
    prefixes = "\n".join(f"@prefix {name}: <{PREFIXES[name]}> ." for name in ("dcterms", "rdfs", "sdt"))
    blocks = (
        prefixes,
        _robot(tree.mechanism, grippers, Path(urdf)),
        *(_gripper(tree.mechanism.name, gripper) for gripper in grippers),
        *_joints(tree, grippers),
        *_pairs(tree.mechanism.name, pairs),
    )
    return "\n\n".join(blocks) + "\n"


def _robot(mechanism: Mechanism, grippers: list[Gripper], urdf: Path) -> str:
    assumptions = [
        "check: the base is taken to be differential (sdt:Omni, sdt:Differential or sdt:Fixed)",
        f"check: base speed {BASE_SPEED} m/s and {BASE_SPEED} rad/s, reached in {RISE_TIME} s",
        f"check: acceleration limits let each joint reach its highest speed in {RISE_TIME} s",
        "check: parked, every joint is at 0 or the nearest limit; give sdt:parkedPosition for better",
        "check: joints that move no gripper are held",
        "check: grippers, their fingers, tool frames and openings are guessed from names and shapes",
        "check: pairs that may touch are those which touch in every sampled configuration",
    ]
    if not grippers:
        assumptions.append("check: no gripper was found; add one with sdt:hasGripper, see robots/README.md")
    lines = [
        f"<{model_iri(mechanism.name)}> a sdt:Robot ;",
        f'  rdfs:label "{mechanism.name}" ;',
        f'  dcterms:source "{urdf.name}" ;',
        *(f'  sdt:assumption "{assumption}" ;' for assumption in assumptions),
        f"  sdt:baseAngularAcceleration {BASE_SPEED / RISE_TIME} ;",
        f"  sdt:baseAngularVelocity {BASE_SPEED} ;",
        f"  sdt:baseBody <{body_iri(mechanism.name, mechanism.root)}> ;",
        "  sdt:baseHeight 0.0 ;",
        f"  sdt:baseLinearAcceleration {BASE_SPEED / RISE_TIME} ;",
        f"  sdt:baseLinearVelocity {BASE_SPEED} ;",
        *(f"  sdt:hasGripper <{_gripper_iri(mechanism.name, gripper)}> ;" for gripper in grippers),
        "  sdt:drive sdt:Differential ;",
        "  sdt:overhang 0.0 .",
    ]
    return "\n".join(lines)


def _gripper_iri(model: str, gripper: Gripper) -> str:
    return f"{model_iri(model)}/gripper/{gripper.name}"


def _gripper(model: str, gripper: Gripper) -> str:
    iri = _gripper_iri(model, gripper)
    fingers = " , ".join(f"<{body_iri(model, finger)}>" for finger in gripper.fingers)
    joints = " , ".join(f"<{joint_iri(model, finger.joint)}>" for finger in gripper.finger_joints)
    lines = [
        f"<{iri}> a sdt:Gripper ;",
        f'  rdfs:label "{gripper.name}" ;',
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


def _joints(tree: Tree, grippers: list[Gripper]) -> Iterator[str]:
    """Acceleration limits of all joints that planning may move; the others are held."""
    model = tree.mechanism.name
    used = {finger.joint for gripper in grippers for finger in gripper.finger_joints}
    for gripper in grippers:
        used |= {joint.name for joint in tree.ancestors(gripper.tool_body)}
    lines: list[str] = []
    for joint in tree.mechanism.joints:
        iri = joint_iri(model, joint.name)
        if joint.type is JointType.FIXED or joint.mimic is not None:
            continue
        if joint.name not in used:
            lines.append(f"<{iri}> sdt:held true .")
        elif math.isfinite(joint.limits.velocity):
            lines.append(f"<{iri}> sdt:accelerationLimit {_decimal(joint.limits.velocity / RISE_TIME)} .")
    if lines:
        yield "\n".join(lines)


def _pairs(model: str, pairs: list[tuple[str, str]]) -> Iterator[str]:
    if pairs:
        yield "\n".join(
            f"<{body_iri(model, one)}> sdt:mayTouch <{body_iri(model, other)}> ." for one, other in pairs
        )
