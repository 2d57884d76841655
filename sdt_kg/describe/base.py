"""The base guessed from a robot's wheels: how it drives, how fast, and how high its root frame is."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import Final

import numpy as np

from sdt_kg.annotation import BaseLimits, Drive
from sdt_kg.describe.tree import Matrix, Tree, listed
from sdt_kg.mechanism import Joint, JointType

BASE_SPEED: Final = 0.2
"""[m/s, rad/s] Speed of the base in the paper's experiment."""

RISE_TIME: Final = 0.5
"""[s] A joint or base is assumed to reach its highest speed in this time."""

ALONG: Final = 0.95
"""[1] Least cosine between directions that count as the same: 18°."""

ONE_LINE: Final = 0.01
"""[m] Wheels whose axes are less apart turn about one line."""

NEAR_FLOOR: Final = 0.05
"""[m] A wheel's lowest point is at most so much above that of the lowest: some hang on springs."""

LEVEL: Final = 0.002
"""[m] A root frame that is less above the floor or below it counts as on it."""

TURNING: Final = (JointType.REVOLUTE, JointType.CONTINUOUS)

SIDEWAYS: Final = ("mecanum", "omni", "swedish")
"""In the names of wheels that also roll sideways."""


@dataclass(frozen=True, slots=True)
class Base:
    """How the base moves.

    Attributes:
        planar: Joints of the model that stand for the drive: the annotation's base replaces them.
        height: Of the root frame above the floor [m].
        limits: Its speeds.
        notes: What was guessed, and from what.
    """

    drive: Drive
    planar: tuple[str, ...]
    height: float
    limits: BaseLimits
    notes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _Wheel:
    """A wheel with all joints at 0: a point of its axis and the axis, in the root frame."""

    name: str
    centre: Matrix
    axis: Matrix
    lowest: float
    steering: Joint | None


def guessed_base(tree: Tree, arms: frozenset[str]) -> Base:
    """The base of a robot whose joints `arms` carry grippers."""
    planar = _planar(tree)
    wheels = [] if planar else _wheels(tree, arms)
    drive, why = (Drive.OMNI, listed(planar)) if planar else _drive(wheels)
    height = _height(tree, arms - set(planar))
    linear, angular = _speeds(tree, planar)
    limits = BaseLimits(linear, angular, linear / RISE_TIME, angular / RISE_TIME)
    reason = f"joints {why} stand for the drive and are held" if planar else why
    kind = f"sdt:{drive.value.capitalize()}"
    notes = (
        f"check: the base is taken to be {kind}: {reason} (sdt:Omni, sdt:Differential or sdt:Fixed)",
        f"check: base speed {linear:g} m/s and {angular:g} rad/s, reached in {RISE_TIME} s",
        f"check: its root frame is {height:.3f} m above the floor, its lowest point on it (sdt:baseHeight)",
    )
    return Base(drive, planar, height, limits, notes)


def _planar(tree: Tree) -> tuple[str, ...]:
    """Joints from the root on that move the whole robot in the plane: x, y and yaw, in any order."""
    found: list[Joint] = []
    body = tree.mechanism.root
    while not len(tree.points([body], body, {})) and len(tree.children[body]) == 1:
        (joint,) = tree.children[body]
        body = joint.child
        if joint.type is JointType.FIXED:
            continue
        upright = abs(tree.axis(joint)[2])
        slides = joint.type is JointType.PRISMATIC
        if upright > 1 - ALONG if slides else upright < ALONG:
            break
        found.append(joint)
    sliding = [tree.axis(joint) for joint in found if joint.type is JointType.PRISMATIC]
    across = len(sliding) == 2 and abs(sliding[0] @ sliding[1]) < 1 - ALONG
    return tuple(joint.name for joint in found) if across and len(found) == 3 else ()


def _wheels(tree: Tree, arms: frozenset[str]) -> list[_Wheel]:
    """Bodies that turn without end about a level axis, near the floor."""
    found = [
        _wheel(tree, joint)
        for joint in tree.mechanism.joints
        if joint.type is JointType.CONTINUOUS
        and joint.name not in arms
        and abs(tree.axis(joint)[2]) < 1 - ALONG
        and ("wheel" in joint.child.lower() or len(tree.points(tree.below(joint.child), joint.child, {})))
    ]
    lowest = min((wheel.lowest for wheel in found), default=0.0)
    return [wheel for wheel in found if wheel.lowest <= lowest + NEAR_FLOOR]


def _wheel(tree: Tree, joint: Joint) -> _Wheel:
    root = tree.mechanism.root
    turning = [each for each in tree.ancestors(joint.parent) if each.type in TURNING]
    steering = next((each for each in turning if abs(tree.axis(each)[2]) > ALONG), None)
    centre = tree.frame(joint.child, root, {})[:3, 3]
    lowest = min(tree.lowest(tree.below(joint.child)), float(centre[2]))
    return _Wheel(joint.child, centre, tree.axis(joint), lowest, steering)


def _drive(wheels: list[_Wheel]) -> tuple[Drive, str]:
    """The drive and why, in words."""
    rigid = [wheel for wheel in wheels if wheel.steering is None]
    steered = {wheel.steering.name: wheel.steering for wheel in wheels if wheel.steering is not None}
    limited = [name for name, joint in steered.items() if joint.type is not JointType.CONTINUOUS]
    if not wheels:
        return (
            Drive.FIXED,
            "no wheel was found, a body that turns without end about a level axis near the floor",
        )
    if limited:
        return Drive.FIXED, f"{listed(limited)} steer like a car's, and no drive here is a car's"
    return _of_rigid(rigid) if rigid else (Drive.OMNI, f"all wheels steer without end ({listed([*steered])})")


def _of_rigid(wheels: list[_Wheel]) -> tuple[Drive, str]:
    """The drive of wheels that do not steer."""
    pairs = list(combinations(wheels, 2))
    names = listed([wheel.name for wheel in wheels])
    if any(word in wheel.name.lower() for wheel in wheels for word in SIDEWAYS):
        return Drive.OMNI, f"wheels {names} are named as ones that roll sideways too"
    if any(abs(one.axis @ other.axis) < ALONG for one, other in pairs):
        return Drive.OMNI, f"wheels {names} roll in several directions"
    if abs(wheels[0].axis[1]) < ALONG:
        return Drive.FIXED, (
            f"wheels {names} roll across x of the root frame, and sdt:Differential goes along x: "
            "give a body that is turned that way as sdt:baseBody"
        )
    if len(wheels) > 1 and all(_one_line(one, other) for one, other in pairs):
        return Drive.DIFFERENTIAL, f"wheels {names} turn about one line"
    return Drive.DIFFERENTIAL, f"wheels {names} do not steer; if they roll sideways too, it is sdt:Omni"


def _one_line(one: _Wheel, other: _Wheel) -> bool:
    apart = other.centre - one.centre
    return float(np.linalg.norm((apart - (apart @ one.axis) * one.axis)[:2])) < ONE_LINE


def _height(tree: Tree, arms: frozenset[str]) -> float:
    """Of the root frame above the lowest point of what no arm moves [m]; 0 where nothing is below it.

    Where the lowest shape is above the root frame, wheels or feet have no shapes.
    """
    lowest = tree.lowest(_standing(tree, tree.mechanism.root, arms))
    return round(-lowest, 4) if lowest < -LEVEL else 0.0


def _standing(tree: Tree, body: str, arms: frozenset[str]) -> Iterator[str]:
    yield body
    for joint in tree.children[body]:
        if joint.name not in arms:
            yield from _standing(tree, joint.child, arms)


def _speeds(tree: Tree, planar: tuple[str, ...]) -> tuple[float, float]:
    """Of the joints that stand for the drive, else the paper's [m/s, rad/s]."""
    joints = [tree.mechanism.joint(name) for name in planar]
    sliding = [joint.limits.velocity for joint in joints if joint.type is JointType.PRISMATIC]
    turning = [joint.limits.velocity for joint in joints if joint.type is not JointType.PRISMATIC]
    linear, angular = min(sliding, default=math.inf), min(turning, default=math.inf)
    return _given(linear), _given(angular)


def _given(speed: float) -> float:
    return speed if math.isfinite(speed) and speed > 0 else BASE_SPEED
