"""Certified motions as ROS 2 bags: read back as they were, and certified again."""

from importlib import util
from pathlib import Path

import numpy as np
import pytest

from sdt_kg.errors import InputError, MotionError
from sdt_kg.motion import BodyMotion
from services.bags import bag_at
from services.motions import motion_of, read_arrays, read_motion, write_motion
from services.motions.lists import array_of
from services.motions.ros import JOINTS, POSES
from tests.services.test_motion_formats import ARRAYS, PR2, SPEEDS, TIMES, TWIN, same

pytest.importorskip("rosbags.rosbag2")

TURNED = ARRAYS | {"base": np.column_stack([TIMES / 9, TIMES / 7, 2.5 + TIMES / 3])}


def written(tmp_path: Path, arrays: dict[str, np.ndarray]) -> tuple[BodyMotion, Path]:
    motion = motion_of(arrays, TWIN, PR2)
    assert isinstance(motion, BodyMotion)
    write_motion(tmp_path / "motion.mcap", motion)
    return motion, tmp_path / "motion.mcap"


@pytest.mark.parametrize(
    "arrays",
    [
        ARRAYS,
        ARRAYS | SPEEDS,
        {name: value for name, value in ARRAYS.items() if "kitchen" not in name},
        TURNED,
        ARRAYS | {"times": TIMES / 3},
    ],
    ids=["usual", "velocities", "without the kitchen", "beyond half a turn", "parts of a nanosecond"],
)
def test_a_motion_is_read_back(tmp_path: Path, arrays: dict[str, np.ndarray]) -> None:
    motion, path = written(tmp_path, arrays)
    same(motion, read_motion(path, TWIN, PR2), tolerance=1e-9)


def test_a_bag_is_read_without_the_models_and_parted_with_them(tmp_path: Path) -> None:
    _, path = written(tmp_path, ARRAYS | SPEEDS)
    arrays = read_arrays(path)
    assert "robot_positions" not in arrays
    same(read_motion(path, TWIN, PR2), motion_of(arrays, TWIN, PR2), tolerance=0.0)
    listed = {name: array_of(name, array.tolist()) for name, array in arrays.items()}  # as JSON carries it
    same(read_motion(path, TWIN, PR2), motion_of(listed, TWIN, PR2), tolerance=0.0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"joint_names": None}, "there is no 'joint_names', and 'joint_positions' are"),
        ({"joint_positions": None}, "there is no 'joint_positions'"),
        ({"moving_joint_names": None}, "there is no 'moving_joint_names', and 'joint_vel"),
        ({"joint_positions": np.zeros((9, 3))}, r"'joint_positions' has the shape \(9, 3\)"),
        ({"robot_positions": np.zeros((9, 1))}, "the file has 'joint_names' and 'robot_positions'"),
        ({"base_joint": np.array(["low_drawer"])}, "of 'low_drawer', which is in the kitchen"),
        ({"joint_postions": np.zeros((9, 1)), "joint_positions": None}, "did you mean 'joint_positions'"),
    ],
)
def test_arrays_of_a_bag_that_do_not_fit_together_are_told(
    tmp_path: Path, change: dict[str, np.ndarray | None], message: str
) -> None:
    arrays = read_arrays(written(tmp_path, ARRAYS | SPEEDS)[1]) | change
    with pytest.raises(MotionError, match=message):
        motion_of({name: array for name, array in arrays.items() if array is not None}, TWIN, PR2)


def test_times_begin_at_0(tmp_path: Path) -> None:
    motion, path = written(tmp_path, ARRAYS | {"times": TIMES + 1e6})
    back = read_motion(path, TWIN, PR2)
    assert isinstance(back, BodyMotion)
    np.testing.assert_allclose(back.times, motion.times - 1e6, rtol=0, atol=1e-9)


def test_each_part_has_a_topic_and_a_file_that_is_there_is_replaced(tmp_path: Path) -> None:
    for _ in range(2):
        _, path = written(tmp_path, ARRAYS)
    with bag_at(path) as reader:
        found = {each.topic: (each.msgtype, each.msgcount) for each in reader.connections}
    assert found == {
        "/joint_trajectory": (JOINTS, 1),
        "/base_trajectory": (POSES, 1),
        "/kitchen/joint_trajectory": (JOINTS, 1),
    }
    assert [each.name for each in tmp_path.iterdir()] == ["motion.mcap"]


def test_a_containers_motion_has_no_bag(tmp_path: Path) -> None:
    motion = motion_of({"joint": np.array("low_drawer_joint"), "times": TIMES, "values": TIMES / 9}, TWIN)
    with pytest.raises(InputError, match=r"motion\.mcap.*allowed: \.npz, \.json, \.csv$"):
        write_motion(tmp_path / "motion.mcap", motion)


@pytest.mark.oracle
def test_what_was_certified_is_certified_from_its_bag(sdt, tmp_path: Path) -> None:
    asked = ("achieve", "--kitchen", "b", "--robot", "stretch", "--task", "open:iai_fridge_door")
    motion = str(tmp_path / "fridge.mcap")
    made = sdt(*asked, "--base", "0,0,4", "--motion-out", motion)
    assert made.code == 0, made.err
    again = sdt(*asked, "--base", "0,0,4", "--motion", motion)
    assert again.code == 0, again.out + again.err


def test_without_the_library_it_is_said_before_anything_is_searched(
    sdt, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("services.motions.ros_out.find_spec", lambda _name: None)
    assert util.find_spec("rosbags") is not None
    motion = str(tmp_path / "motion.mcap")
    done = sdt("achieve", "--kitchen", "nowhere", "--robot", "pr2", "--task", "open", "--motion-out", motion)
    assert done.code == 2
    assert "pip install 'sdt-kg[ros]'" in done.err
