"""The base guessed from a robot's wheels: how it drives, how fast, and how high its root frame is."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import Final

from sdt_kg.annotation import FASTEST, BaseLimits, Drive
from sdt_kg.describe.tree import Tree, listed
from sdt_kg.describe.wheels import (
    ALONG,
    STRAIGHT,
    Wheel,
    axle_ahead,
    fixed_wheels,
    lying_wheels,
    on_one_line,
    rolls_sideways,
    wheels,
)
from sdt_kg.mechanism import Joint, JointType

BASE_SPEED: Final = 0.2
"""[m/s, rad/s] Speed of the base in the paper's experiment."""

RISE_TIME: Final = 0.5
"""[s] A joint or base is assumed to reach its highest speed in this time."""

LEVEL: Final = 0.002
"""[m] A root frame that is less above the floor or below it counts as on it."""

LYING: Final = (
    "; {} turn about an upright line, so the robot probably lies on its side: z of the root frame has to be "
    "up, which a link above it with a fixed joint can give"
)


@dataclass(frozen=True, slots=True)
class Base:
    """How the base moves.

    Attributes:
        body: What stands for the base: the root, or what is rigidly attached to it amid the wheels.
        planar: Joints of the model that stand for the drive: the annotation's base replaces them.
        height: Of that body's frame above the floor [m].
        limits: Its speeds.
        notes: What was guessed, and from what.
        speed_notes: The same of its speeds.
    """

    drive: Drive
    body: str
    planar: tuple[str, ...]
    height: float
    limits: BaseLimits
    notes: tuple[str, ...]
    speed_notes: tuple[str, ...]


def guessed_base(tree: Tree, arms: frozenset[str]) -> Base:
    """The base of a robot whose joints `arms` carry grippers."""
    planar = _planar(tree)
    found = [] if planar else wheels(tree, arms)
    drive, why = (Drive.OMNI, listed(planar)) if planar else _drive(found)
    body = tree.mechanism.root
    if drive is Drive.DIFFERENTIAL:
        drive, why, body = _about_axle(tree, found, why)
    elif not (planar or found) and (lying := lying_wheels(tree)):
        why += LYING.format(listed(lying))
    elif not (planar or found) and (fixed := fixed_wheels(tree)):
        why += f"; {listed(fixed)} are named as wheels, and fixed: if it drives on them, say how"
    root_T_body = tree.frame(body, tree.mechanism.root, {})
    height = round(_height(tree, arms - set(planar)) + float(root_T_body[2, 3]), 4)
    linear, angular = _speeds(tree, planar)
    limits = BaseLimits(linear, angular, linear / RISE_TIME, angular / RISE_TIME)
    reason = f"joints {why} stand for the drive and are held" if planar else why
    kind = f"sdt:{drive.value.capitalize()}"
    where = "its root frame" if body == tree.mechanism.root else f"'{body}' (sdt:baseBody)"
    notes = (
        f"check: the base is taken to be {kind}: {reason} (sdt:Omni, sdt:Differential or sdt:Fixed)",
        f"check: {where} is {height:.3f} m above the floor, its lowest point on it (sdt:baseHeight)",
    )
    speeds = f"check: base speed {linear:g} m/s and {angular:g} rad/s, reached in {RISE_TIME} s"
    return Base(drive, body, planar, height, limits, notes, (speeds,))


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


def _drive(found: list[Wheel]) -> tuple[Drive, str]:
    """The drive and why, in words."""
    rigid = [wheel for wheel in found if wheel.steering is None]
    steered = {wheel.steering.name: wheel.steering for wheel in found if wheel.steering is not None}
    limited = [name for name, joint in steered.items() if joint.type is not JointType.CONTINUOUS]
    if not found:
        return (
            Drive.FIXED,
            "no wheel was found, a body that turns without end about a level axis near the floor",
        )
    if limited:
        return Drive.FIXED, f"{listed(limited)} steer like a car's, and no drive here is a car's"
    return _of_rigid(rigid) if rigid else (Drive.OMNI, f"all wheels steer without end ({listed([*steered])})")


def _of_rigid(found: list[Wheel]) -> tuple[Drive, str]:
    """The drive of wheels that do not steer."""
    pairs = list(combinations(found, 2))
    names = listed([wheel.name for wheel in found])
    if rolls_sideways(found):
        return Drive.OMNI, f"wheels {names} are named as ones that roll sideways too"
    if any(abs(one.axis @ other.axis) < ALONG for one, other in pairs):
        return Drive.OMNI, f"wheels {names} roll in several directions"
    if abs(found[0].axis[1]) < STRAIGHT:
        return Drive.FIXED, (
            f"wheels {names} roll across x of the root frame, and sdt:Differential goes along x: "
            "give a body that is turned that way as sdt:baseBody"
        )
    if on_one_line(found):
        return Drive.DIFFERENTIAL, f"wheels {names} turn about one line"
    return Drive.DIFFERENTIAL, f"wheels {names} do not steer; if they roll sideways too, it is sdt:Omni"


def _about_axle(tree: Tree, found: list[Wheel], why: str) -> tuple[Drive, str, str]:
    """The drive, why, and the body on the wheels' line: a differential base turns about a point of it."""
    root = tree.mechanism.root
    ahead = axle_ahead(tree, root, found)
    if ahead is None or abs(ahead) < LEVEL:
        return Drive.DIFFERENTIAL, why, root
    for body in tree.mechanism.bodies:
        ahead_and_up = tree.frame(body.name, root, {})[[0, 2], [0, 2]]
        if tree.rigid_root(body.name) != root or ahead_and_up.min() < STRAIGHT:
            continue
        own = axle_ahead(tree, body.name, found)
        if own is not None and abs(own) < LEVEL and abs(tree.frame(body.name, root, {})[1, 3]) < LEVEL:
            return Drive.DIFFERENTIAL, f"{why}, on which '{body.name}' lies (sdt:baseBody)", body.name
    return (
        Drive.FIXED,
        (
            f"{why}, {ahead:.3f} m before the root frame, and sdt:Differential turns about sdt:baseBody: "
            "give a link amid the wheels, with x ahead, and describe the robot again"
        ),
        root,
    )


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
    return _given(linear, FASTEST.linear_velocity), _given(angular, FASTEST.angular_velocity)


def _given(speed: float, most: float) -> float:
    return speed if 0 < speed <= most else BASE_SPEED
