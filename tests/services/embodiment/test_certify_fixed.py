"""Kitchen joints that cannot move may be listed in a motion: where they are, and nowhere else."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sdt_kg.errors import MotionError
from sdt_kg.iri import joint_iri
from sdt_kg.load import load_twin
from sdt_kg.motion import BodyMotion
from services.embodiment.certify import Certified
from services.motions import read_motion, write_motion
from tests.services.embodiment.gantry import FOLDER, RESTS, gantry_twin, opening
from tests.services.embodiment.judging import judge

pytestmark = pytest.mark.oracle

SHELF = """<link name="shelf"/><joint name="shelf_joint" type="{}"><parent link="world"/><child link="shelf"/>
<origin xyz="0 5 0"/><axis xyz="0 0 1"/><limit lower="{at}" upper="{at}" velocity="1" effort="1"/></joint>"""
FOLLOWER = """<link name="flap"/><joint name="flap_joint" type="revolute"><parent link="shelf"/>
<child link="flap"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1" effort="1"/>
<mimic joint="shelf_joint" multiplier="-2" offset="0.1"/></joint>"""


def listing(motion: BodyMotion, values: dict[str, float]) -> BodyMotion:
    """The motion with these kitchen joints, too, at one position all along."""
    still = np.tile(list(values.values()), (len(motion.times), 1))
    return replace(
        motion,
        kitchen_joints=(*motion.kitchen_joints, *(joint_iri("cell", name) for name in values)),
        kitchen_q=np.hstack((motion.kitchen_q, still)),
        kitchen_v=np.hstack((motion.kitchen_v, np.zeros_like(still))),
    )


@pytest.mark.parametrize("kind", ["prismatic", "revolute"])
@pytest.mark.parametrize(
    ("at", "listed", "kept"),
    [(0.2, 0.2, True), (-0.3490658503988659, -0.3490658503988659, True), (0, 0, True), (0.2, 0.2001, False),
     (0.2, 0.0, False), (0, 0.2, False), (-0.5, 0.5, False)],
)  # fmt: skip
def test_a_joint_with_equal_limits_is_where_they_are(
    tmp_path: Path, kind: str, at: float, listed: float, kept: bool
) -> None:
    twin = gantry_twin(tmp_path, SHELF.format(kind, at=at))
    verdict = judge(twin, listing(opening(), {"shelf_joint": listed}))
    assert isinstance(verdict, Certified) is kept
    if not isinstance(verdict, Certified):
        (found,) = verdict.diagnoses
        assert found.reason.startswith(f"shelf_joint moves by {abs(listed - at):.4g}, and it is fixed")


def test_a_joint_that_mimics_one_with_equal_limits_is_where_it_follows_to(tmp_path: Path) -> None:
    twin = gantry_twin(tmp_path, SHELF.format("revolute", at=0.2) + FOLLOWER)
    assert isinstance(judge(twin, listing(opening(), {"flap_joint": -0.3})), Certified)
    assert not isinstance(judge(twin, listing(opening(), {"flap_joint": 0.0})), Certified)


def test_a_file_may_list_it_too(tmp_path: Path) -> None:
    twin = gantry_twin(tmp_path, SHELF.format("prismatic", at=0.2))
    for listed, kept in ((0.2, True), (0.0, False)):
        write_motion(tmp_path / "motion.npz", listing(opening(), {"shelf_joint": listed}))
        motion = read_motion(tmp_path / "motion.npz", twin, twin.robots[0])
        assert isinstance(motion, BodyMotion)
        assert isinstance(judge(twin, motion), Certified) is kept


@pytest.mark.parametrize(("listed", "kept"), [(0.2, True), (0.0, False), (0.25, False)])
def test_a_file_may_list_a_joint_of_the_robot_that_has_equal_limits_where_they_are(
    tmp_path: Path, listed: float, kept: bool
) -> None:
    text = (FOLDER / "gantry.urdf").read_text()
    (tmp_path / "gantry.urdf").write_text(text.replace('lower="0" upper="0.6"', 'lower="0.2" upper="0.2"'))
    (tmp_path / "gantry.ttl").write_bytes((FOLDER / "gantry.ttl").read_bytes())
    twin = load_twin(FOLDER / "cell.urdf", [tmp_path / "gantry.urdf"])
    rests = RESTS.copy()
    rests[:, 4] = listed
    write_motion(tmp_path / "motion.npz", opening(rests=rests))
    if not kept:
        with pytest.raises(
            MotionError, match=r"lift_joint .* but the joint is fixed; allowed: 0\.2, or leave"
        ):
            read_motion(tmp_path / "motion.npz", twin, twin.robots[0])
        return
    motion = read_motion(tmp_path / "motion.npz", twin, twin.robots[0])
    assert isinstance(motion, BodyMotion)
    assert isinstance(judge(twin, motion), Certified)


def test_a_robots_fixed_joint_is_said_to_be_fixed(tmp_path: Path) -> None:
    lamp = """<link name="lamp"/><joint name="lamp_joint" type="fixed"><parent link="base"/>
<child link="lamp"/></joint>"""
    text = (FOLDER / "gantry.urdf").read_text(encoding="utf-8")
    (tmp_path / "gantry.urdf").write_text(text.replace("</robot>", f"{lamp}</robot>"), encoding="utf-8")
    shutil.copy(FOLDER / "gantry.ttl", tmp_path)
    twin, motion = load_twin(FOLDER / "cell.urdf", [tmp_path / "gantry.urdf"]), opening()
    with pytest.raises(
        MotionError, match="joint 'lamp_joint' of the robot is fixed; allowed: joints that move"
    ):
        judge(twin, replace(motion, joints=("lamp_joint", *motion.joints[1:])))
