"""Kinematics equal to the reference's; its collision meshes inside our shapes, and not much smaller."""

import numpy as np
import pytest
import trimesh

from tests.robots.conftest import SDT, Robot
from tests.robots.cover import uncovered
from tests.robots.shapes import Array, outside, volume

pytestmark = pytest.mark.reference

CONFIGURATIONS = 1000
POSE_TOLERANCE = 1e-6  # [m], and of each element of the rotation
SAMPLES = 3000  # of the surface of each mesh
TOUCH = 1e-6  # [m] a sample this near to a face of ours lies on it
INSIDE = 0.999  # of the samples, at least
OVERHANG = 0.001  # [m] of the rest, at most
TOOLS = {
    "pr2": [
        "l_gripper_tool_frame",
        "r_gripper_tool_frame",
        "l_gripper_r_finger_tip_link",
        "r_gripper_l_finger_tip_link",
    ],
    "tiago_dual": ["gripper_left_grasping_frame", "gripper_right_grasping_frame", "gripper_left_tool_link"],
    "stretch": ["link_grasp_center", "link_gripper_fingertip_left", "link_gripper_fingertip_right"],
}


def random_positions(robot: Robot, random: np.random.Generator) -> dict[str, float]:
    positions = {}
    for name in robot.model.names[1:]:
        place, count = robot.places[name]
        low, high = robot.model.lowerPositionLimit[place], robot.model.upperPositionLimit[place]
        positions[name] = float(random.uniform(-np.pi, np.pi) if count == 2 else random.uniform(low, high))
    return positions


def test_tool_frames_equal_the_reference(robot: Robot, theirs: Robot) -> None:
    random = np.random.default_rng(0)
    annotated = {tool for _, tool in robot.named("toolBody")}
    assert annotated <= set(TOOLS[robot.name])
    assert set(robot.model.names) == set(theirs.model.names)
    for _ in range(CONFIGURATIONS):
        positions = random_positions(robot, random)
        ours, reference = (model.frames(positions, TOOLS[robot.name]) for model in (robot, theirs))
        assert max(np.abs(ours[link] - reference[link]).max() for link in ours) < POSE_TOLERANCE


def test_limits_equal_the_reference(robot: Robot, theirs: Robot) -> None:
    for name in robot.model.names[1:]:
        ours, reference = (r.model.joints[r.model.getJointId(name)] for r in (robot, theirs))
        for bound in ("lowerPositionLimit", "upperPositionLimit"):
            mine, other = (
                getattr(robot.model, bound)[ours.idx_q],
                getattr(theirs.model, bound)[reference.idx_q],
            )
            assert mine == pytest.approx(other, abs=1e-9), name
        speed = robot.model.velocityLimit[ours.idx_v], theirs.model.velocityLimit[reference.idx_v]
        assert speed[0] == pytest.approx(speed[1]), name


def surface(mesh: trimesh.Trimesh) -> Array:
    return np.asarray(trimesh.sample.sample_surface(mesh, SAMPLES, seed=0)[0])


def test_meshes_lie_inside_our_shapes(robot: Robot, theirs: Robot) -> None:
    checked = 0
    for link in theirs.links.links:
        for mesh in theirs.links.meshes(link):
            beyond = outside(robot.links.shapes(link), surface(mesh))
            assert np.mean(beyond <= TOUCH) >= INSIDE, link
            assert beyond.max() <= OVERHANG, link
            checked += 1
    assert checked >= {"pr2": 30, "tiago_dual": 19, "stretch": 28}[robot.name]


def spread(polygon: Array) -> Array:
    """Points of a convex polygon: its corners, and 100 amid them."""
    amid = np.random.default_rng(0).dirichlet(np.ones(len(polygon)), 100)
    return np.concatenate((polygon, amid @ polygon))


def test_every_triangle_lies_inside_our_shapes(robot: Robot, theirs: Robot) -> None:
    """Not of samples only: what shapes leave of each triangle is no farther out than the annotation says."""
    annotated = float(next(robot.graph.objects(None, SDT.overhang)).toPython())
    for link in theirs.links.links:
        for mesh in theirs.links.meshes(link):
            shapes = robot.links.shapes(link)
            for polygon in uncovered(np.asarray(mesh.triangles), shapes):
                assert outside(shapes, spread(polygon)).max() <= annotated, link


def test_annotated_overhang_is_not_below_the_measured(robot: Robot, theirs: Robot) -> None:
    annotated = float(next(robot.graph.objects(None, SDT.overhang)).toPython())
    meshes = [(link, mesh) for link in theirs.links.links for mesh in theirs.links.meshes(link)]
    assert (
        max(outside(robot.links.shapes(link), surface(mesh)).max() for link, mesh in meshes)
        <= annotated
        <= OVERHANG
    )


def test_volume_ratios(robot: Robot, theirs: Robot) -> None:
    """Prints what robots/README.md tables: volume of our union over that of the meshes' hulls."""
    ratios = {}
    for link in theirs.links.links:
        hulls = [
            mesh.convex_hull.volume
            for mesh in theirs.links.meshes(link)
            if np.ptp(mesh.vertices, axis=0).min() > 1e-3
        ]
        if hulls:
            ratios[link] = volume(robot.links.shapes(link)) / sum(hulls)
            print(f"{robot.name} {link} {len(robot.links.shapes(link))} {ratios[link]:.2f}")  # noqa: T201
    assert np.median(list(ratios.values())) < 1.3
    assert {link for link, ratio in ratios.items() if ratio > 1.45} <= {"link_gripper_finger_left"}


def test_budget_of_shapes(robot: Robot) -> None:
    counts = {link: len(robot.links.shapes(link)) for link in robot.links.links}
    assert max(counts.values()) <= 13
    assert sum(counts.values()) <= 150
