"""Pairs allowed because they were proved apart: the proof, run again where it takes seconds.

Two links are apart over a cell of joint values if their meshes' distance at its centre is greater than
what any point can travel to its border; else the cell is halved. The elbow and the palm of the PR2 and the
pitch bracket of Stretch take minutes and are not repeated. Of two arms one is looked at here, the other by
`make soak`.
"""

import math
from dataclasses import dataclass

import coal
import numpy as np
import pinocchio as pin
import pytest

from tests.robots.conftest import Robot
from tests.robots.shapes import Array

pytestmark = pytest.mark.reference

MOST_CELLS = 100_000
PAIRS = {
    "pr2": [
        ("base_link", "{side}_shoulder_pan_link"),
        ("torso_lift_link", "{side}_shoulder_lift_link"),
        ("torso_lift_link", "{side}_upper_arm_link"),
    ],
    "tiago_dual": [
        ("arm_{side}_5_link", "gripper_{side}_link"),
        ("torso_lift_link", "arm_{side}_2_link"),
        ("arm_{side}_1_link", "arm_{side}_3_link"),
    ],
    "stretch": [("link_lift", "link_arm_l0"), ("link_wrist_yaw_bottom", "link_wrist_roll")],
}
LEFT = {"pr2": "l", "tiago_dual": "left", "stretch": ""}
RIGHT = {"pr2": "r", "tiago_dual": "right"}


def surface(robot: Robot, link: str) -> tuple[coal.BVHModelOBBRSS, float]:
    """Triangles of a link's meshes, and the greatest distance of a vertex from the link's origin."""
    triangles = np.concatenate([mesh.triangles for mesh in robot.links.meshes(link)])
    points = triangles.reshape(-1, 3)
    vertices, faces = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for point in points:
        vertices.append(np.array(point))
    for i in range(0, len(points), 3):
        faces.append(coal.Triangle(i, i + 1, i + 2))
    model = coal.BVHModelOBBRSS()
    model.beginModel(len(triangles), len(points))
    model.addSubModel(vertices, faces)
    model.endModel()
    return model, float(np.linalg.norm(points, axis=1).max())


def joints_above(model: pin.Model, link: str) -> list[int]:
    joint, found = model.frames[model.getFrameId(link)].parentJoint, []
    while joint > 0:
        found.append(joint)
        joint = model.parents[joint]
    return found


@dataclass(frozen=True)
class Between:
    """A joint between two links: range, and travel [m] of the farthest point for each unit of it."""

    name: str
    low: float
    high: float
    travel: float


def between(robot: Robot, link: str, other: str, radius: float) -> list[Between]:
    """Joints which move the link but not the other."""
    model, found = robot.model, []
    reach = radius + float(np.linalg.norm(model.frames[model.getFrameId(link)].placement.translation))
    for joint in joints_above(model, link):
        if joint in joints_above(model, other):
            break
        place, count = robot.places[model.names[joint]]
        low, high = (
            (-math.pi, math.pi)
            if count == 2
            else (model.lowerPositionLimit[place], model.upperPositionLimit[place])
        )
        prismatic = "P" in model.joints[joint].shortname()
        found.append(Between(model.names[joint], low, high, 1.0 if prismatic else reach))
        reach += float(np.linalg.norm(model.jointPlacements[joint].translation)) + prismatic * max(
            abs(low), abs(high)
        )
    return found


def clearance(robot: Robot, one: str, two: str) -> tuple[float, int]:
    """Least distance seen in a finished proof, and its cells; fails where the meshes touch."""
    (mesh, radius), (other, size) = surface(robot, one), surface(robot, two)
    joints = between(robot, one, two, radius) + between(robot, two, one, size)
    travel = np.array([joint.travel for joint in joints])
    cells: list[tuple[Array, Array]] = [
        (np.array([j.low for j in joints]), np.array([j.high for j in joints]))
    ]
    least, count = math.inf, 0
    while cells:
        low, high = cells.pop()
        count += 1
        assert count <= MOST_CELLS, (one, two)
        middle = (low + high) / 2
        frames = robot.frames({j.name: float(v) for j, v in zip(joints, middle, strict=True)}, [one, two])
        poses = [coal.Transform3s(frames[link][:3, :3], frames[link][:3, 3]) for link in (one, two)]
        distance = coal.distance(
            mesh, poses[0], other, poses[1], coal.DistanceRequest(), coal.DistanceResult()
        )
        assert distance > 0, (one, two, middle)
        if distance > float(travel @ (high - low)) / 2:
            least = min(least, distance)
            continue
        axis = int(np.argmax(travel * (high - low)))
        left, right = high.copy(), low.copy()
        left[axis] = right[axis] = middle[axis]
        cells += [(low, left), (right, high)]
    return least, count


def assert_apart(robot: Robot, theirs: Robot, side: str) -> None:
    """The pairs of that arm may touch, and their meshes in the reference are proved apart."""
    allowed = {frozenset(pair) for pair in robot.named("mayTouch")}
    for pair in PAIRS[robot.name]:
        one, two = (link.format(side=side) for link in pair)
        assert frozenset((one, two)) in allowed
        least, count = clearance(theirs, one, two)
        assert least > 0.002, (one, two)
        assert count > 1


def test_allowed_pairs_are_apart_in_the_reference(robot: Robot, theirs: Robot) -> None:
    assert_apart(robot, theirs, LEFT[robot.name])


@pytest.mark.parametrize("robot", RIGHT, indirect=True)
def test_the_same_pairs_of_the_other_arm_may_touch(robot: Robot) -> None:
    allowed = {frozenset(pair) for pair in robot.named("mayTouch")}
    for pair in PAIRS[robot.name]:
        assert frozenset(link.format(side=RIGHT[robot.name]) for link in pair) in allowed
