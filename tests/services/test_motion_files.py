"""Motion files: round trips, and every wrong file is told what is wrong with it."""

from pathlib import Path

import numpy as np
import pytest

from sdt_kg.errors import InputError, MotionError, UnknownEntityError
from sdt_kg.iri import joint_iri, model_iri
from sdt_kg.load import load_twin
from sdt_kg.motion import BodyMotion, Motion
from services.motions import motion_of, read_motion, write_motion
from tests.small import small_twin

TWIN = small_twin("a", ("pr2", "stretch"))
STRETCH = load_twin("b", ["stretch"])
PR2 = TWIN.robots[0]
DRAWER = TWIN.container("low_drawer")
TIMES = np.linspace(0.0, 4.0, 9)
SMOOTH = (1 - np.cos(np.linspace(0, np.pi, 9))) / 2

Arrays = dict[str, np.ndarray]


def container_motion(**other: object) -> Arrays:
    arrays = {"joint": "low_drawer_joint", "times": TIMES, "values": 0.46 * SMOOTH}
    return {name: np.asarray(value) for name, value in (arrays | other).items() if value is not None}


def body_motion(**other: object) -> Arrays:
    arrays = {
        "times": TIMES,
        "base": np.column_stack([SMOOTH, SMOOTH, np.zeros(9)]),
        "robot_joint_names": ["lift_joint"],
        "robot_positions": (0.5 + 0.5 * SMOOTH)[:, None],
    }
    return {name: np.asarray(value) for name, value in (arrays | other).items() if value is not None}


def saved(folder: Path, arrays: Arrays) -> Path:
    path = folder / "motion.npz"
    np.savez(path, **arrays)  # type: ignore[arg-type]
    return path


def read(folder: Path, arrays: Arrays) -> Motion | BodyMotion:
    return read_motion(saved(folder, arrays), TWIN, PR2)


def test_a_containers_motion_is_values_of_its_joint(tmp_path: Path) -> None:
    motion = read(tmp_path, container_motion())
    assert isinstance(motion, Motion)
    assert (motion.of, motion.values.shape, motion.timed) == (DRAWER.joint, (9, 1), True)
    assert motion.velocities is None


@pytest.mark.parametrize("more", [body_motion(), {"frame": np.asarray("low_drawer_handle")}])
def test_a_file_holds_one_motion(tmp_path: Path, more: Arrays) -> None:
    with pytest.raises(MotionError, match=r"motions of two kinds.*one motion in a file"):
        read(tmp_path, {**more, **container_motion()})


def test_values_may_be_a_column(tmp_path: Path) -> None:
    motion = read(tmp_path, container_motion(values=0.46 * SMOOTH[:, None]))
    assert isinstance(motion, Motion)
    assert motion.values.shape == (9, 1)


def test_a_frames_motion_is_poses(tmp_path: Path) -> None:
    poses = np.tile([1.0, 0, 0.4, 0, 0, 0, 1], (9, 1))
    motion = read(tmp_path, {"frame": np.asarray("low_drawer_handle"), "times": TIMES, "poses": poses})
    assert isinstance(motion, Motion)
    assert motion.is_poses
    assert motion.of == DRAWER.handle


def test_a_body_motion_without_velocities_gets_those_of_the_spline_at_rest(tmp_path: Path) -> None:
    motion = read(tmp_path, body_motion())
    assert isinstance(motion, BodyMotion)
    assert motion.v[[0, -1], 0] == pytest.approx([0, 0], abs=1e-12)
    middle = 0.25 * np.pi / 4  # d/dt of 0.5 + 0.5 · (1 - cos(π t / 4)) / 2 at t = 2
    assert motion.v[4, 0] == pytest.approx(middle, rel=1e-3)
    assert motion.kitchen_q.shape == (9, 0)


def test_what_stands_from_one_sample_to_the_next_does_not_swing_between_them(tmp_path: Path) -> None:
    moved = np.concatenate([np.zeros(4), 0.46 * np.linspace(0, 1, 3), np.full(2, 0.46)])[:, None]
    kitchen = {"kitchen_joint_names": ["low_drawer_joint"], "kitchen_positions": moved}
    motion = read(tmp_path, body_motion(**kitchen))
    assert isinstance(motion, BodyMotion)
    assert motion.kitchen_v[:, 0] == pytest.approx(
        [0, 0, 0, 0, 0, 0.75 * 0.46 / (TIMES[1] - TIMES[0]), 0, 0, 0]
    )


def test_a_name_may_be_a_list_of_one(tmp_path: Path) -> None:
    motion = read(tmp_path, body_motion(robot=["pr2"], gripper=["left"], base_frame=["map"]))
    assert isinstance(motion, BodyMotion)
    assert (motion.robot, motion.gripper) == (PR2, "left")


def test_a_body_motion_may_say_how_the_kitchen_moves(tmp_path: Path) -> None:
    kitchen = {"kitchen_joint_names": ["low_drawer_joint"], "kitchen_positions": 0.46 * SMOOTH[:, None]}
    motion = read(tmp_path, body_motion(**kitchen))
    assert isinstance(motion, BodyMotion)
    assert motion.kitchen_joints == (DRAWER.joint,)
    assert motion.kitchen_q[-1, 0] == 0.46


@pytest.mark.parametrize(
    "arrays",
    [
        container_motion(times=TIMES * 100),  # in milliseconds the drawer would be at five times its speed
        container_motion(times=TIMES * 1000, velocities=SMOOTH * 0 + 0.46 / 4000),
        body_motion(times=TIMES * 1000, robot_velocities=np.full((9, 1), 0.5 / 4000)),
        body_motion(
            times=TIMES * 20, robot_positions=SMOOTH[:, None] / 1e4, base=SMOOTH[:, None] * [9, 0, 0]
        ),
    ],
)
def test_what_moves_slowly_may_have_samples_far_apart(tmp_path: Path, arrays: Arrays) -> None:
    assert len(read(tmp_path, arrays).times) == len(TIMES)


def both_joints(lift: float, turn: float) -> Arrays:
    """A motion of Stretch's lift [m] and of a joint that turns [rad]."""
    positions = np.column_stack([lift * SMOOTH, turn * SMOOTH])
    return body_motion(robot_joint_names=["joint_lift", "joint_wrist_yaw"], robot_positions=positions)


@pytest.mark.parametrize(
    ("lift", "turn", "message"),
    [
        (
            57.3,
            57.3,
            "joint_wrist_yaw at .* rad, probably in degrees, and so is joint_lift.*: all of 'robot_posi",
        ),
        (
            57.3,
            1.0,
            "joint_lift at .* probably in millimetres, or in degrees, if all of 'robot_positions' was",
        ),
        (700.0, 1.0, "joint_lift at .* probably in millimetres; "),
        (700.0, 57.3, "joint_wrist_yaw at .* probably in degrees; "),
        (0.9, 57.3, "joint_wrist_yaw at .* probably in degrees; "),
    ],
)
def test_of_an_array_in_degrees_the_joints_that_turn_tell(
    tmp_path: Path, lift: float, turn: float, message: str
) -> None:
    with pytest.raises(MotionError, match=message):
        read_motion(saved(tmp_path, both_joints(lift, turn)), STRETCH, STRETCH.robots[0])


@pytest.mark.parametrize("arrays", [container_motion(), body_motion()])
def test_what_is_written_is_read_back(tmp_path: Path, arrays: Arrays) -> None:
    motion = read(tmp_path, arrays)
    again = tmp_path / "again.npz"
    write_motion(again, motion)
    back = read_motion(again, TWIN)
    assert type(back) is type(motion)
    for name in motion.__dataclass_fields__:
        np.testing.assert_array_equal(getattr(back, name), getattr(motion, name), err_msg=name)


def test_a_file_written_by_us_names_its_robot(tmp_path: Path) -> None:
    path = tmp_path / "motion.npz"
    motion = read(tmp_path, body_motion())
    write_motion(path, motion)
    for asked in (None, *TWIN.robots):
        again = read_motion(path, TWIN, asked)
        assert isinstance(again, BodyMotion)
        assert again.robot == PR2


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        (container_motion(times=TIMES[::-1]), "sample 0 is 4 s, sample 1 is 3.5 s"),
        (container_motion(times=TIMES[:1], values=SMOOTH[:1]), "1 samples"),
        (container_motion(values=np.where(TIMES == 2, np.nan, SMOOTH)), "not a number at sample 4"),
        (container_motion(values=SMOOTH[:-1]), r"'values' has the shape \(8,\); allowed: \(9\)"),
        (container_motion(values=SMOOTH * 460), "low_drawer_joint at sample 1 .* probably in millimetres"),
        (container_motion(joint="side_door_joint", values=SMOOTH * 80), "at sample 2 .* probably in degrees"),
        (container_motion(times=TIMES * 1000), "probably milliseconds; .* divide times by 1000$"),
        (container_motion(times=TIMES * 1e6), "probably microseconds; .* divide times by 1000000$"),
        (container_motion(times=TIMES * 1e9), "probably nanoseconds; .* divide times by 1000000000$"),
        (body_motion(times=TIMES / 1e3), "lift_joint moves at .* probably 1000 times too short; .* by 1000$"),
        (body_motion(times=TIMES / 1e6), "probably 1000000 times too short; .* multiply times by 1000000$"),
        (container_motion(values=None), "no 'values'"),
        (
            container_motion(values=["a"] * 9),
            "motion.npz: 'values' is 'a' at sample 0; allowed: real numbers",
        ),
        (container_motion(velocity=SMOOTH), "an array 'velocity', .* did you mean 'velocities'"),
        (body_motion(robot_velocites=SMOOTH[:, None]), "'robot_velocites', .* mean 'robot_velocities'"),
        (body_motion(robot_vel=SMOOTH[:, None]), "'robot_vel', .* did you mean 'robot_velocities'"),
        (
            body_motion(times=TIMES * 1000, robot_velocities=SMOOTH[:, None] / 4),
            "lift_joint, the fastest joint, .* milliseconds",
        ),
        (
            body_motion(base=np.column_stack([SMOOTH, SMOOTH, SMOOTH + 30])),
            "yaw of 'base' at sample 0 is 30 rad, .* degrees; .* up to 6.283; .* take whole turns off",
        ),
        (body_motion(base=np.zeros((9, 2))), r"'base' has the shape \(9, 2\)"),
        (body_motion(base=np.full((9, 3), 1500.0)), "x of 'base' at sample 0 .* probably in millimetres"),
        (body_motion(robot_positions=None), "no 'robot_positions'"),
        (body_motion(robot_positions=np.zeros((9, 2))), r"'robot_positions' has the shape \(9, 2\)"),
        (body_motion(robot_positions=700 * SMOOTH[:, None]), "lift_joint at sample 1 .* millimetres"),
        (body_motion(times=TIMES * 1000), "lift_joint, the fastest joint, .* milliseconds"),
        (
            body_motion(robot_joint_names=["lift_joint"] * 2, robot_positions=np.zeros((9, 2))),
            "lift_joint twice",
        ),
        (body_motion(phase_names=["follow"], phase_starts=[99]), r"phases start at \[99\]"),
        (body_motion(phase_names=["follow"], phase_starts=[3.9]), r"phases start at \[3.9\]"),
        (body_motion(robot_positions=SMOOTH[:, None] + 1j), "'robot_positions' holds complex128; .* real"),
        (body_motion(base=np.ones((9, 3), dtype=bool)), "'base' holds bool; allowed: real numbers"),
        (body_motion(gripper=np.array(b"\xff")), "'gripper' holds bytes that are no text; allowed: UTF-8"),
        (body_motion(times=np.arange(9).astype("M8[s]")), r"'times' holds datetime64\[s\]"),
        (body_motion(times=np.arange(9).astype("m8[s]")), r"'times' holds timedelta64\[s\]"),
        (body_motion(times=TIMES * 1e-200), "times do not increase: sample 0 .* 1e-09 s or more"),
        (
            body_motion(times=TIMES + 1e15),
            "'times' is 1e.15 at sample 0; allowed: finite numbers up to 1e.10",
        ),
        (
            body_motion(robot_velocities=np.full((9, 1), -1e300)),
            "'robot_velocities' of lift_joint is -1e.300 at sample 0",
        ),
        (body_motion(gripper=["left", "right"]), r"'gripper' holds <U5 of shape \(2,\); allowed: one name"),
        (body_motion(robot=7), "'robot' is 7; allowed: one name"),
        (body_motion(kitchen_positions=SMOOTH[:, None]), "'kitchen_positions', and no 'kitchen_joint_names'"),
        (
            body_motion(kitchen_velocities=SMOOTH[:, None]),
            "'kitchen_velocities', and no 'kitchen_joint_names'",
        ),
        (container_motion(joint=["low_drawer_joint"] * 2), "'joint' holds"),
        (container_motion(joint=[]), "'joint' holds"),
        (container_motion(timed="false"), "'timed' is 'false'; allowed: true or false"),
        (container_motion(timed=[True, False]), r"'timed' holds bool of shape \(2,\)"),
        ({"times": TIMES}, "allowed: times, base"),
    ],
)
def test_a_wrong_file_is_told_what_is_wrong(tmp_path: Path, arrays: Arrays, message: str) -> None:
    with pytest.raises(MotionError, match=message):
        read(tmp_path, arrays)


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        (container_motion(joint="low_drawer"), "no joint named 'low_drawer'; .*low_drawer_joint"),
        (container_motion(joint="wall_joint"), "no joint named 'wall_joint'"),
        (
            {"frame": np.asarray("handle"), "times": TIMES, "poses": np.zeros((9, 7))},
            "no frame named 'handle'",
        ),
        (body_motion(robot_joint_names=["lift"]), "no joint named 'lift'; .*lift_joint"),
        (
            body_motion(kitchen_joint_names=["low_joint"], kitchen_positions=np.zeros((9, 1))),
            "no joint named 'low_joint'",
        ),
    ],
)
def test_unknown_names_are_told_the_nearest(tmp_path: Path, arrays: Arrays, message: str) -> None:
    with pytest.raises(UnknownEntityError, match=message):
        read(tmp_path, arrays)


@pytest.mark.parametrize(
    ("joint", "allowed", "whose"),
    [
        ("torso_lift_joint", "allowed: camera_joint, ", "pr2 and tiago_dual have the motion's joint"),
        ("joint_wrist_rol", "did you mean 'joint_wrist_roll'?", ""),
        ("panda_joint1", "allowed: camera_joint, ", ""),
    ],
)
def test_of_a_joint_of_another_robot_none_is_proposed_and_whose_it_seems_is_told(
    joint: str, allowed: str, whose: str
) -> None:
    with pytest.raises(UnknownEntityError) as caught:
        motion_of(body_motion(robot_joint_names=[joint]), STRETCH, "stretch")
    told = str(caught.value)
    assert allowed in told
    assert ("did you mean" in told) == ("did you mean" in allowed)
    assert told.endswith(whose)
    assert ("have the motion" in told) == bool(whose)


def test_a_motion_made_in_another_kitchen_is_told_so(tmp_path: Path) -> None:
    foreign = body_motion(
        kitchen_joint_names=["shelf_joint", "hatch_joint"], kitchen_positions=np.zeros((9, 2))
    )
    with pytest.raises(MotionError, match="another kitchen: kitchen a has none of its 2"):
        read(tmp_path, foreign)


@pytest.mark.parametrize("content", [b"", b"not a zip", b"PK\x03\x04 broken"])
def test_what_is_no_npz_is_told_so(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "motion.npz"
    path.write_bytes(content)
    with pytest.raises(MotionError, match=r"is no \.npz"):
        read_motion(path, TWIN)


def test_pickled_objects_are_not_loaded(tmp_path: Path) -> None:
    path = tmp_path / "motion.npz"
    np.savez(path, times=np.array([object()], dtype=object))
    with pytest.raises(MotionError, match=r"is no \.npz of plain arrays"):
        read_motion(path, TWIN)


def test_an_archive_that_cannot_be_unpacked_is_told_so(tmp_path: Path) -> None:
    path = tmp_path / "motion.npz"
    np.savez_compressed(path, times=TIMES)
    packed = bytearray(path.read_bytes())
    packed[packed.index(b"PK\x01\x02") + 10] = 99  # how it is packed
    path.write_bytes(packed)
    with pytest.raises(MotionError, match=r"is no \.npz of plain arrays: That compression method"):
        read_motion(path, TWIN)


def test_a_folder_that_is_no_bag_is_told_so_with_the_recording_in_it(tmp_path: Path) -> None:
    folder = tmp_path / "recorded"
    folder.mkdir()
    with pytest.raises(
        InputError, match=r"no metadata\.yaml; allowed: \.npz, .*; give the file, or the folder"
    ):
        read_motion(folder, TWIN)
    (folder / "run_0.mcap").touch()
    with pytest.raises(InputError, match=r"give the file .*run_0\.mcap$"):
        read_motion(folder, TWIN)


def test_a_missing_file_is_told_so(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no file at"):
        read_motion(tmp_path / "none.npz", TWIN)


def test_a_fixed_joint_may_be_listed_if_it_stands_still(tmp_path: Path) -> None:
    names = ["wall_joint", "low_drawer_joint"]
    still = np.column_stack([np.zeros(9), 0.46 * SMOOTH])
    motion = read(tmp_path, body_motion(kitchen_joint_names=names, kitchen_positions=still))
    assert isinstance(motion, BodyMotion)
    assert motion.kitchen_joints == (DRAWER.joint,)
    moving = read(tmp_path, body_motion(kitchen_joint_names=names, kitchen_positions=still[:, ::-1]))
    assert isinstance(moving, BodyMotion)  # for the verdict to refuse
    assert moving.kitchen_joints == (joint_iri("a", "wall_joint"), DRAWER.joint)


def test_slow_waypoints_are_not_taken_for_milliseconds(tmp_path: Path) -> None:
    motion = read(tmp_path, container_motion(times=TIMES * 3))  # 1.5 s apart, a tenth of the drawer's speed
    assert motion.times[-1] == 12


TAU = "# joint: low_drawer_joint\n# timed: {}\ntime,value{}\n0,0{}\n4,0.4{}\n"


def test_a_line_of_csv_that_names_nothing_known_is_a_comment(tmp_path: Path) -> None:
    (tmp_path / "motion.csv").write_text(
        "# made by: hand\n# fast, = sure\n" + TAU.format("False", "", "", "")
    )
    motion = read_motion(tmp_path / "motion.csv", TWIN)
    assert isinstance(motion, Motion)
    assert not motion.timed


@pytest.mark.parametrize("line", ["# time: s", "# time: 2024-05-01 10:30", "# Time = seconds", "# times: 2"])
def test_a_comment_that_tells_the_time_is_no_misspelled_head(tmp_path: Path, line: str) -> None:
    (tmp_path / "motion.csv").write_text(f"{line}\n" + TAU.format("false", "", "", ""))
    motion = read_motion(tmp_path / "motion.csv", TWIN)
    assert isinstance(motion, Motion)
    assert not motion.timed


@pytest.mark.parametrize("line", ["# time: false", "# times: True", "# timd: 3"])
def test_a_misspelled_head_is_asked_about(tmp_path: Path, line: str) -> None:
    (tmp_path / "motion.csv").write_text(f"{line}\n" + TAU.format("false", "", "", ""))
    with pytest.raises(MotionError, match="did you mean '# timed:'"):
        read_motion(tmp_path / "motion.csv", TWIN)


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        (("no", "", "", ""), "'timed' is 'no'; allowed: true or false"),
        (
            ("true", ",velocity", ",0.1", ",0.1"),
            "column 'velocity', which .* allowed: time, .*velocity/value",
        ),
        (("true", ",base_x", ",0", ",0"), "a column 'base_x', which means nothing"),
    ],
)
def test_nothing_of_a_containers_csv_is_left_out(
    tmp_path: Path, parts: tuple[str, ...], message: str
) -> None:
    (tmp_path / "motion.csv").write_text(TAU.format(*parts))
    with pytest.raises(MotionError, match=message):
        read_motion(tmp_path / "motion.csv", TWIN)


def test_another_format_is_told_which_there_are(tmp_path: Path) -> None:
    (tmp_path / "motion.yaml").write_text("times: []")
    with pytest.raises(InputError, match=r"\.npz, \.json, \.csv, \.mcap"):
        read_motion(tmp_path / "motion.yaml", TWIN, PR2)


def test_a_motion_of_another_robot_is_read_as_one(tmp_path: Path) -> None:
    names = ["shoulder", "elbow", "wrist"]
    other = read(tmp_path, body_motion(robot_joint_names=names, robot_positions=np.zeros((9, 3))))
    assert isinstance(other, BodyMotion)
    assert other.robot == model_iri("another robot")
    assert other.joints == ("shoulder", "elbow", "wrist")


def test_a_motion_that_names_a_robot_beside_the_one_that_is_asked_about_is_of_that_one(
    tmp_path: Path,
) -> None:
    other = read(tmp_path, body_motion(robot="stretch", robot_joint_names=["shoulder"]))
    assert isinstance(other, BodyMotion)
    assert other.robot == model_iri("stretch")
    assert other.joints == ("shoulder",)
