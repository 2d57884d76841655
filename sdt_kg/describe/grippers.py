"""Grippers guessed from a robot's structure and names: fingers that face each other under a palm."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
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

BEHIND: Final = 0.02
"""[m] A bar is held so far behind the ends of closed fingers, as with the bundled robots (19 to 20 mm)."""

TIP_SHARE: Final = 1 / 3
"""The tip is the outer third of a finger."""

MAX_JOINTS_BELOW: Final = 2
"""A finger has at most that many further joints, its tip's say."""

ARM: Final = 3
"""Bodies that are not named like fingers count as such at the end of an arm of at least so many joints."""

EQUAL_REACH: Final = 0.02
"""[m] Of fingers that reach about as far out of the palm, those farthest apart hold the handle."""


Positions = dict[str, float]


@dataclass(frozen=True, slots=True)
class _Finger:
    """A finger: its first body, all its bodies, and the joint that moves it; None where it stands still."""

    body: str
    bodies: tuple[str, ...]
    joint: Joint | None


def guessed_grippers(tree: Tree) -> list[Gripper]:
    """One gripper for each palm under which two fingers face each other, one of which moves at least."""
    by_palm: dict[str, list[_Finger]] = {}
    for finger, palm in _fingers(tree):
        by_palm.setdefault(palm, []).append(finger)
    palms = {palm: _facing(tree, palm, fingers) for palm, fingers in by_palm.items()}
    palms = {palm: fingers for palm, fingers in palms.items() if len(fingers) > 1}
    names = _names(list(palms))
    grippers = [_gripper(tree, names[palm], palm, fingers) for palm, fingers in palms.items()]
    return [gripper for gripper in grippers if gripper is not None]


def lonely_fingers(tree: Tree) -> list[str]:
    """Joints named like a finger's that move the only finger of their palm."""
    by_palm: dict[str, list[_Finger]] = {}
    for finger, palm in _fingers(tree):
        by_palm.setdefault(palm, []).append(finger)
    return [
        fingers[0].joint.name
        for palm, fingers in by_palm.items()
        if fingers[0].joint is not None and len(_facing(tree, palm, fingers)) == 1
    ]


def _fingers(tree: Tree) -> Iterator[tuple[_Finger, str]]:
    """Fingers that move, each with its palm; no palm with fingers of its own, nothing that hangs on one."""
    like = {
        joint.child: tree.rigid_root(joint.parent)
        for joint in tree.mechanism.joints
        if _like_finger(tree, joint)
    }
    inside: set[str] = set()
    for joint in tree.mechanism.joints:
        if joint.child not in like or joint.child in inside:
            continue
        bodies = tuple(tree.below(joint.child))
        palms = [like[body] for body in bodies[1:] if body in like]
        if len(set(palms)) == len(palms) and len(tree.points(bodies, joint.child, {})):
            inside.update(bodies)
            yield _Finger(joint.child, bodies, joint), like[joint.child]


def _like_finger(tree: Tree, joint: Joint) -> bool:
    """By its name; or it is one of several at the end of an arm."""
    if joint.type not in (JointType.PRISMATIC, JointType.REVOLUTE):
        return False
    if tree.movable_below(joint.child) > MAX_JOINTS_BELOW:
        return False
    if is_named(joint.name, joint.child):
        return True
    palm = tree.rigid_root(joint.parent)
    beside = [
        other
        for other in tree.mechanism.joints
        if other.type is not JointType.FIXED and tree.rigid_root(other.parent) == palm
    ]
    short = all(tree.movable_below(other.child) <= MAX_JOINTS_BELOW for other in beside)
    return len(beside) > 1 and short and tree.movable_above(palm) >= ARM


def is_named(*names: str) -> bool:
    """Whether one of the names is that of a finger."""
    return any(word in name.lower() for name in names for word in FINGER_WORDS)


def _facing(tree: Tree, palm: str, fingers: list[_Finger]) -> list[_Finger]:
    """The fingers; for a single one also the body fixed to the palm that is named like a finger."""
    if len(fingers) > 1:
        return fingers
    still = [
        joint.child
        for body in tree.below(palm)
        for joint in tree.children[body]
        if joint.type is JointType.FIXED
        and tree.rigid_root(joint.child) == palm
        and is_named(joint.child)
        and len(tree.points([joint.child], joint.child, {}))
    ]
    return [*fingers, *(_Finger(body, (body,), None) for body in still)]


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
    free = _motors(tree, fingers)
    if not all(math.isfinite(joint.limits.upper - joint.limits.lower) for joint in free):
        return None
    if any(palm in tree.below(joint.child) for joint in free):
        return None  # fingers that follow a wrist close only as it turns, and the hand with it
    pairs = [_Pair(tree, palm, one, other) for one, other in combinations(fingers, 2)]
    middle = {joint.name: (joint.limits.lower + joint.limits.upper) / 2 for joint in free}
    pair = _holding(pairs, middle)
    is_open = {joint.name: _end(joint, pairs, middle) for joint in free}
    is_shut = {joint.name: joint.limits.lower + joint.limits.upper - is_open[joint.name] for joint in free}
    opening = pair.gap(is_open)
    if not free or opening <= 0 or opening - pair.gap(is_shut, is_open) <= 0:
        return None
    is_closed = _reached(pair, is_open, is_shut, 0.0)
    if opening > ROOM:
        # As wide as the limit allows, fingers meet what is beside a handle, and their tips are drawn back.
        is_open = _reached(pair, is_open, is_shut, ROOM)
        opening = pair.gap(is_open)
    return Gripper(
        name=name,
        tool_body=palm,
        tool=pair.tool(is_closed, is_open),
        fingers=tuple(sorted({body for finger in fingers for body in finger.bodies})),
        finger_joints=tuple(
            FingerJoint(joint.name, is_open[joint.name], is_closed[joint.name]) for joint in free
        ),
        opening=opening,
    )


def _motors(tree: Tree, fingers: list[_Finger]) -> list[Joint]:
    """The joints that move the fingers: their own, or those that these follow, as far as these let them."""
    own = [finger.joint for finger in fingers if finger.joint is not None]
    names = [joint.name if joint.mimic is None else joint.mimic.joint for joint in own]
    return [_within(tree.mechanism.joint(name), own) for name in dict.fromkeys(names)]


def _within(motor: Joint, fingers: Iterable[Joint]) -> Joint:
    """The motor's joint, its limits those at which all that follow it are within theirs."""
    lower, upper = motor.limits.lower, motor.limits.upper
    for joint in fingers:
        if joint.mimic is not None and joint.mimic.joint == motor.name and joint.mimic.multiplier:
            ends = (
                (end - joint.mimic.offset) / joint.mimic.multiplier
                for end in (joint.limits.lower, joint.limits.upper)
            )
            first, last = sorted(ends)
            lower, upper = max(lower, first), min(upper, last)
    return replace(motor, limits=replace(motor.limits, lower=lower, upper=max(lower, upper)))


def _holding(pairs: list["_Pair"], positions: Positions) -> "_Pair":
    """Of the pairs that reach farthest out of the palm the one that is farthest apart."""
    reach = [pair.reach(positions) for pair in pairs]
    far = [pair for pair, each in zip(pairs, reach, strict=True) if each >= max(reach) - EQUAL_REACH]
    return max(far, key=lambda pair: pair.gap(positions))


def _end(joint: Joint, pairs: list["_Pair"], middle: Positions) -> float:
    """The limit at which fingers are farther apart, the other joints in the middle of theirs."""
    lower, upper = (
        sum(pair.gap(middle | {joint.name: limit}, middle) for pair in pairs)
        for limit in (joint.limits.lower, joint.limits.upper)
    )
    return joint.limits.lower if lower > upper else joint.limits.upper


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
            self.tree.frame(finger.body, self.palm, positions)[:3, 3] for finger in (self.one, self.other)
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

    def reach(self, positions: Positions, out: Matrix | None = None) -> float:
        """How far out of the palm's frame the shorter of both reaches [m]."""
        out = self.axes(positions)[0] if out is None else out
        return min(float((points @ out).max()) for points in self.points(positions))

    def tool(self, closed: Positions, opened: Positions) -> Pose:
        """Between closed tips, a little behind their ends; x out of the palm, y across, as seen when open."""
        out, across = self.axes(opened)
        tips = np.concatenate([_tip(points, out) for points in self.points(closed)])
        middle = (tips.min(axis=0) + tips.max(axis=0)) / 2
        length = min(float(np.ptp(points @ out)) for points in self.points(closed))
        behind = self.reach(closed, out) - min(BEHIND, length / 2)
        x, y, z = (float(part) for part in middle + (behind - middle @ out) * out)
        rotation = np.column_stack((out, across, np.cross(out, across))).astype(np.float64)
        return Pose((x, y, z), quaternion(rotation))


def _tip(points: Matrix, out: Matrix) -> Matrix:
    """The points in the outer part of a finger."""
    reach = points @ out
    return points[reach >= reach.max() - TIP_SHARE * np.ptp(reach)]


def _unit(vector: Matrix) -> Matrix:
    length = float(np.linalg.norm(vector))
    return vector / length if length > 0 else np.array((1.0, 0.0, 0.0))
