"""More of what `make test` asks a sample of: of proofs, and of what they must not refute."""

from pathlib import Path

import pytest

from sdt_kg.annotation import Drive
from sdt_kg.twin import Twin
from tests.services.embodiment.prove.standing import front, swept
from tests.services.embodiment.prove.test_between import HELD, check_between
from tests.services.embodiment.prove.test_declared import PASSING_TOO, coming
from tests.services.embodiment.prove.test_in_hand import check_posture
from tests.services.embodiment.prove.test_proofs import check_joints, twin  # noqa: F401 - a fixture
from tests.services.embodiment.prove.test_stretch import check_any, check_robot
from tests.services.embodiment.test_certify_fingers import CUT, HELD_BY_OTHERS, check_cut

pytestmark = [pytest.mark.oracle, pytest.mark.slow]

MANY_BOXES = 20_000
SAMPLES = 6  # of a motion
INSIDE = 200  # positions that are tried in each box


@pytest.mark.parametrize("robot", HELD)
def test_many_boxes_show_nothing_against_what_is_held(tmp_path: Path, robot: str) -> None:
    check_between(tmp_path, robot, MANY_BOXES, SAMPLES, 1)


def test_no_steps_refute_another_that_is_certified(tmp_path: Path) -> None:
    assert swept(front(tmp_path, "pr2", 27), declared=True) is None


def test_other_corners_that_the_base_lacks_refute_nothing(tmp_path: Path) -> None:
    assert swept(front(tmp_path, "pr2", PASSING_TOO), declared=True) is None


def test_a_drawer_that_just_does_not_come_into_a_base_is_not_refuted(tmp_path: Path) -> None:
    assert swept(front(tmp_path, "pr2", coming(-0.001)), declared=True) is None


@pytest.mark.parametrize("width", [1e-3, 0.03, 0.3, 1.5])
@pytest.mark.parametrize("seed", range(3))
def test_of_many_positions_none_has_a_grasp_box_farther(width: float, seed: int) -> None:
    check_any(width, seed, INSIDE)


@pytest.mark.parametrize("robot", ["pr2", "tiago_dual", "stretch"])
def test_of_many_postures_of_a_robot_none_has_it_farther(robot: str) -> None:
    check_robot(robot, INSIDE)


@pytest.mark.parametrize(("ended", "thick"), HELD_BY_OTHERS)
@pytest.mark.parametrize(("deep", "holds"), CUT)
def test_fingers_that_cut_into_other_bent_handles_do_not_hold_them(
    tmp_path: Path, ended: bool, thick: float, deep: float, holds: bool
) -> None:
    check_cut(tmp_path, ended, thick, deep, holds=holds)


@pytest.mark.parametrize("drive", [Drive.FIXED, Drive.OMNI])
@pytest.mark.parametrize("robot", ["pr2", "tiago_dual", "stretch"])
def test_of_more_postures_with_the_handle_in_hand_none_is_refuted(robot: str, drive: Drive) -> None:
    check_posture(robot, drive, 4)


@pytest.mark.parametrize("robot", ["pr2", "tiago_dual", "stretch"])
def test_in_many_postures_joints_are_where_pinocchio_has_them(twin: Twin, robot: str) -> None:  # noqa: F811
    check_joints(twin, robot, 40)
