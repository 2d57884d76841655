"""The same motion in every format, and every damaged file is told where."""

import json
import math
import re
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sdt_kg.errors import MotionError
from sdt_kg.motion import BodyMotion, Motion
from services import http
from services.bags import MOST, unpacked
from services.motions import motion_of, read_arrays, read_motion, write_motion
from tests.small import small_twin

rosbag2 = pytest.importorskip("rosbags.rosbag2")
storage_mcap = pytest.importorskip("rosbags.rosbag2.storage_mcap")
typesys = pytest.importorskip("rosbags.typesys")
lz4 = pytest.importorskip("lz4.frame")

TWIN = small_twin("a", ("pr2", "stretch"))
PR2 = TWIN.robots[0]
TIMES = np.linspace(0.0, 4.0, 9)
SMOOTH = (1 - np.cos(np.linspace(0, np.pi, 9))) / 2
ARRAYS = {
    "times": TIMES,
    "base": np.column_stack([SMOOTH, SMOOTH / 3, 0.5 * SMOOTH]),
    "robot_joint_names": np.array(["lift_joint"]),
    "robot_positions": (0.5 + 0.5 * SMOOTH)[:, None],
    "kitchen_joint_names": np.array(["low_drawer_joint"]),
    "kitchen_positions": 0.46 * SMOOTH[:, None],
}
ZSTD = storage_mcap.zstd
TS = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)


def same(one: BodyMotion | Motion, other: BodyMotion | Motion, tolerance: float = 0.0) -> None:
    assert type(one) is type(other)
    for name in one.__dataclass_fields__:
        value = getattr(one, name)
        if isinstance(value, np.ndarray):
            np.testing.assert_allclose(getattr(other, name), value, rtol=0, atol=tolerance, err_msg=name)
        elif name != "phases":
            assert getattr(other, name) == value, name


@pytest.mark.parametrize("suffix", [".npz", ".json", ".csv"])
def test_a_body_motion_is_read_back_exactly_from_every_format(tmp_path: Path, suffix: str) -> None:
    motion = motion_of(
        {**ARRAYS, "phase_names": np.array(["drive", "follow"]), "phase_starts": np.array([0, 4])}, TWIN, PR2
    )
    write_motion(tmp_path / f"motion{suffix}", motion)
    back = read_motion(tmp_path / f"motion{suffix}", TWIN)
    same(motion, back)
    assert isinstance(back, BodyMotion)
    assert back.phases == (("drive", 0), ("follow", 4))


@pytest.mark.parametrize("suffix", [".npz", ".json", ".csv"])
@pytest.mark.parametrize(
    "arrays",
    [
        {"joint": "low_drawer_joint", "times": TIMES, "values": 0.46 * SMOOTH, "timed": False},
        {"joint": "low_drawer_joint", "times": TIMES, "values": SMOOTH / 3, "velocities": SMOOTH / 9},
        {"frame": "low_drawer_handle", "times": TIMES, "poses": np.tile([1.0, 0, 0.4, 0, 0, 0, 1], (9, 1))},
    ],
    ids=["values", "values and velocities", "poses"],
)
def test_a_containers_motion_too(tmp_path: Path, suffix: str, arrays: dict[str, object]) -> None:
    motion = motion_of({name: np.asarray(value) for name, value in arrays.items()}, TWIN)
    write_motion(tmp_path / f"motion{suffix}", motion)
    same(motion, read_motion(tmp_path / f"motion{suffix}", TWIN))
    if suffix == ".csv":
        timed = "true" if arrays.get("timed", True) else "false"
        assert f"# timed: {timed}\n" in (tmp_path / "motion.csv").read_text(), "as the page of motions has it"


SPEEDS = {
    "base_velocities": np.column_stack([SMOOTH / 2, SMOOTH / 6, SMOOTH / 4]),
    "robot_velocities": SMOOTH[:, None] / 4,
    "kitchen_velocities": SMOOTH[:, None] / 5,
}


def bag(
    folder: Path,
    *,
    base: str = "joints",
    frame: str = "world",
    points: int = 9,
    tilt: float = 0.0,
    rise: float = 0.0,
    scale: float = 1.0,
    roll: float = 0.0,
    speeds: int = 0,
    later: int = 0,
    placed: int = 1,
    others: Sequence[tuple[str, object]] = (),
    of: str = "world_joint",
    compression: object = None,
) -> Path:
    """ARRAYS as a bag, the first points of which have the velocities SPEEDS."""
    kinds = {
        name: TS.types[f"{package}/msg/{name}"]
        for package, name in (
            ("std_msgs", "Header"),
            ("builtin_interfaces", "Time"),
            ("builtin_interfaces", "Duration"),
            ("trajectory_msgs", "JointTrajectory"),
            ("trajectory_msgs", "JointTrajectoryPoint"),
            ("trajectory_msgs", "MultiDOFJointTrajectory"),
            ("trajectory_msgs", "MultiDOFJointTrajectoryPoint"),
            ("geometry_msgs", "Transform"),
            ("geometry_msgs", "Vector3"),
            ("geometry_msgs", "Quaternion"),
            ("geometry_msgs", "Twist"),
        )
    }
    none, header = np.zeros(0), kinds["Header"](kinds["Time"](0, 0), frame)

    def since(time: float) -> object:
        return kinds["Duration"](int(time), round((time % 1) * 1e9))

    names = ["lift_joint", "low_drawer_joint"]
    values = np.hstack([scale * ARRAYS["robot_positions"], ARRAYS["kitchen_positions"]])
    rates = np.hstack([SPEEDS["robot_velocities"], SPEEDS["kitchen_velocities"]])
    if base in {"joints", "twice"}:
        names, values = [*names, "base_x", "base_y", "base_yaw"], np.hstack([values, ARRAYS["base"]])
        rates = np.hstack([rates, SPEEDS["base_velocities"]])
    way = [
        kinds["JointTrajectoryPoint"](row, rate if k < speeds else none, none, none, since(t))
        for k, (t, row, rate) in enumerate(zip(TIMES, values, rates, strict=True))
    ]
    messages = [("/arm", kinds["JointTrajectory"](header, names, way))]
    if base in {"transforms", "twice"}:
        poses = [
            kinds["MultiDOFJointTrajectoryPoint"](
                [
                    kinds["Transform"](
                        kinds["Vector3"](x, y, rise * t),
                        kinds["Quaternion"](tilt, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)),
                    )
                ]
                * placed,
                [kinds["Twist"](kinds["Vector3"](vx, vy, 0.0), kinds["Vector3"](roll, 0.0, turn))][:speeds],
                [],
                since(t),
            )
            for t, (x, y, yaw), (vx, vy, turn) in zip(
                TIMES[:points], ARRAYS["base"], SPEEDS["base_velocities"], strict=False
            )
        ]
        begins = kinds["Header"](kinds["Time"](later, 0), frame)
        messages.append(("/base", kinds["MultiDOFJointTrajectory"](begins, [of], poses)))
    parts = {
        "joints of another": [("/base", "odom", slice(3))],
        "yaw of another": [("/at", frame, slice(2)), ("/base", "odom", slice(2, 3))],
        "halfway": [("/at", frame, slice(2))],
    }
    for topic, name, which in parts.get(base, []):
        rows = zip(TIMES, ARRAYS["base"][:, which], strict=True)
        at = [kinds["JointTrajectoryPoint"](row, none, none, none, since(t)) for t, row in rows]
        own = kinds["Header"](kinds["Time"](0, 0), name)
        messages.append((topic, kinds["JointTrajectory"](own, ["base_x", "base_y", "base_yaw"][which], at)))
    messages = [(topic, messages[0][1] if other is None else other) for topic, other in others] + messages
    writer = rosbag2.Writer(folder / "bag", version=9, storage_plugin=rosbag2.StoragePlugin.MCAP)
    if compression is not None:
        writer.set_compression(compression, rosbag2.CompressionFormat.ZSTD)
    with writer:
        connections: dict[str, Any] = {}
        for topic, message in messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, message.__msgtype__, typestore=TS)
            writer.write(connections[topic], 0, TS.serialize_cdr(message, message.__msgtype__))
    return folder / "bag"


def empty_way(*names: str) -> object:
    """A trajectory without points."""
    header = TS.types["std_msgs/msg/Header"](TS.types["builtin_interfaces/msg/Time"](0, 0), "world")
    return TS.types["trajectory_msgs/msg/JointTrajectory"](header, list(names), [])


def text(said: str) -> object:
    return TS.types["std_msgs/msg/String"](said)


def test_where_a_bag_is_wrong_is_told_alike_with_the_models_and_to_who_has_them(tmp_path: Path) -> None:
    folder = bag(tmp_path, scale=400.0)
    with pytest.raises(MotionError) as here:
        read_motion(folder, TWIN, PR2)
    with pytest.raises(MotionError) as there:
        motion_of(read_arrays(folder), TWIN, PR2)
    assert str(here.value) == f"{folder.name}: {there.value}"
    assert re.search(r"'robot_positions' of lift_joint at sample \d is ", str(here.value))


@pytest.mark.parametrize("mode", ["STORAGE", "MESSAGE", "FILE"])
def test_a_compressed_bag_says_the_same(tmp_path: Path, mode: str) -> None:
    folder = bag(tmp_path, compression=rosbag2.CompressionMode[mode])
    same(motion_of(ARRAYS, TWIN, PR2), read_motion(folder, TWIN, PR2), tolerance=1e-12)


@pytest.mark.parametrize("others", [[("/arm", None)], [("/say", text("hello"))]], ids=["repeated", "others"])
def test_a_trajectory_may_be_repeated_and_other_messages_may_be_there(
    tmp_path: Path, others: list[tuple[str, object]]
) -> None:
    same(motion_of(ARRAYS, TWIN, PR2), read_motion(bag(tmp_path, others=others), TWIN, PR2), tolerance=1e-12)


def test_a_bag_without_trajectories_says_what_it_has(tmp_path: Path) -> None:
    path = tmp_path / "bag"
    with rosbag2.Writer(path, version=9, storage_plugin=rosbag2.StoragePlugin.MCAP) as writer:
        said = writer.add_connection("/say", "std_msgs/msg/String", typestore=TS)
        writer.add_connection("/arm", "trajectory_msgs/msg/JointTrajectory", typestore=TS)
        writer.write(said, 0, TS.serialize_cdr(text("hello"), "std_msgs/msg/String"))
    with pytest.raises(MotionError, match=r"no trajectory of joints, but /say \(std_msgs/msg/String\);"):
        read_motion(path, TWIN, PR2)


@pytest.mark.parametrize("base", ["joints", "transforms"])
@pytest.mark.parametrize("speeds", [{}, SPEEDS])
def test_a_bag_says_the_same(tmp_path: Path, base: str, speeds: dict[str, np.ndarray]) -> None:
    folder = bag(tmp_path, base=base, speeds=len(TIMES) if speeds else 0)
    for path in (folder, folder / "bag.mcap"):
        same(motion_of(ARRAYS | speeds, TWIN, PR2), read_motion(path, TWIN, PR2), tolerance=1e-12)


def test_a_bag_becomes_json_by_the_line_that_the_page_of_http_has(tmp_path: Path) -> None:
    page = Path(http.__file__).with_name("README.md").read_text(encoding="utf-8")
    (line,) = re.findall(r"^python -c '(.*)'$", page, re.MULTILINE)
    made = bag(tmp_path, base="transforms", speeds=len(TIMES))
    (tmp_path / "fridge.mcap").write_bytes(next(made.glob("*.mcap")).read_bytes())
    subprocess.run([sys.executable, "-c", line], cwd=tmp_path, check=True)
    one, other = (read_motion(tmp_path / f"fridge{suffix}", TWIN, PR2) for suffix in (".json", ".mcap"))
    assert isinstance(one, BodyMotion)
    assert isinstance(other, BodyMotion)
    assert all((getattr(one, name) == getattr(other, name)).all() for name in ("times", "base", "q", "v"))
    assert (one.joints, one.kitchen_joints) == (other.joints, other.kitchen_joints)


@pytest.mark.parametrize("of", ["", "virtual_joint", "base"])
def test_the_joint_of_a_bags_transforms_may_be_called_as_the_base_is_or_as_nothing_is(
    tmp_path: Path, of: str
) -> None:
    path = bag(tmp_path, base="transforms", of=of)
    same(motion_of(ARRAYS, TWIN, PR2), read_motion(path, TWIN, PR2), tolerance=1e-12)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"base": "nowhere"}, "does not say where the base is; .* at every sample the same pose where"),
        ({"base": "twice"}, "says in joints and in /base where the base is; .* keep one of them"),
        ({"base": "halfway"}, "has 2 of the base's joints; allowed: all of base_x, base_y, base_yaw"),
        ({"base": "transforms", "points": 8}, "/base has 8 samples; allowed: 9"),
        ({"base": "transforms", "tilt": 0.1}, "tilted at sample 0"),
        (
            {"base": "transforms", "rise": 0.1},
            "z of the base is 0.05 m at sample 1 of /base; allowed: 0 m, as at sample 0",
        ),
        (
            {"base": "transforms", "speeds": 9, "roll": 0.1},
            "angular x of the base's velocity is 0.1 at sample 0 of /base; allowed: 0",
        ),
        ({"base": "transforms", "placed": 0}, "sample 0 of /base has 0 transforms; allowed: 1"),
        (
            {"base": "transforms", "later": 3},
            "/base begins at 3.0* s by .*; allowed: 0.0* s, as that of /arm",
        ),
        (
            {"base": "transforms", "of": "lift_joint"},
            "of 'lift_joint', which is a part of pr2 and not",
        ),
        (
            {"base": "transforms", "of": "low_drawer"},
            "of 'low_drawer', which is in the kitchen and",
        ),
        ({"frame": "odom"}, "bag: .* frame 'odom'; allowed: .*world"),
        ({"base": "joints of another"}, "bag: .* frame 'odom'; allowed: .*world"),
        ({"base": "yaw of another"}, "base are given in the frames odom and world; allowed: one frame"),
        ({"base": "yaw of another", "frame": ""}, "bag: .* frame 'odom'; allowed: .*world"),
        ({"others": [("/arm", empty_way("lift_joint"))]}, "message 2 of /arm is another than the first"),
        (
            {"others": [("/again", None)]},
            "trajectories of /again and /arm have the joint|/arm and /again have",
        ),
        ({"speeds": 8}, "sample 8 of /arm has 0 velocities; allowed: 5, one for each joint, at every sample"),
    ],
)
def test_a_wrong_bag_is_told_so(tmp_path: Path, options: dict[str, object], message: str) -> None:
    with pytest.raises(MotionError, match=message):
        read_motion(bag(tmp_path, **options), TWIN, PR2)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("damaged", "message"),
    [
        (lambda content: content[:200], "no readable ROS 2 bag"),
        (lambda content: content[:-40], r"no readable ROS 2 bag: [^;]*[^.]; allowed: messages of"),
        (
            lambda content: content.replace(b"\x03\x00\x00\x00cdr", b"\x03\x00\x00\x00xml"),
            "/arm are .* 'xml'.*cdr",
        ),
        (lambda content: content.replace(b"] velocities", b"] velocitiew"), "Point have other fields than"),
    ],
    ids=["cut at its head", "cut at its end", "another encoding", "other fields"],
)
def test_a_damaged_bag_is_told_so(tmp_path: Path, damaged: Callable[[bytes], bytes], message: str) -> None:
    file = bag(tmp_path) / "bag.mcap"
    file.write_bytes(damaged(file.read_bytes()))
    with pytest.raises(MotionError, match=message):
        read_motion(file, TWIN, PR2)


def edited(line: int, text: Callable[[str], str]) -> Callable[[list[str]], None]:
    def edit(lines: list[str]) -> None:
        lines[line - 1] = text(lines[line - 1])

    return edit


def cell(column: int, value: str) -> Callable[[str], str]:
    def change(line: str) -> str:
        cells = line.split(",")
        cells[column] = value
        return ",".join(cells)

    return change


# Lines 1 and 2 name robot and gripper, line 3 the columns: time, base_x, base_y, base_yaw, lift_joint, …
@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (edited(7, cell(4, "nan")), "'robot_positions' of lift_joint is not a number at line 7"),
        (edited(7, cell(4, "high")), "'high' in the column lift_joint of line 7 is no number"),
        (edited(8, cell(0, "0.1")), "times do not increase: line 7 is 1.5 s, line 8 is 0.1 s"),
        (edited(8, lambda line: line + ",1"), "line 8 has 12 values; allowed: 11"),
        (edited(8, cell(1, "900")), "x of 'base' at line 8 is 900 m, probably in millimetres"),
        (edited(8, cell(4, "700")), "lift_joint at line 8 .* millimetres"),
        (edited(8, cell(1, "90")), "x of the base jumps by .* from line 7 to line 8"),
        (edited(9, cell(3, "40")), "yaw of the base jumps by 3.* from line 8 to line 9"),
        (edited(3, lambda line: line.replace("base_yaw", "yaw", 1)), "there is no column 'base_yaw'"),
        (edited(3, lambda _: "kitchen,robot"), "it has the columns kitchen, robot; allowed: time, base_x"),
        (edited(3, lambda line: line.replace("base_x", "base_y", 1)), "line 3 names 'base_y' twice"),
        (edited(2, lambda _: "# base_frame: base_link"), "in the frame 'base_link'"),
        (edited(2, lambda _: "# Base_frame: base_link"), "line 2 .*'# Base_frame:', .* mean '# base_frame:'"),
        (edited(2, lambda _: "# base frame: base_link"), "line 2 .*'# base frame:', .* mean '# base_frame:'"),
        (edited(2, lambda _: "# base_frame = base_link"), "line 2 .*'# base_frame=', .* '# base_frame:'"),
        (edited(2, lambda _: "# phases: drive 0, follow"), "'phase_starts' is 'follow'"),
        (
            edited(2, lambda _: "# phases: drive 0, follow 4.7"),
            r"phases start at \[0, 4.7\]; allowed: .* to 8",
        ),
        (lambda lines: lines.append("# robot: stretch"), "line 13 gives another 'robot'; allowed: one"),
        (lambda lines: lines.__delitem__(slice(3, None)), "motion.csv: it has no samples"),
        (lambda lines: lines.__delitem__(2), "line 3 has the number 0.0 for the name of a column"),
        (edited(3, lambda line: line.replace(",", ";")), "line 3 names one column, 'time;base_x;.* commas"),
        (
            edited(3, lambda line: line.replace("velocity/kitchen/low", "velocity/low")),
            "there is a column 'velocity/low_drawer_joint', and none 'low_drawer_joint'",
        ),
        (
            edited(3, lambda line: line.replace("velocity/base_x", "elsewhere")),
            "there is no column 'velocity/base_x', but velocities of others of the base",
        ),
    ],
)
def test_a_wrong_line_is_named(tmp_path: Path, edit: Callable[[list[str]], None], message: str) -> None:
    file = tmp_path / "motion.csv"
    write_motion(file, motion_of(ARRAYS, TWIN, PR2))
    lines = file.read_text().splitlines()
    edit(lines)
    file.write_text("\n".join(lines))
    with pytest.raises(MotionError, match=message):
        read_motion(file, TWIN, PR2)


TWO_SAMPLES = {"times": [0, 1], "base": [[0, 0, 0]] * 2, "robot_joint_names": ["lift_joint"]}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", r"is no JSON: .*line 1 column 2"),
        ("[1, 2]", "holds a list"),
        (
            json.dumps({"times": [0, 1], "base": [[0, 0, 0], [0, 0]]}),
            "'base' at sample 1 has 2 values; allowed: 3",
        ),
        (json.dumps({"times": [0, None]}), "the motion has times"),
        ('{"times": [0, 1], "base": [], "times": [0, 2]}', "motion.json: it has 'times' twice"),
        (
            json.dumps({"times": [0, 10**400], "joint": "low_drawer_joint", "values": [0, 1]}),
            "motion.json: 'times' is '10{39}' at sample 1; allowed: real numbers",
        ),
        (
            json.dumps({"times": [0, 1], "base": [[0, 0, [1]], [0, 0, 0]]}),
            "'base' at sample 0 has a list among its values",
        ),
        (
            json.dumps({**TWO_SAMPLES, "robot_positions": [[0.5], ["up"]]}),
            "'robot_positions' of lift_joint is 'up' at sample 1; allowed: real numbers",
        ),
    ],
)
def test_wrong_json_is_told_where(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "motion.json").write_text(text)
    with pytest.raises(MotionError, match=message):
        read_motion(tmp_path / "motion.json", TWIN, PR2)


def test_a_chunk_unpacks_to_no_more_than_it_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def more(packed: bytes) -> bytes:
        return ZSTD.compress(packed + bytes(2**24))

    with monkeypatch.context() as patch:
        patch.setattr(storage_mcap, "zstd", SimpleNamespace(compress=more))
        file = bag(tmp_path, compression=rosbag2.CompressionMode.STORAGE) / "bag.mcap"
    with pytest.raises(
        MotionError, match=r"Chunk size mismatch: expected (\d+) bytes, got \d+; allowed"
    ) as said:
        read_motion(file, TWIN, PR2)
    expected, got = map(int, re.findall(r"\d+", str(said.value).partition("mismatch")[2])[:2])
    assert got == expected + 1


@pytest.mark.parametrize(
    ("make", "pack"),
    [(ZSTD.ZstdDecompressor, ZSTD.compress), (lz4.LZ4FrameDecompressor, lz4.compress)],
    ids=["zstd", "lz4"],
)
def test_frames_are_unpacked_as_they_were_packed_and_not_beyond(
    make: Callable[[], Any], pack: Callable[[bytes], bytes]
) -> None:
    packed = pack(b"one") + pack(b"another")
    assert unpacked(make, packed, 10) == b"oneanother"
    assert unpacked(make, packed, 5) == b"oneano"
    assert len(unpacked(make, pack(bytes(2**24)), 1000)) == 1001
    with pytest.raises(ValueError, match=f"{MOST} at most"):
        unpacked(make, packed, MOST + 1)
