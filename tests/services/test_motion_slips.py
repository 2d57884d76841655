"""Files with the slips that people and their tools make most: each is told what to do."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from sdt_kg.errors import MotionError
from sdt_kg.motion import BodyMotion
from services.motions import motion_of, read_motion, write_motion
from tests.small import small_twin

TWIN = small_twin("a", ("pr2",))
TIMES = np.linspace(0.0, 4.0, 9)
SMOOTH = (1 - np.cos(np.linspace(0, np.pi, 9))) / 2
BODY = {
    "times": TIMES,
    "base": np.zeros((9, 3)),
    "robot_joint_names": np.array(["lift_joint"]),
    "robot_positions": (0.5 + 0.1 * SMOOTH)[:, None],
}
LISTS = {name: array.tolist() for name, array in BODY.items()}


def said_of(path: Path) -> str:
    with pytest.raises(MotionError) as told:
        read_motion(path, TWIN)
    return str(told.value)


@pytest.mark.parametrize(
    "spoiled",
    [
        lambda text: "// the left arm\n" + text,
        lambda text: f"```json\n{text}\n```",
        lambda text: text[:-1] + ",}",
        lambda text: text.replace('"', "'"),
    ],
    ids=["comment", "fence", "comma", "quotes"],
)
def test_what_is_nearly_json_is_told_what_json_has_not(tmp_path: Path, spoiled: Callable[[str], str]) -> None:
    path = tmp_path / "motion.json"
    path.write_text(spoiled(json.dumps(LISTS)), encoding="utf-8")
    assert said_of(path).endswith(
        "; JSON has neither comments nor text around it, no comma before a closing bracket, "
        "and names in double quotes"
    )


def table(tmp_path: Path, edit: Callable[[int, str], str]) -> Path:
    """The motion as CSV, each line edited; the columns are named in the first."""
    path = tmp_path / "motion.csv"
    write_motion(path, motion_of(BODY, TWIN))
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    path.write_text("\n".join(edit(number, line) for number, line in enumerate(lines)))
    return path


def test_the_column_of_indices_that_a_data_frame_writes_is_told(tmp_path: Path) -> None:
    said = said_of(table(tmp_path, lambda number, line: f"{number - 1 if number else ''},{line}"))
    assert said.startswith("motion.csv: line 1 has no name for column 1, ''; allowed: time, base_x")
    assert said.endswith("name it, or leave the column out, as pandas does with index=False")


@pytest.mark.parametrize("name", ["t", "time [s]", "Time"])
def test_a_column_of_times_by_another_name_is_missed(tmp_path: Path, name: str) -> None:
    said = said_of(table(tmp_path, lambda number, line: line if number else line.replace("time", name, 1)))
    assert said.startswith(
        f"motion.csv: there is no column 'time' in line 1: it has the columns {name}, base"
    )


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        (
            {"base": np.zeros((9, 7))},
            "'base' has the shape (9, 7); allowed: (9, 3): x, y, yaw",
        ),
        (
            {"times": np.where(TIMES == 2.0, 1.5, TIMES)},
            "times do not increase: sample 3 is 1.5 s, sample 4 is 1.5 s; allowed: times in seconds, "
            "each 1e-09 s or more after the one before; leave one of the two samples out",
        ),
        (
            {"robot_joint_names": np.array(["low_drawer_joint"])},
            "'robot_joint_names' has 'low_drawer_joint', which is a joint of kitchen a; "
            "allowed: joints of pr2; list it in 'kitchen_joint_names'; "
            "in CSV, name the column kitchen/low_drawer_joint",
        ),
        ({"gripper": np.array(["l", "r"])}, "'gripper' holds <U1 of shape (2,); allowed: one name"),
        ({"gripper": np.array(1)}, "'gripper' is 1; allowed: one name"),
    ],
)
def test_a_wrong_array_is_told_what_it_should_be(changed: dict[str, np.ndarray], said: str) -> None:
    with pytest.raises(MotionError) as told:
        motion_of(BODY | changed, TWIN)
    assert str(told.value) == said


def test_names_kept_as_objects_are_told_how_to_be_saved(tmp_path: Path) -> None:
    path = tmp_path / "motion.npz"
    np.savez(path, **BODY | {"robot_joint_names": np.array(["lift_joint"], dtype=object)})  # type: ignore[arg-type]
    assert "numbers or texts are read: save np.array(…, dtype=str), or float" in said_of(path)


def test_lists_are_a_motion_as_json_has_them() -> None:
    motion, same = motion_of(LISTS, TWIN), motion_of(BODY, TWIN)
    assert isinstance(motion, BodyMotion)
    assert isinstance(same, BodyMotion)
    assert (motion.robot, motion.joints, motion.q.tolist()) == (same.robot, same.joints, same.q.tolist())
    with pytest.raises(MotionError, match="'base' at sample 1 has 2 values; allowed: 3, as at sample 0"):
        motion_of(LISTS | {"base": [[0, 0, 0], [0, 0]]}, TWIN)


def test_a_file_and_its_robot_may_be_texts(tmp_path: Path) -> None:
    path = str(tmp_path / "motion.json")
    write_motion(path, motion_of(BODY, TWIN))
    motion = read_motion(path, TWIN, "pr2")
    assert isinstance(motion, BodyMotion)
    assert motion.robot == TWIN.robots[0]
