"""Bundled force data of robots: what of them goes to a robot that is not quite the bundled one."""

from pathlib import Path

import rdflib

import robots
from services.app import load
from services.dynamics.data import with_forces
from tests.small import FOLDER


def test_a_robot_without_one_gripper_keeps_the_data_of_the_other(tmp_path: Path) -> None:
    told = rdflib.Graph().parse(robots.path("tiago_dual/tiago_dual.ttl"))
    for triple in list(told):
        if any(str(each).startswith("https://example.org/id/tiago_dual/gripper/right") for each in triple):
            told.remove(triple)
    annotation = tmp_path / "one_hand.ttl"
    told.serialize(annotation, format="turtle")
    twin = with_forces(load("b", ["tiago_dual"], annotation=annotation).twin)
    facts, (robot,) = twin.entities.facts, twin.robots
    assert [each.name for each in twin.robot(robot).grippers] == ["left"]
    assert facts.number(f"{robot}/gripper/left", "gripForce") == 16.0
    assert facts.number(robot, "wheelFriction") == 0.3
    assert len(facts.iris(robot, "standsOn")) > 3
    assert facts.one(f"{robot}/joint/arm_right_1_joint", "effortLimitKnown") is True
    assert not facts.all(f"{robot}/gripper/right", "gripForce")
    (note,) = (each for each in twin.notes if "efforts" in each)
    assert note.startswith("tiago_dual: efforts, grippers and wheels of tiago_dual")
    assert note.endswith(", without those of the gripper right, which it does not have")


def test_a_robot_that_is_only_called_like_a_bundled_one_is_given_none_of_its_data() -> None:
    twin = with_forces(load("b", [str(FOLDER / "pr2.urdf")]).twin)
    facts, (robot,) = twin.entities.facts, twin.robots
    assert not facts.all(robot, "wheelFriction")
    (note,) = (each for each in twin.notes if "efforts" in each)
    assert note.startswith("pr2: no efforts, grippers and wheels of pr2: it has no ")
    assert note.endswith(", so it is another robot")
