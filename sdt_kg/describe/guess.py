"""A robot's annotation as far as its structure, names and shapes tell."""

import math
from collections.abc import Iterator
from itertools import combinations

import numpy as np

from sdt_kg.annotation import Gripper, RobotAnnotation
from sdt_kg.describe.base import RISE_TIME, guessed_base
from sdt_kg.describe.grippers import guessed_grippers, lonely_fingers
from sdt_kg.describe.tree import Tree, listed
from sdt_kg.describe.ungripped import why_none
from sdt_kg.describe.wheels import ALONG
from sdt_kg.mechanism import Joint, JointType, Mechanism

SPAN = 0.05
"""[1] Share by which the strokes of a telescope's segments may differ."""

BEYOND = 1e-3
"""[rad or m] By so much a joint may be taken beyond its limits by rounding."""


def guessed(mechanism: Mechanism) -> RobotAnnotation:
    """What is guessed without any physics: each guess has a note that says `check`.

    Nothing is parked but at 0, and only fingers of one gripper may touch each other.
    """
    tree = Tree(mechanism)
    grippers = tuple(guessed_grippers(tree))
    arms = frozenset(_arms(tree, grippers))
    base = guessed_base(tree, arms)
    held, moved, still = _divided(mechanism, arms - set(base.planar))
    coupled = tuple(telescopes(tree, moved))
    notes = (
        *base.notes,
        *_of_grippers(tree, grippers),
        *(f"check: one motor drives the telescope {listed(each)} (sdt:hasCoupling)" for each in coupled),
        f"check: acceleration limits let each joint reach its highest speed in {RISE_TIME} s",
        "check: joints that move no gripper are held",
        *_of_still(still),
        *_of_followers(mechanism, moved, grippers),
    )
    return RobotAnnotation(
        robot=mechanism.name,
        drive=base.drive,
        base_body=base.body,
        base_height=base.height,
        base_limits=base.limits,
        grippers=grippers,
        parked={},
        held=tuple(held),
        acceleration={joint.name: joint.limits.velocity / RISE_TIME for joint in moved},
        coupled=coupled,
        allowed_contacts=frozenset(
            frozenset(pair) for gripper in grippers for pair in combinations(gripper.fingers, 2)
        ),
        overhang=0.0,
        notes=notes,
        base_notes=base.speed_notes,
    )


def _arms(tree: Tree, grippers: tuple[Gripper, ...]) -> Iterator[str]:
    """Joints that move a gripper or its fingers; what hangs on fixed ones stands."""
    for gripper in grippers:
        yield from (finger.joint for finger in gripper.finger_joints)
        above = tree.ancestors(gripper.tool_body)
        yield from (joint.name for joint in above if joint.type is not JointType.FIXED)


def _divided(mechanism: Mechanism, arms: frozenset[str]) -> tuple[list[str], list[Joint], list[str]]:
    """Joints that are held, those that planning moves, and those held as they have no speed."""
    own = [joint for joint in mechanism.joints if joint.type is not JointType.FIXED and joint.mimic is None]
    moved = [joint for joint in own if joint.name in arms and 0 < joint.limits.velocity < math.inf]
    still = [joint.name for joint in own if joint.name in arms and joint not in moved]
    return [joint.name for joint in own if joint not in moved], moved, still


def telescopes(tree: Tree, joints: list[Joint]) -> Iterator[tuple[str, ...]]:
    """Sliding joints in a row along one line, with strokes of the same length."""
    row: list[Joint] = []
    for joint in joints:
        if row and not _goes_on(tree, row[-1], joint):
            yield from [tuple(each.name for each in row)] if len(row) > 1 else []
            row = []
        if joint.type is JointType.PRISMATIC:
            row.append(joint)
    if len(row) > 1:
        yield tuple(each.name for each in row)


def _goes_on(tree: Tree, last: Joint, joint: Joint) -> bool:
    spans = [each.limits.upper - each.limits.lower for each in (last, joint)]
    return (
        joint.type is JointType.PRISMATIC
        and tree.rigid_root(joint.parent) == tree.rigid_root(last.child)
        and float(tree.axis(last) @ tree.axis(joint)) > ALONG
        and bool(np.ptp(spans) <= SPAN * max(spans))
    )


def _of_grippers(tree: Tree, grippers: tuple[Gripper, ...]) -> Iterator[str]:
    for gripper in grippers:
        yield (
            f"check: gripper '{gripper.name}' is body '{gripper.tool_body}' with fingers "
            f"{listed(gripper.fingers)}, {gripper.opening:.3f} m apart when open: it, its tool frame "
            "(x out of the palm, y from finger to finger) and its positions are guessed from names and shapes"
        )
        still = tuple(
            body for body in gripper.fingers if tree.rigid_root(body) == tree.rigid_root(gripper.tool_body)
        )
        if still:
            yield (
                f"check: {listed(still)} of gripper '{gripper.name}' stands still: the hand brings it to a "
                "bar, from beside it, before the others close"
            )
    for joint in lonely_fingers(tree):
        yield (
            f"check: '{joint}' moves a single finger, and no body fixed to its palm is named as the other: "
            "give that a link of its own with 'finger' in its name, or add the gripper with sdt:hasGripper"
        )
    if not grippers:
        yield why_none(tree)


def _of_still(joints: list[str]) -> Iterator[str]:
    if joints:
        yield (
            f"check: {listed(joints)} would move a gripper, but have no velocity limit above 0 in the "
            "URDF and are held: give one there, and describe the robot again"
        )


def _of_followers(mechanism: Mechanism, moved: list[Joint], grippers: tuple[Gripper, ...]) -> Iterator[str]:
    """Joints that would be taken beyond their own limits by one that they follow."""
    ranges = {joint.name: (joint.limits.lower, joint.limits.upper) for joint in moved}
    ranges |= {each.joint: (each.closed, each.open) for gripper in grippers for each in gripper.finger_joints}
    for joint in mechanism.joints:
        if joint.mimic is None or joint.mimic.joint not in ranges:
            continue
        own, mimic = joint.limits, joint.mimic
        low, high = sorted(mimic.multiplier * end + mimic.offset for end in ranges[mimic.joint])
        if low < own.lower - BEYOND or high > own.upper + BEYOND:
            yield (
                f"check: '{joint.name}' follows '{mimic.joint}' from {low:.3g} to {high:.3g}, beyond its own "
                f"limits {own.lower:.3g} to {own.upper:.3g}: no motion is certified that takes it there. "
                "Repair its mimic or its limits in the URDF"
            )
