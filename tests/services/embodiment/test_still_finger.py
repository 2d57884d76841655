"""Hands of which one finger stands still, of robots as somebody writes them: described, then asked."""

from pathlib import Path

import numpy as np
import pytest

from predicates.case import Outcome, Verdict
from sdt_kg.annotation import Drive
from sdt_kg.load import load_twin
from services.app import Policy, load
from services.describing.describe import describe
from services.embodiment.body.demands import Margins
from services.embodiment.body.world import World
from services.embodiment.hold.kit import Kits
from services.physics.model import Scene
from tests.services.embodiment.gantry import FOLDER

pytestmark = pytest.mark.oracle

JAW = '<collision><origin xyz="0.05 0 {z}"/><geometry><box size="0.08 0.02 0.01"/></geometry></collision>'
STILL = """<link name="fixed_jaw">{shape}</link>
<joint name="fixed_jaw_joint" type="fixed"><parent link="palm"/><child link="fixed_jaw"/>
 <origin xyz="0.01 0 {at}"/></joint>"""
SLIDES = (
    STILL.format(shape=JAW.format(z=-0.005), at=-0.04)
    + f"""<link name="moving_jaw">{JAW.format(z=0.005)}</link>
<joint name="jaw_joint" type="prismatic"><parent link="palm"/><child link="moving_jaw"/>
 <origin xyz="0.01 0 -0.04"/><axis xyz="0 0 1"/>
 <limit lower="0" upper="0.08" velocity="0.2" effort="10"/></joint>"""
)
TURNS = (
    STILL.format(shape=JAW.format(z=0.005), at=0.02)
    + f"""<link name="moving_jaw">{JAW.format(z=-0.005)}</link>
<joint name="jaw_joint" type="revolute"><parent link="palm"/><child link="moving_jaw"/>
 <origin xyz="0.01 0 0.005"/><axis xyz="0 1 0"/>
 <limit lower="-0.15" upper="1.2" velocity="1" effort="10"/></joint>"""
)
HANDS = {"below, the other slides": SLIDES, "above, the other turns": TURNS}
PITCH = """<link name="hinge"><collision><geometry><box size="0.03 0.03 0.03"/></geometry></collision></link>
<joint name="pitch_joint" type="revolute"><parent link="arm"/><child link="hinge"/><origin xyz="0.08 0 0"/>
 <axis xyz="0 1 0"/><limit lower="-1.5" upper="1.5" velocity="2" effort="10"/></joint>
"""


def claw(folder: Path, hand: str) -> Path:
    """The gantry with a wrist that bends too and this hand, and the annotation that is guessed for it."""
    text = (FOLDER / "gantry.urdf").read_text(encoding="utf-8").replace('name="gantry"', 'name="claw"')
    text = text[: text.index('<link name="up_finger">')] + hand + "</robot>"
    text = text.replace('<link name="palm">', PITCH + '<link name="palm">')
    text = text.replace(
        '<parent link="arm"/><child link="palm"/><origin xyz="0.1 0 0"/>',
        '<parent link="hinge"/><child link="palm"/><origin xyz="0.06 0 0"/>',
    )
    path = folder / "claw.urdf"
    path.write_text(text, encoding="utf-8")
    path.with_suffix(".ttl").write_text(describe(path).text, encoding="utf-8")
    return path


def asked(folder: Path, hand: str) -> Verdict:
    """Whether the robot opens the drawer of the cell."""
    service = load(FOLDER / "cell.urdf", [claw(folder, hand)], policy=Policy(Drive.OMNI))
    (verdict,) = service.achieve("open:drawer_main")
    return verdict


@pytest.mark.parametrize("hand", HANDS)
def test_a_finger_that_stands_still_is_brought_to_the_bar_before_the_other_closes(
    tmp_path: Path, hand: str
) -> None:
    assert asked(tmp_path, HANDS[hand]).outcome is Outcome.CERTIFIED


@pytest.mark.parametrize("hand", HANDS)
def test_a_bar_has_room_in_the_open_hand_amid_its_fingers(tmp_path: Path, hand: str) -> None:
    twin = load_twin(FOLDER / "cell.urdf", [claw(tmp_path, HANDS[hand])])
    world = World(Scene(twin, twin.robots[0]))
    found = Kits(world, Margins()).of(world.scene.annotation.grippers[0]).hand
    left, moves = found.sides[0, 0], np.array(["moving" in world.body[one] for one in found.fingers])
    assert (left == moves).all() or (left == ~moves).all()
    turns, middles = (part[-len(found.fingers) :] for part in found.shapes_seen(0.0))
    reach = (np.abs(turns[:, 1]) * world.half[found.fingers]).sum(axis=1)
    above = float((middles[left, 1] - reach[left]).min())
    below = float((middles[~left, 1] + reach[~left]).max())
    assert above - found.amid == pytest.approx(found.amid - below)
    assert abs(found.amid) > 0.01


def test_hands_whose_fingers_all_move_are_centred_as_ever() -> None:
    for robot in ("pr2", "tiago_dual", "stretch"):
        twin = load_twin("b", [robot])
        world = World(Scene(twin, twin.robots[0]))
        for gripper in world.scene.annotation.grippers:
            assert Kits(world, Margins()).of(gripper).hand.amid == 0.0
