"""Grippers guessed from a robot's structure and names: fingers that face each other under a palm."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import Final

import numpy as np

from sdt_kg.annotation import FingerJoint, Gripper
from sdt_kg.describe.tree import Matrix, Tree
from sdt_kg.mechanism import Joint, JointType, Pose
from sdt_kg.urdf import quaternion

FINGER_WORDS: Final = ("finger", "gripper", "jaw", "claw", "thumb")
BISECTIONS: Final = 40
"""Halvings of the way from open to shut: below a micrometre."""

ROOM: Final = 0.09
"""[m] A gripper opens so far, if it can: those of the bundled robots open by 85 to 92 mm."""

TIP_SHARE: Final = 1 / 3
"""The tip is the outer third of a finger."""

MAX_JOINTS_BELOW: Final = 2
"""A finger has at most that many further joints, its tip's say."""


Positions = dict[str, float]


@dataclass(frozen=True, slots=True)
class _Finger:
    """A finger: its first joint and all its bodies."""

    joint: Joint
    bodies: tuple[str, ...]


def guessed_grippers(tree: Tree) -> list[Gripper]:
    """One gripper for each palm under which at least two fingers face each other."""
    by_palm: dict[str, list[_Finger]] = {}
    for finger in _fingers(tree):
        by_palm.setdefault(tree.rigid_root(finger.joint.parent), []).append(finger)
    palms = {palm: fingers for palm, fingers in by_palm.items() if len(fingers) > 1}
    names = _names(list(palms))
    grippers = [_gripper(tree, names[palm], palm, fingers) for palm, fingers in palms.items()]
    return [gripper for gripper in grippers if gripper is not None]


def _fingers(tree: Tree) -> Iterator[_Finger]:
    for joint in tree.mechanism.joints:
        if joint.type not in (JointType.PRISMATIC, JointType.REVOLUTE):
            continue
        named = any(word in f"{joint.name} {joint.child}".lower() for word in FINGER_WORDS)
        if named and tree.movable_below(joint.child) <= MAX_JOINTS_BELOW:
            bodies = tuple(tree.below(joint.child))
            if len(tree.points(bodies, joint.child, {})):
                yield _Finger(joint, bodies)


def _names(palms: list[str]) -> dict[str, str]:
    """`left` and `right` where the palms' names say so, `gripper` for a single one, else the palm's name."""
    if len(palms) == 1:
        return {palms[0]: "gripper"}
    sides = {palm: _side(palm) for palm in palms}
    unique = len({side for side in sides.values() if side}) == len(palms)
    return {palm: sides[palm] if unique else palm for palm in palms}


def _side(palm: str) -> str:
    words = palm.lower().split("_")
    for side in ("left", "right"):
        if side in words or side[0] in words:
            return side
    return ""


def _gripper(tree: Tree, name: str, palm: str, fingers: list[_Finger]) -> Gripper | None:
    free = [finger.joint for finger in fingers if finger.joint.mimic is None]
    pairs = [_Pair(tree, palm, one, other) for one, other in combinations(fingers, 2)]
    at_lower = {joint.name: joint.limits.lower for joint in free}
    at_upper = {joint.name: joint.limits.upper for joint in free}
    pair = max(pairs, key=lambda each: max(each.gap(at_lower), each.gap(at_upper)))
    opens_up = pair.gap(at_upper) >= pair.gap(at_lower)
    is_open, is_shut = (at_upper, at_lower) if opens_up else (at_lower, at_upper)
    opening = pair.gap(is_open)
    if not free or opening <= 0:
        return None
    is_closed = _reached(pair, is_open, is_shut, 0.0)
    if opening > ROOM:
        # As wide as the limit allows, fingers meet what is beside a handle, and their tips are drawn back.
        is_open = _reached(pair, is_open, is_shut, ROOM)
        opening = pair.gap(is_open)
    return Gripper(
        name=name,
        tool_body=palm,
        tool=pair.tool(is_open),
        fingers=tuple(sorted({body for finger in fingers for body in finger.bodies})),
        finger_joints=tuple(
            FingerJoint(joint.name, is_open[joint.name], is_closed[joint.name]) for joint in free
        ),
        opening=opening,
    )


def _reached(pair: "_Pair", is_open: Positions, is_shut: Positions, wanted: float) -> Positions:
    """Where the gap of the tips comes down to so much [m] on the way from open to shut, or shut."""

    def between(share: float) -> Positions:
        return {name: is_open[name] + share * (is_shut[name] - is_open[name]) for name in is_open}

    if pair.gap(is_shut, is_open) >= wanted:
        return is_shut
    low, high = 0.0, 1.0
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        low, high = (middle, high) if pair.gap(between(middle), is_open) > wanted else (low, middle)
    return between(low)


@dataclass(frozen=True, slots=True)
class _Pair:
    """Two fingers of a palm; all positions are in the palm's frame."""

    tree: Tree
    palm: str
    one: _Finger
    other: _Finger

    def points(self, positions: Positions) -> tuple[Matrix, Matrix]:
        """Corners of either finger [m]."""
        return (
            self.tree.points(self.one.bodies, self.palm, positions),
            self.tree.points(self.other.bodies, self.palm, positions),
        )

    def axes(self, positions: Positions) -> tuple[Matrix, Matrix]:
        """Unit vectors out of the palm and across, from one finger to the other."""
        one, other = self.points(positions)
        across = _unit(other.mean(axis=0) - one.mean(axis=0))
        rigid = [body for body in self.tree.below(self.palm) if self.tree.rigid_root(body) == self.palm]
        palm = self.tree.points(rigid, self.palm, positions)
        roots = [
            self.tree.frame(finger.joint.child, self.palm, positions)[:3, 3]
            for finger in (self.one, self.other)
        ]
        behind = palm.mean(axis=0) if len(palm) else np.mean(roots, axis=0)
        out = np.concatenate((one, other)).mean(axis=0) - behind
        return _unit(out - (out @ across) * across), across

    def gap(self, positions: Positions, seen_from: Positions | None = None) -> float:
        """Free width between the tips [m], negative where they overlap.

        Args:
            positions: Of the finger joints.
            seen_from: Positions whose axes are used, so that crossed fingers have a negative gap.
        """
        out, across = self.axes(positions if seen_from is None else seen_from)
        one, other = (_tip(points, out) for points in self.points(positions))
        return float((other @ across).min() - (one @ across).max())

    def tool(self, positions: Positions) -> Pose:
        """Between the tips: x out of the palm, y across."""
        out, across = self.axes(positions)
        tips = np.concatenate([_tip(points, out) for points in self.points(positions)])
        x, y, z = (float(part) for part in (tips.min(axis=0) + tips.max(axis=0)) / 2)
        rotation = np.column_stack((out, across, np.cross(out, across))).astype(np.float64)
        return Pose((x, y, z), quaternion(rotation))


def _tip(points: Matrix, out: Matrix) -> Matrix:
    """The points in the outer part of a finger."""
    reach = points @ out
    return points[reach >= reach.max() - TIP_SHARE * np.ptp(reach)]


def _unit(vector: Matrix) -> Matrix:
    length = float(np.linalg.norm(vector))
    return vector / length if length > 0 else np.array((1.0, 0.0, 0.0))
