"""A body motion that lists any one of joints that move together moves them all, whichever is asked about."""

from dataclasses import replace
from pathlib import Path

import pytest

from predicates.case import Case, Outcome
from predicates.law import law
from sdt_kg.annotation import Drive
from sdt_kg.iri import body_iri, joint_iri
from sdt_kg.load import load_twin
from sdt_kg.motion import BodyMotion
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.embodiment.oracle import WholeBody
from services.physics.oracle import Kinematics
from tests.services.embodiment.gantry import FOLDER, START, opening

pytestmark = pytest.mark.oracle

OTHER = "second_drawer"
BOX = '<collision><origin xyz="{}"/><geometry><box size="{}"/></geometry></collision>'
SLIDE = '<axis xyz="-1 0 0"/><limit lower="0" upper="0.5" velocity="1" effort="10"/>'
SHORT = SLIDE.replace("0.5", "0.01")  # less than would pull what follows it back to its stop
ROD = f"""<link name="rod">{BOX.format("3 3 0", "0.01 0.01 0.01")}</link>
<joint name="rod_joint" type="prismatic"><parent link="cabinet"/><child link="rod"/>{SLIDE}</joint>"""

MOUNTED = '<parent link="mount"/><child link="drawer_handle"/>'
FIRST_HANDLE = f"""<link name="mount"/><joint name="mount_joint" type="fixed">
<parent link="drawer_main"/><child link="mount"/></joint>
<link name="a_handle">{BOX.format("-0.295 2 0", "0.01 0.2 0.01")}</link>
<joint name="a_handle_joint" type="fixed"><parent link="drawer_main"/><child link="a_handle"/></joint>"""


def cell(folder: Path, main: str, other: str, more: str = "") -> Twin:
    """The cell with another drawer 3 m beside; which joints mimic which."""
    text = (FOLDER / "cell.urdf").read_text()
    begin = text.index("<limit", text.index('name="drawer_main_joint"'))
    end = text.index("</joint>", begin)
    drawer = f"""<link name="{OTHER}">{BOX.format("-0.24 3 0", "0.02 0.4 0.2")}</link>
<joint name="{OTHER}_joint" type="prismatic"><parent link="cabinet"/><child link="{OTHER}"/>
<origin xyz="0 0 0.5"/>{SLIDE}{other}</joint>
<link name="{OTHER}_handle">{BOX.format("0 0 0", "0.01 0.2 0.01")}</link>
<joint name="{OTHER}_handle_joint" type="fixed"><parent link="{OTHER}"/><child link="{OTHER}_handle"/>
<origin xyz="-0.295 3 0"/></joint>"""
    text = f"{text[:end]}{main}{text[end:]}".replace("<!-- more -->", drawer + more)
    (folder / "cell.urdf").write_text(text)
    return load_twin(folder / "cell.urdf", [FOLDER / "gantry.urdf"])


@pytest.mark.parametrize("asked", ["drawer_main", OTHER])
@pytest.mark.parametrize(
    ("main", "other", "more"),
    [
        ("", '<mimic joint="drawer_main_joint"/>', ""),
        (f'<mimic joint="{OTHER}_joint"/>', "", ""),
        ('<mimic joint="rod_joint"/>', '<mimic joint="rod_joint"/>', ROD),
    ],
    ids=["followed", "following", "both following"],
)
def test_whichever_joint_is_listed_and_asked_about_it_opens(
    tmp_path: Path, asked: str, main: str, other: str, more: str
) -> None:
    twin = cell(tmp_path, main, other, more)
    task = Task(Verb.OPEN, twin.container(asked).iri)
    for name in ("drawer_main_joint", f"{OTHER}_joint"):
        motion = replace(opening(), kitchen_joints=(joint_iri("cell", name),))
        case = Case(twin, twin.robots[0], task, body_motion=motion)
        (verdict,) = law(case, Kinematics(), WholeBody(Drive.OMNI, START))
        assert verdict.outcome is Outcome.CERTIFIED, verdict.diagnoses


def silent() -> BodyMotion:
    """The motion that opens the drawer, which does not say how the kitchen moves."""
    motion = opening()
    none = motion.kitchen_q[:, :0]
    return replace(motion, kitchen_joints=(), kitchen_q=none, kitchen_v=none)


@pytest.mark.parametrize("asked", ["drawer_main", OTHER])
def test_the_hand_drags_along_what_moves_with_the_handle_in_it(tmp_path: Path, asked: str) -> None:
    twin = cell(tmp_path, "", '<mimic joint="drawer_main_joint"/>')
    case = Case(twin, twin.robots[0], Task(Verb.OPEN, twin.container(asked).iri), body_motion=silent())
    (verdict,) = law(case, Kinematics(), WholeBody(Drive.OMNI, START))
    assert verdict.outcome is Outcome.CERTIFIED, verdict.diagnoses


def test_the_hand_drags_a_drawer_by_another_handle_than_its_first(tmp_path: Path) -> None:
    text = (FOLDER / "cell.urdf").read_text()
    text = text.replace('<parent link="drawer_main"/><child link="drawer_handle"/>', MOUNTED)
    (tmp_path / "cell.urdf").write_text(text.replace("<!-- more -->", FIRST_HANDLE))
    twin = load_twin(tmp_path / "cell.urdf", [FOLDER / "gantry.urdf"])
    (drawer,) = twin.containers()
    assert [drawer.handle, *drawer.more_handles] == [
        body_iri("cell", n) for n in ("a_handle", "drawer_handle")
    ]
    case = Case(twin, twin.robots[0], Task(Verb.OPEN, drawer.iri), body_motion=silent())
    (verdict,) = law(case, Kinematics(), WholeBody(Drive.OMNI, START))
    assert verdict.outcome is Outcome.CERTIFIED, verdict.diagnoses


def test_a_drawer_that_is_drawn_beyond_its_stop_is_held_by_nobody(tmp_path: Path) -> None:
    twin = cell(tmp_path, '<mimic joint="rod_joint" offset="-0.02"/>', "", ROD.replace(SLIDE, SHORT))
    assert twin.state[joint_iri("cell", "drawer_main_joint")] == pytest.approx(-0.02)
    carried = Kinematics().carried(twin, silent(), twin.container("drawer_main"))
    assert carried.values == pytest.approx(-0.02)
