"""The base of a robot as transforms of a ROS 2 bag: of which joint they are, and whether in a plane."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from sdt_kg.errors import MotionError
from sdt_kg.iri import Iri
from sdt_kg.mechanism import JointType, Mechanism
from sdt_kg.twin import Twin

UPRIGHT = 1e-3
"""[1] How far x and y of a base's quaternion, and its norm, may be from those of a turn about z."""

FLAT = 1e-3
"""[m, m/s or rad/s] How far a base may rise, and how fast leave the plane."""

Message = Any  # types of rosbags' messages are made at run time


def check_names(names: Sequence[str], twin: Twin, robot: Iri | None) -> None:
    """What the transforms are said to be of may be the base.

    A joint between world and base is in no model, and may be called anything. What is no base: a joint or
    body of the robot elsewhere than between its root and its base, and what moves in the kitchen.

    Raises:
        MotionError: It is something else.
    """
    base, other = set[str](), set[str]()
    if robot is not None:
        machine = twin.mechanism(robot)
        base = _to_the_base(machine, twin.robot(robot).base_body)
        other = {each.name for each in (*machine.joints, *machine.bodies)} - base
    kitchen = twin.mechanism(twin.environment)
    carriers = kitchen.carriers()
    moving = {each.name for each in kitchen.joints if each.type is not JointType.FIXED}
    moving |= {each.name for each in kitchen.bodies if carriers[each.name] != kitchen.root}
    name = next((each for each in names if each in other | (moving - base)), None)
    if name is not None:
        whose = f"a part of {twin.name(robot)}" if robot and name in other else "in the kitchen"
        raise MotionError(
            f"the base's transforms are of '{name}', which is {whose} and not the base",
            allowed="the joint between world and base, whatever it is called, or the base's body",
        )


def _to_the_base(robot: Mechanism, base_body: str) -> set[str]:
    """The robot's root, its base, and what is fixed between them."""
    above, found = {each.child: each for each in robot.joints}, {base_body}
    while base_body in above and above[base_body].type is JointType.FIXED:
        joint = above[base_body]
        base_body = joint.parent
        found |= {joint.name, base_body}
    return found


def check_plane(topic: str, heights: list[float], twists: list[Message]) -> None:
    """The base stays in its plane: only what is in it is read."""
    for k, height in enumerate(heights):
        if not abs(height - heights[0]) <= FLAT:
            said = f"z of the base is {height:.6g} m at sample {k} of {topic}"
            raise MotionError(said, allowed=f"{heights[0]:.6g} m, as at sample 0: a base moves in the plane")
    for k, each in enumerate(twists):
        out = {"linear z": each.linear.z, "angular x": each.angular.x, "angular y": each.angular.y}
        for name, speed in out.items():
            if not abs(speed) <= FLAT:
                said = f"{name} of the base's velocity is {speed:.6g} at sample {k} of {topic}"
                raise MotionError(said, allowed="0: a base moves in the plane, by linear x, y and angular z")


def planar(k: int, transform: Message) -> tuple[float, float, float]:
    """x, y, yaw of a transform that only moves in the plane and turns about z."""
    at, turn = transform.translation, transform.rotation
    norm = float(np.linalg.norm((turn.x, turn.y, turn.z, turn.w)))
    if abs(norm - 1) > UPRIGHT or max(abs(turn.x), abs(turn.y)) > UPRIGHT:
        raise MotionError(f"the base is tilted at sample {k}", allowed="a unit quaternion about z")
    return at.x, at.y, 2 * float(np.arctan2(turn.z, turn.w))
