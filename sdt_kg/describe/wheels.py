"""A robot's wheels, and the line about which those turn that do not steer."""

import math
from collections.abc import Iterable, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from itertools import combinations
from typing import Final

import numpy as np

from sdt_kg.annotation import RobotAnnotation
from sdt_kg.describe.tree import Matrix, Tree
from sdt_kg.mechanism import Joint, JointType, Mechanism

ONE_LINE: Final = 0.01
"""[m] Wheels whose axes are less apart turn about one line."""

NEAR_FLOOR: Final = 0.05
"""[m] A wheel's lowest point is at most so much above that of the lowest: some hang on springs."""

TURNING: Final = (JointType.REVOLUTE, JointType.CONTINUOUS)

SIDEWAYS: Final = ("mecanum", "omni", "swedish")
"""In the names of wheels that also roll sideways."""

ALONG: Final = 0.95
"""[1] Least cosine between directions that count as the same: 18°."""

STRAIGHT: Final = 0.99995
"""[1] The same for directions in which a base goes and stands: 0.57°, so that 0.2 m/s has 2 mm/s across."""


@dataclass(frozen=True, slots=True)
class Wheel:
    """A wheel with all joints at 0: a point of its axis and the axis, in the root frame."""

    name: str
    centre: Matrix
    axis: Matrix
    steering: Joint | None


def wheels(tree: Tree, arms: AbstractSet[str]) -> list[Wheel]:
    """Bodies that turn without end about a level axis, near the floor."""
    found = [
        _wheel(tree, joint)
        for joint in tree.mechanism.joints
        if joint.type is JointType.CONTINUOUS
        and joint.name not in arms
        and abs(tree.axis(joint)[2]) < 1 - ALONG
        and ("wheel" in joint.child.lower() or len(tree.points(tree.below(joint.child), joint.child, {})))
    ]
    if on_one_line(found):  # none is higher; shapes may be meshes, which take long to read
        return found
    lowest = {wheel.name: min(tree.lowest(tree.below(wheel.name)), float(wheel.centre[2])) for wheel in found}
    return [wheel for wheel in found if lowest[wheel.name] <= min(lowest.values()) + NEAR_FLOOR]


def lying_wheels(tree: Tree) -> list[str]:
    """Bodies that are named as wheels and turn without end about an upright axis: another one is up."""
    return [
        joint.child
        for joint in tree.mechanism.joints
        if joint.type is JointType.CONTINUOUS
        and "wheel" in joint.child.lower()
        and abs(tree.axis(joint)[2]) > ALONG
    ]


def fixed_wheels(tree: Tree) -> list[str]:
    """Bodies that are named as wheels and do not turn: models for planning fix what drives."""
    return [
        joint.child
        for joint in tree.mechanism.joints
        if joint.type is JointType.FIXED and "wheel" in joint.child.lower()
    ]


def _wheel(tree: Tree, joint: Joint) -> Wheel:
    root = tree.mechanism.root
    turning = [each for each in tree.ancestors(joint.parent) if each.type in TURNING]
    steering = next((each for each in turning if abs(tree.axis(each)[2]) > ALONG), None)
    return Wheel(joint.child, tree.frame(joint.child, root, {})[:3, 3], tree.axis(joint), steering)


def on_one_line(found: Sequence[Wheel]) -> bool:
    """Whether there are several wheels, and all turn about one line, as seen from above."""
    return len(found) > 1 and all(_on_one_line(one, other) for one, other in combinations(found, 2))


def _on_one_line(one: Wheel, other: Wheel) -> bool:
    apart = other.centre - one.centre
    return float(np.linalg.norm((apart - (apart @ one.axis) * one.axis)[:2])) < ONE_LINE


def rolls_sideways(found: Iterable[Wheel]) -> bool:
    """Whether a wheel is named as one that rolls sideways too."""
    return any(word in wheel.name.lower() for wheel in found for word in SIDEWAYS)


def axle_ahead(tree: Tree, body: str, found: Sequence[Wheel]) -> float | None:
    """How far before a body's origin the line lies about which all wheels turn that do not steer [m].

    None where there is no such line across the body's x axis. The body is rigidly attached to the root.
    """
    rigid = [wheel for wheel in found if wheel.steering is None]
    if not on_one_line(rigid) or rolls_sideways(rigid):
        return None
    root_T_body = tree.frame(body, tree.mechanism.root, {})
    ahead, across = root_T_body[:3, 0], root_T_body[:3, 1]
    if abs(float(rigid[0].axis @ across)) < STRAIGHT:
        return None
    return float(np.mean([ahead @ (wheel.centre - root_T_body[:3, 3]) for wheel in rigid]))


def rolling_of(mechanism: Mechanism, annotation: RobotAnnotation) -> tuple[float, float]:
    """Where an annotated robot's wheels roll, from x of its base body [rad], and how far ahead they turn [m].

    Both are 0 where wheels that do not steer have no common direction, or none are known: nothing says
    otherwise. So is the second, counted where they roll, where they turn about several lines.
    """
    tree = Tree(mechanism)
    tools = (joint for gripper in annotation.grippers for joint in tree.ancestors(gripper.tool_body))
    fingers = (finger.joint for gripper in annotation.grippers for finger in gripper.finger_joints)
    found = wheels(tree, {*(joint.name for joint in tools), *fingers})
    rigid = [wheel for wheel in found if wheel.steering is None]
    parallel = all(abs(float(wheel.axis @ rigid[0].axis)) >= ALONG for wheel in rigid)
    if len(rigid) < 2 or not parallel or rolls_sideways(rigid):
        return 0.0, 0.0
    root_T_body = tree.frame(annotation.base_body, mechanism.root, {})
    x, y, _ = rigid[0].axis @ root_T_body[:3, :3]
    heading = math.atan(-x / y) if y else math.pi / 2
    ahead = root_T_body[:3, :3] @ (math.cos(heading), math.sin(heading), 0.0)
    if not on_one_line(rigid):
        return heading, 0.0
    return heading, float(np.mean([ahead @ (wheel.centre - root_T_body[:3, 3]) for wheel in rigid]))
