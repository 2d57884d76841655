"""Joints that certification lets nobody move stand parked: what they carry may be in the way of a door."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sdt_kg.annotation import Drive, RobotAnnotation
from sdt_kg.iri import joint_iri, model_iri
from sdt_kg.load import load_twin
from sdt_kg.mechanism import Joint, JointType
from sdt_kg.motion import BodyMotion
from sdt_kg.twin import Twin
from services.embodiment.body.demands import Margins, rules
from services.embodiment.body.limb import make_limb
from services.embodiment.body.world import World
from services.embodiment.certify import Refused, Tolerances, certify
from services.embodiment.proof_check.parked import stands
from services.embodiment.proof_check.proof.content import PARKED
from services.embodiment.proof_check.proof.written import read_proof
from services.embodiment.proof_check.statement import Statement
from services.physics.model import Scene
from tests.services.embodiment.prove.standing import (
    HERE,
    Change,
    Known,
    again,
    front,
    refuted_front,
    swept,
    with_held_head,
)

AGAINST_HEAD = 30  # front whose door opens against the head of the TIAGo++, where it looks ahead
POSTURES = 200
HEADS = {"pr2": {"head_pan_joint", "head_tilt_joint"}, "tiago_dual": {"head_1_joint", "head_2_joint"}}
A_LITTLE = 1e-6  # [rad or m]


@pytest.fixture(scope="module")
def opened(tmp_path_factory: pytest.TempPathFactory) -> Known:
    folder = tmp_path_factory.mktemp("front")
    return refuted_front(folder, with_held_head(folder, "tiago_dual"), AGAINST_HEAD)


def test_a_door_that_opens_against_a_parked_head_is_refuted_for_good(opened: Known) -> None:
    _, proved = opened
    assert proved.diagnosis.proof
    assert "head_2_link" in proved.diagnosis.reason
    assert "with head_1_joint, head_2_joint where the robot is parked" in proved.diagnosis.reason
    holds, said = again(opened)
    assert holds
    assert PARKED in said


def test_wherever_the_arms_and_the_lift_are_something_is_in_contact(opened: Known) -> None:
    twin, proved = opened
    door = twin.container("front_door")
    statement = Statement(twin, twin.robots[0], door, Drive.FIXED, HERE, Tolerances())
    rng = np.random.default_rng(0)
    one = next(each for each in read_proof(proved.artefact.content).refutations if each.beside)
    gripper = next(each for each in statement.grippers if each.name == one.gripper)
    arm = statement.arm(gripper)
    assert arm is not None
    world = World(Scene(twin.at({door.joint: one.value}), twin.robots[0]))
    demands = rules(world, make_limb(world, gripper), Margins(0.0, 0.0, 0.0))
    names = [link.name for link in arm.chain.links[3:]]
    for q in rng.uniform(*arm.chain.ranges(), (POSTURES, len(arm.chain.links))):
        posture = world.scene.q(q[:3], dict(zip(names, q[3:].tolist(), strict=True)))
        assert world.contact(posture[None], demands) is not None


def _set(name: str, value: object) -> Change:
    def change(whole: dict[str, Any]) -> None:
        for one in whole["refutations"]:
            if one["beside"]:
                one[name] = value

    return change


def _without(whole: dict[str, Any]) -> None:
    for one in whole["refutations"]:
        del one["parked"]


@pytest.mark.parametrize(
    "change",
    [_set("parked", False), _without, _set("parked", 1), _set("beside", ["torso_lift_link"])],
    ids=["turned", "as before", "no word", "another body"],
)
def test_a_proof_from_a_head_that_may_turn_does_not_hold(opened: Known, change: Change) -> None:
    assert not again(opened, change)[0]


def test_a_head_with_limits_of_acceleration_is_not_refuted(opened: Known, tmp_path: Path) -> None:
    """Somebody may turn it away then: so may the bundled one's."""
    twin = opened[0]
    for name in HEADS["tiago_dual"]:
        twin = twin.with_edit(joint_iri("tiago_dual", name), accelerationLimit=1.0)
    assert swept(twin) is None
    assert swept(front(tmp_path, "tiago_dual", AGAINST_HEAD)) is None


def test_what_stands_is_a_held_head_and_no_arm_nor_lift_nor_finger(tmp_path: Path) -> None:
    for robot, heads in HEADS.items():
        twin = load_twin("b", [with_held_head(tmp_path, robot)])
        own = twin.robot(twin.robots[0])
        joints = [one for one in twin.mechanism(twin.robots[0]).joints if one.type is not JointType.FIXED]
        still = {joint.name for joint in joints if stands(joint, own)}
        assert heads <= still
        assert still <= {*own.held}
        assert still.isdisjoint(own.acceleration)
        assert not any(one.joint in still for gripper in own.grippers for one in gripper.finger_joints)


def test_fingers_may_start_anywhere_and_what_mimics_goes_along() -> None:
    twin = load_twin("b", ["pr2"])
    own, mechanism = twin.robot(twin.robots[0]), twin.mechanism(twin.robots[0])
    lazy = replace(own, acceleration={})
    joints = [replace(one, limits=replace(one.limits, acceleration=np.inf)) for one in mechanism.joints]
    still = {one.name for one in joints if stands(one, lazy)}
    assert "torso_lift_joint" in still
    assert not stands(mechanism.joint("torso_lift_joint"), own)
    assert still.isdisjoint(one.joint for gripper in own.grippers for one in gripper.finger_joints)
    assert still.isdisjoint(one.name for one in joints if one.mimic is not None)


def _still(twin: Twin) -> list[tuple[Joint, RobotAnnotation]]:
    own = twin.robot(twin.robots[0])
    movable = (one for one in twin.mechanism(twin.robots[0]).joints if one.type is not JointType.FIXED)
    return [(one, own) for one in movable if stands(one, own)]


@pytest.mark.oracle
@pytest.mark.parametrize("robot", HEADS)
def test_certification_lets_none_of_them_move_nor_begin_elsewhere(robot: str, tmp_path: Path) -> None:
    """What the rule rests on: each of these joints, moved a little, or turned before it all begins."""
    twin = load_twin("b", [with_held_head(tmp_path, robot)])
    iri, door = model_iri(robot), twin.container("iai_fridge_door")
    scene, times = Scene(twin, iri), np.array([0.0, 1.0, 2.0])
    for joint, own in _still(twin):
        rest = min(max(0.0, joint.limits.lower), joint.limits.upper)
        at = own.parked.get(joint.name, rest)
        for q, said in (
            ([at, at + A_LITTLE, at], f"{joint.name} moves, and nothing says how fast: it has no limit of"),
            ([at + 0.01] * 3, f"{joint.name} starts at"),
        ):
            base = np.zeros((3, 3))
            values, speeds = np.array([q]).T, np.zeros((3, 1))
            motion = BodyMotion(iri, "", (joint.name,), times, base, values, speeds, base)
            verdict = certify(
                twin, iri, motion, door, Tolerances(), drive=Drive.FIXED, start=HERE, scene=scene
            )
            assert isinstance(verdict, Refused)
            assert any(said in each.reason for each in verdict.diagnoses), joint.name
