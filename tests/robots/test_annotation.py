"""The annotation says only what the model can do, in the words which the twin reads."""

from collections import Counter

import coal
import numpy as np
import pytest
from rdflib import RDF, RDFS, BNode

from sdt_kg import iri
from tests.robots.conftest import SDT, Robot, touch
from tests.robots.shapes import Array

BAR = 0.015  # [m] thickness of the handles in both kitchens
POSE = ["x", "y", "z", "qx", "qy", "qz", "qw"]
OPENING_TOLERANCE = 0.002  # [m] between annotated and measured opening


def test_urdf_is_a_tree(robot: Robot) -> None:
    ends = [robot.links.ends(joint) for joint in robot.links.joints]
    assert max(Counter(child for _, child in ends).values()) == 1
    assert {link for pair in ends for link in pair} == set(robot.links.links)
    assert len(ends) == len(robot.links.links) - 1


def test_limits_are_ordered(robot: Robot) -> None:
    bounded = [j for j in robot.links.joints.values() if j.get("type") in {"revolute", "prismatic"}]
    assert bounded
    for joint in bounded:
        limit = joint.find("limit")
        assert limit is not None
        assert float(limit.get("lower", "nan")) < float(limit.get("upper", "nan"))
        assert float(limit.get("velocity", "nan")) > 0


def test_names_exist(robot: Robot) -> None:
    named = {str(term) for triple in robot.graph for term in triple if str(term).startswith(iri.ID)}
    bodies = {iri.local_name(name) for name in named if "/body/" in name}
    joints = {iri.local_name(name) for name in named if "/joint/" in name}
    assert bodies <= set(robot.links.links)
    assert joints <= set(robot.links.joints)
    assert all(name.startswith(iri.model_iri(robot.name)) for name in named)


def test_no_blank_nodes(robot: Robot) -> None:
    assert not [term for triple in robot.graph for term in triple if isinstance(term, BNode)]


def test_every_planned_joint_has_an_acceleration_limit(robot: Robot) -> None:
    held = {joint for joint, _ in robot.named("held")}
    movable = {name for name, joint in robot.links.joints.items() if joint.get("type") != "fixed"}
    limits = robot.values("accelerationLimit")
    assert set(limits) == movable - held
    assert min(limits.values()) > 0


def test_positions_keep_the_limits(robot: Robot) -> None:
    for term in ("parkedPosition", "openPosition", "closedPosition"):
        positions = robot.values(term)
        assert positions
        for name, value in positions.items():
            limit = robot.links.joints[name].find("limit")
            assert limit is not None
            assert float(limit.get("lower", "-inf")) <= value <= float(limit.get("upper", "inf")), name


@pytest.mark.parametrize("fingers", ["openPosition", "closedPosition"])
def test_parked_robot_does_not_touch_itself(robot: Robot, fingers: str) -> None:
    assert robot.self_collisions(robot.values("parkedPosition") | robot.values(fingers)) == set()


def test_self_collision_is_seen(robot: Robot) -> None:
    inwards = {
        "pr2": {"l_shoulder_pan_joint": -0.2, "l_shoulder_lift_joint": 1.3, "l_elbow_flex_joint": -0.5},
        "tiago_dual": {
            "arm_left_1_joint": 1.3,
            "arm_left_2_joint": 1.5,
            "arm_left_3_joint": 2.1,
            "arm_left_4_joint": 1.0,
        },
        "stretch": {"joint_lift": 0.1, "joint_wrist_yaw": -1.7, "joint_wrist_pitch": -0.9},
    }
    forearm = {"pr2": "l_forearm_link", "tiago_dual": "arm_left_5_link", "stretch": "link_straight_gripper"}
    assert frozenset(("base_link", forearm[robot.name])) in robot.self_collisions(inwards[robot.name])


def tool(robot: Robot, gripper: str, frames: dict[str, Array]) -> Array:
    """World pose of a tool frame."""
    node = next(s for s in robot.graph.subjects(RDF.type, SDT.Gripper) if iri.local_name(str(s)) == gripper)
    pose = robot.graph.value(node, SDT.toolFrame)
    x, y, z, qx, qy, qz, qw = (float(robot.graph.value(pose, SDT[k]).toPython()) for k in POSE)
    assert (qx, qy, qz, qw) == (0, 0, 0, 1)
    body_T_tool = np.eye(4)
    body_T_tool[:3, 3] = x, y, z
    return frames[iri.local_name(str(robot.graph.value(node, SDT.toolBody)))] @ body_T_tool


def fits(robot: Robot, gripper: str, width: float) -> bool:
    """Whether a bar of that width across the fingers is free between them."""
    frames = robot.frames(robot.values("openPosition"))
    bar = (coal.Box(BAR, width, BAR), tool(robot, gripper, frames))
    fingers = [finger for owner, finger in robot.named("hasFinger") if owner == gripper]
    assert len(fingers) >= 2
    return not any(touch(bar, part) for finger in fingers for part in robot.placed(frames, finger))


def test_opening_is_the_free_width_at_the_tool_frame(robot: Robot) -> None:
    grippers = list(robot.graph.subjects(RDF.type, SDT.Gripper))
    assert len(grippers) == {"pr2": 2, "tiago_dual": 2, "stretch": 1}[robot.name]
    for node in grippers:
        name = iri.local_name(str(node))
        assert str(robot.graph.value(node, RDFS.label)) == name
        opening = float(robot.graph.value(node, SDT.opening).toPython())
        assert fits(robot, name, opening - OPENING_TOLERANCE)
        assert not fits(robot, name, opening + OPENING_TOLERANCE)
