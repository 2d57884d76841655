"""Bodies beside the arm: what they refute is in contact, wherever their joints stand; a check finds out."""

import base64
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from services.embodiment.body.demands import Margins, rules
from services.embodiment.body.limb import make_limb
from services.embodiment.body.world import World
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.proof.content import BESIDE, LEAF
from services.embodiment.proof_check.proof.written import read_proof
from services.embodiment.proof_check.statement import Statement
from services.physics.model import Scene
from tests.services.embodiment.prove.standing import HERE, Change, Known, again, front, refuted_front, swept

TIPS = 75  # front whose door tips onto the left shoulder of the PR2, however that is turned and lifted
OPENED = {"pr2": 3, "tiago_dual": 3}
"""Fronts that are certified with the base standing, and so are refuted nowhere."""
POSTURES = 200


@pytest.fixture(scope="module")
def tipped(tmp_path_factory: pytest.TempPathFactory) -> Known:
    return refuted_front(tmp_path_factory.mktemp("front"), "pr2", TIPS)


def test_a_door_that_tips_onto_a_shoulder_is_refuted_for_good(tipped: Known) -> None:
    _, proved = tipped
    assert proved.diagnosis.proof
    assert "l_shoulder" in proved.diagnosis.reason
    holds, said = again(tipped)
    assert holds
    assert BESIDE in said


def test_wherever_the_arms_are_at_that_value_something_is_in_contact(tipped: Known) -> None:
    twin, proved = tipped
    door = twin.container("front_door")
    statement = Statement(twin, twin.robots[0], door, Drive.FIXED, HERE, Tolerances())
    rng = np.random.default_rng(0)
    for one, gripper in zip(read_proof(proved.artefact.content).refutations, statement.grippers, strict=True):
        arm = statement.arm(gripper)
        assert arm is not None
        scene = Scene(twin.at({door.joint: one.value}), twin.robots[0])
        world = World(scene)
        demands = rules(world, make_limb(world, gripper), Margins(0.0, 0.0, 0.0))
        low, high = arm.chain.ranges()
        names = [link.name for link in arm.chain.links[3:]]
        for q in rng.uniform(low, high, (POSTURES, len(low))):
            posture = scene.q(q[:3], dict(zip(names, q[3:].tolist(), strict=True)))
            assert world.contact(posture[None], demands) is not None


def _set(name: str, value: object) -> Change:
    def change(whole: dict[str, Any]) -> None:
        for one in whole["refutations"]:
            one[name] = value

    return change


@pytest.mark.parametrize(
    "change",
    [
        _set("beside", []),
        _set("beside", ["head_pan_link"]),
        _set("beside", ["no_such_link"]),
        _set("beside", ["base_link"]),
        _set("beside", ["fl_caster_rotation_link"]),
        _set("value", 0.0),
        _set("places", {"values": [0.0], "box": [[-9.0, 9.0]] * 3}),
        _set("pinched", True),
    ],
    ids=["none", "head", "nothing", "the root", "a caster", "closed", "places", "fingers"],
)
def test_a_proof_from_other_bodies_or_at_another_value_does_not_hold(tipped: Known, change: Change) -> None:
    assert not again(tipped, change)[0]


def test_a_leaf_of_a_limb_names_a_core_and_nothing_else(tipped: Known) -> None:
    """A limb is far from the handle in most postures: that refutes nothing."""
    twin, proved = tipped
    door = twin.container("front_door")
    statement = Statement(twin, twin.robots[0], door, Drive.FIXED, HERE, Tolerances())
    arm = statement.arm(statement.grippers[0])
    assert arm is not None
    one = read_proof(proved.artefact.content).refutations[0]
    first = LEAF + len(arm.chain.links) + 1 + len(arm.cores)
    links = len(statement.beside(arm, one.beside[0], one.value).limb.chain.links)
    far = base64.b64encode(bytes([first, LEAF + links])).decode()
    holds, said = again(tipped, _set("tree", far))
    assert not holds
    assert "refuted by its distance" in said


def test_with_a_free_base_or_a_joint_that_mimics_no_limb_is_asked(tipped: Known) -> None:
    twin, _ = tipped
    about = twin, twin.robots[0], twin.container("front_door")
    for drive, body in ((Drive.OMNI, "head_pan_link"), (Drive.FIXED, "l_gripper_r_finger_link")):
        statement = Statement(*about, drive, HERE, Tolerances())
        arm = statement.arm(statement.grippers[0])
        assert arm is not None
        with pytest.raises(InputError):
            statement.beside(arm, body, 0.0)


@pytest.mark.parametrize("declared", [False, True])
@pytest.mark.parametrize("robot", OPENED)
def test_nothing_is_in_the_way_of_what_is_certified(tmp_path: Path, robot: str, declared: bool) -> None:
    twin = front(tmp_path, robot, OPENED[robot])
    assert swept(twin, declared) is None
