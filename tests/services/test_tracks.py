"""Track files: every order of columns, and every wrong file is told what is wrong with it."""

from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from predicates.learn import Track
from sdt_kg.errors import InputError, MotionError
from services.tracks import read_track

PLACES = np.column_stack([np.linspace(0, 0.3, 12), np.full(12, 0.2), np.full(12, 0.7)])
TURNS = np.tile([0.0, 0.0, 0.6, 0.8], (12, 1))
FORCES = np.tile([8.0, 0.0, 0.5], (12, 1))
TIMES = np.cumsum(np.linspace(0.02, 0.1, 12))[:, None]


def written(folder: Path, text: str, name: str = "track.csv") -> Path:
    path = folder / name
    path.write_text(text)
    return path


def rows(table: np.ndarray, divider: str = " ") -> str:
    return "\n".join(divider.join(f"{value:.9g}" for value in row) for row in table) + "\n"


@pytest.mark.parametrize("divider", [" ", ",", "; ", "\t"])
@pytest.mark.parametrize(
    ("parts", "timed"),
    [
        ([PLACES], False),
        ([TIMES, PLACES], True),
        ([PLACES, FORCES], False),
        ([PLACES, TURNS], False),
        ([TIMES, PLACES, FORCES], True),
        ([TIMES, PLACES, TURNS], True),
        ([PLACES, TURNS, FORCES], False),
        ([TIMES, PLACES, TURNS, FORCES], True),
    ],
)
def test_columns_in_their_order_need_no_header(
    tmp_path: Path, parts: list[np.ndarray], timed: bool, divider: str
) -> None:
    track = read_track(written(tmp_path, rows(np.hstack(parts), divider)))
    assert track.timed is timed
    assert track.positions == pytest.approx(PLACES)
    assert (track.orientations is not None) == any(part is TURNS for part in parts)
    assert (track.forces is not None) == any(part is FORCES for part in parts)


def test_a_header_names_columns_in_any_order(tmp_path: Path) -> None:
    table = np.hstack([FORCES, PLACES[:, ::-1], TIMES])
    track = read_track(written(tmp_path, "fx,fy,fz,z,y,x,Time\n" + rows(table, ",")))
    assert track.positions == pytest.approx(PLACES)
    assert track.times == pytest.approx(TIMES[:, 0])
    assert track.forces == pytest.approx(FORCES)


def test_samples_without_a_position_are_counted_and_left_out(tmp_path: Path) -> None:
    lines = rows(PLACES, ",").splitlines()
    lines[3], lines[7] = "nan,nan,nan", ",,"
    track = read_track(written(tmp_path, "# seen by a camera\n\n" + "\n".join(lines)))
    assert (len(track.positions), track.missing) == (10, 2)
    assert track.times.tolist() == list(range(10))


def test_an_array_that_means_nothing_is_not_left_out_silently(tmp_path: Path) -> None:
    np.savez(tmp_path / "track.npz", positions=np.zeros((9, 3)), t=np.arange(9.0))
    with pytest.raises(MotionError, match="array 't', which means nothing here"):
        read_track(tmp_path / "track.npz")


@pytest.mark.parametrize("twice", ["positions", "orientations"])
def test_places_and_turns_are_given_once(tmp_path: Path, twice: str) -> None:
    arrays = {"poses": np.hstack([PLACES, TURNS]), "positions": PLACES + 1, "orientations": TURNS}
    np.savez(tmp_path / "track.npz", poses=arrays["poses"], **{twice: arrays[twice]})
    with pytest.raises(MotionError, match=f"has 'poses' and '{twice}'; allowed: one of both"):
        read_track(tmp_path / "track.npz")


def test_an_archive_packed_in_an_unknown_way_is_told_so(tmp_path: Path) -> None:
    path = tmp_path / "track.npz"
    np.savez_compressed(path, positions=PLACES)
    packed = bytearray(path.read_bytes())
    packed[packed.index(b"PK\x01\x02") + 10] = 99
    path.write_bytes(packed)
    with pytest.raises(MotionError, match=r"is no \.npz of plain arrays: That compression method"):
        read_track(path)


def test_complex_numbers_are_no_positions(tmp_path: Path) -> None:
    np.savez(tmp_path / "track.npz", positions=np.zeros((9, 3)) * 1j)
    with pytest.raises(MotionError, match=r"holds complex128; allowed: real numbers"):
        read_track(tmp_path / "track.npz")


def test_a_motion_is_no_track_and_is_told_where_to_go(tmp_path: Path) -> None:
    np.savez(tmp_path / "motion.npz", joint=np.array("door_joint"), values=np.zeros(9))
    with pytest.raises(MotionError, match="it is a motion: --motion of sdt causes"):
        read_track(tmp_path / "motion.npz")


def test_arrays_in_npz(tmp_path: Path) -> None:
    path = tmp_path / "track.npz"
    np.savez(path, poses=np.hstack([PLACES, TURNS]), times=TIMES[:, 0], forces=FORCES)
    track = read_track(path)
    assert track.orientations == pytest.approx(TURNS)
    assert track.forces == pytest.approx(FORCES)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (rows(PLACES) + "0.1 0.2\n", "line 13 of track.csv has 2 columns; allowed: 3, as before"),
        *((rows(PLACES[:, ::2], each).replace(".", ","), "line 1 .* divided by , and") for each in " ;"),
        (rows(PLACES) + "0.1 0.2 up\n", "line 13 of track.csv: 'up' is no number"),
        (rows(1000 * PLACES), "line 1 of track.csv: a position of 700 m, probably in millimetres"),
        (rows(PLACES[:3]), "track.csv has 3 samples"),
        (rows(np.hstack([PLACES, PLACES])[:, :5]), "track.csv has 5 columns and no header"),
        (rows(np.hstack([PLACES[::-1], 2 * TURNS])), "7 columns that are neither"),
        (rows(np.hstack([TIMES + 1.7e18, PLACES])), r"line 1 .* the time 1.7e.18 s, probably in nanosec"),
        (rows(np.hstack([TIMES[::-1], PLACES])), r"line 2 of track.csv: the time .* is not after"),
        (
            rows(np.hstack([1.7e9 + 1e-8 * TIMES, PLACES])),
            r"line \d+ of track.csv: the time 1700000000 s is not after 1700000000 s",
        ),
        (
            rows(np.hstack([1e-12 * TIMES, PLACES])),
            "increasing times, each 1e-09 s or more after the one before",
        ),
        (
            rows(np.hstack([PLACES, 1e300 * PLACES])),
            "line 1 of track.csv: a force of 7e.299 N; allowed: N, up to",
        ),
        ("x y z qx\n" + rows(np.hstack([PLACES, TIMES])), "the header of track.csv lacks qy, qz, qw"),
        ("x y z speed\n" + rows(np.hstack([PLACES, TIMES])), "an unknown column 'speed'"),
        ("", "track.csv has no samples"),
        ("x y z\n", "track.csv has no samples"),
    ],
)
def test_a_wrong_file_is_told_its_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(MotionError, match=message):
        read_track(written(tmp_path, text))


def test_what_is_no_track_is_told_so(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no file at"):
        read_track(tmp_path / "nothing.csv")
    with pytest.raises(InputError, match=r"no kind of track ends in '.png'"):
        read_track(written(tmp_path, "", "track.png"))
    with pytest.raises(MotionError, match=r"is no \.npz of plain arrays"):
        read_track(written(tmp_path, "not a zip", "track.npz"))
    with pytest.raises(InputError, match="no ROS bag"):
        read_track(written(tmp_path, "not a bag", "track.mcap"))
    binary = tmp_path / "track.log"
    binary.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(MotionError, match="is no text"):
        read_track(binary)


def bag(folder: Path, topics: tuple[str, ...] = ("/handle",)) -> Path:
    """A bag with PoseStamped, a wrench, and TF of a camera that carries the handle's marker."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    types = store.types
    time, header = types["builtin_interfaces/msg/Time"], types["std_msgs/msg/Header"]
    point, vector = types["geometry_msgs/msg/Point"], types["geometry_msgs/msg/Vector3"]
    quaternion, pose = types["geometry_msgs/msg/Quaternion"], types["geometry_msgs/msg/Pose"]
    stamped = types["geometry_msgs/msg/TransformStamped"]
    path = folder / "bag"
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connections = {
            topic: writer.add_connection(topic, "geometry_msgs/msg/PoseStamped", typestore=store)
            for topic in topics
        }
        wrenches = writer.add_connection("/wrench", "geometry_msgs/msg/WrenchStamped", typestore=store)
        transforms = writer.add_connection("/tf", "tf2_msgs/msg/TFMessage", typestore=store)
        for k in range(12):
            stamp = round(TIMES[k, 0] * 1e9)
            head = header(time(0, stamp), "map")
            turn = quaternion(*TURNS[k])
            message = types["geometry_msgs/msg/PoseStamped"](head, pose(point(*PLACES[k]), turn))
            for connection in connections.values():
                writer.write(connection, stamp, store.serialize_cdr(message, connection.msgtype))
            wrench = types["geometry_msgs/msg/Wrench"](vector(*FORCES[k]), vector(0.0, 0.0, 0.0))
            message = types["geometry_msgs/msg/WrenchStamped"](head, wrench)
            writer.write(wrenches, stamp, store.serialize_cdr(message, wrenches.msgtype))
            # the camera stands 1 m ahead and is turned by 90° about z
            camera = types["geometry_msgs/msg/Transform"](
                vector(1.0, 0.0, 0.0), quaternion(0.0, 0.0, 0.5**0.5, 0.5**0.5)
            )
            marker = types["geometry_msgs/msg/Transform"](vector(*PLACES[k]), quaternion(0.0, 0.0, 0.0, 1.0))
            chain = [
                stamped(head, "camera", camera),
                stamped(header(head.stamp, "camera"), "marker", marker),
            ]
            message = types["tf2_msgs/msg/TFMessage"](chain)
            writer.write(transforms, stamp, store.serialize_cdr(message, transforms.msgtype))
    return path


def test_poses_and_wrenches_of_a_bag(tmp_path: Path) -> None:
    track = read_track(bag(tmp_path), topic="/handle")
    assert track.positions == pytest.approx(PLACES)
    assert track.orientations == pytest.approx(TURNS)
    assert track.forces == pytest.approx(FORCES)
    assert track.times == pytest.approx(TIMES[:, 0] - TIMES[0, 0])


def test_a_frame_of_tf_is_given_in_the_root_frame(tmp_path: Path) -> None:
    path = next(bag(tmp_path).glob("*.mcap"))
    track: Track = read_track(path, frame="marker")
    turned = np.column_stack([1.0 - PLACES[:, 1], PLACES[:, 0], PLACES[:, 2]])
    assert track.positions == pytest.approx(turned)


def test_a_bag_with_several_poses_asks_which(tmp_path: Path) -> None:
    with pytest.raises(MotionError, match="choose one with --topic or --frame"):
        read_track(bag(tmp_path, ("/handle", "/elbow")))
    with pytest.raises(MotionError, match="no poses of /knee; allowed: /elbow, /handle, frame camera"):
        read_track(bag(tmp_path / "again", ("/handle", "/elbow")), topic="/knee")
