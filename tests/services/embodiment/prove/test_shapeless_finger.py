"""A link without a shape among the fingers, as a lamp in the palm: it parts no fingers, and holds nothing."""

from pathlib import Path

import pytest

from sdt_kg.annotation import Drive
from sdt_kg.load import load_twin
from sdt_kg.twin import Twin
from services.embodiment.certify.check import Certified, certify
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.check import refuted
from services.embodiment.proof_check.proof.content import LEAF, Refutation
from services.embodiment.proof_check.statement import Statement
from tests.services.embodiment.gantry import DRAWER, FOLDER, START, opening

pytestmark = pytest.mark.oracle

JAW = """<link name="jaw"/><joint name="jaw_joint" type="prismatic"><parent link="palm"/><child link="jaw"/>
 <axis xyz="0 0 1"/><limit lower="-0.01" upper="0.01" velocity="0.2" effort="10"/></joint>
<link name="lamp"/><joint name="lamp_joint" type="revolute"><parent link="palm"/><child link="lamp"/>
 <limit lower="-0.1" upper="0.1" velocity="0.2" effort="10"/></joint></robot>"""
"""Carries both fingers; they part behind it."""


def with_lamp(folder: Path) -> Twin:
    """The gantry with its fingers on a jaw, beside a lamp that is called a finger; and its cell."""
    urdf, annotation = ((FOLDER / f"gantry{end}").read_text() for end in (".urdf", ".ttl"))
    for finger in ("up_finger", "down_finger"):
        urdf = urdf.replace(
            f'<parent link="palm"/><child link="{finger}"/>', f'<parent link="jaw"/><child link="{finger}"/>'
        )
    (folder / "gantry.urdf").write_text(urdf.replace("</robot>", JAW))
    limits = "j:jaw_joint sdt:accelerationLimit 1.0 .\nj:lamp_joint sdt:accelerationLimit 1.0 .\n"
    (folder / "gantry.ttl").write_text(
        annotation.replace("b:down_finger ;", "b:down_finger, b:lamp ;") + limits
    )
    (folder / "cell.urdf").write_text((FOLDER / "cell.urdf").read_text())
    return load_twin(folder / "cell.urdf", [folder / "gantry.urdf"])


def test_fingers_that_hold_a_drawer_are_two_whatever_else_is_called_a_finger(tmp_path: Path) -> None:
    twin = with_lamp(tmp_path)
    robot, (drawer,) = twin.robots[0], (one for one in twin.containers() if one.joint == DRAWER)
    motion = opening()
    assert isinstance(
        certify(twin, robot, motion, drawer, Tolerances(), drive=Drive.OMNI, start=START), Certified
    )
    span = (0.0, drawer.open_from)
    statement = Statement(twin, robot, drawer, Drive.OMNI, START, Tolerances(), span=span)
    (gripper,) = (one for one in statement.grippers if one.name == motion.gripper)
    hand = statement.hand(gripper)
    assert hand is not None
    assert len(hand.fingers) == 2
    box = tuple(zip(hand.low.tolist(), hand.high.tolist(), strict=True))
    for finger in range(3):
        tree = bytes([LEAF + finger])
        one = Refutation(gripper.name, 0.0, hand.names, box, tree, pinched=True)
        reasons, _ = refuted(statement, span, (one,))
        assert any(reason.startswith(f"gripper {gripper.name}:") for reason in reasons)
