"""Bags as they are recorded: what cannot be told apart, or was not observed, is not guessed."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from sdt_kg.errors import InputError, MotionError
from services import bags
from services.tracks import read_track

STORE = get_typestore(Stores.ROS2_HUMBLE)
TIMES = 5.0 + 0.1 * np.arange(20) ** 1.1
PLACES = np.column_stack([0.3 + 0.1 * TIMES, 0 * TIMES, 0.8 + 0 * TIMES])
SIDEWAYS = (0.0, 0.0, 0.5**0.5, 0.5**0.5)
Item = tuple[str, Any, float]


def of(name: str, *parts: Any) -> Any:
    return STORE.types[name](*parts)


def header(time: float, frame: str) -> Any:
    nanoseconds = round(time * 1e9)
    stamp = of("builtin_interfaces/msg/Time", nanoseconds // 10**9, nanoseconds % 10**9)
    return of("std_msgs/msg/Header", stamp, frame)


def pose(k: int, frame: str = "map") -> Item:
    place = of("geometry_msgs/msg/Point", *PLACES[k])
    turn = of("geometry_msgs/msg/Quaternion", 0.0, 0.0, 0.0, 1.0)
    message = of(
        "geometry_msgs/msg/PoseStamped", header(TIMES[k], frame), of("geometry_msgs/msg/Pose", place, turn)
    )
    return "/handle", message, TIMES[k]


def wrench(time: float, topic: str = "/wrench", frame: str = "map") -> Item:
    push, none = (of("geometry_msgs/msg/Vector3", x, 0.0, 0.0) for x in (time, 0.0))
    wrenched = of("geometry_msgs/msg/Wrench", push, none)
    return topic, of("geometry_msgs/msg/WrenchStamped", header(time, frame), wrenched), time


def hung(
    time: float, child: str, parent: str, at: Iterable[float], turn: Iterable[float] = (0.0, 0.0, 0.0, 1.0)
) -> Item:
    vector, quaternion = of("geometry_msgs/msg/Vector3", *at), of("geometry_msgs/msg/Quaternion", *turn)
    transform = of("geometry_msgs/msg/Transform", vector, quaternion)
    stamped = of("geometry_msgs/msg/TransformStamped", header(time, parent), child, transform)
    return "/tf", of("tf2_msgs/msg/TFMessage", [stamped]), time


def recorded(folder: Path, items: Iterable[Item], compression: CompressionMode | None = None) -> Path:
    path = folder / "bag"
    writer = Writer(path, version=9, storage_plugin=StoragePlugin.MCAP)
    if compression is not None:
        writer.set_compression(compression, CompressionFormat.ZSTD)
    with writer:
        connections = dict[str, Any]()
        for topic, message, time in items:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, message.__msgtype__, typestore=STORE)
            writer.write(
                connections[topic], round(time * 1e9), STORE.serialize_cdr(message, message.__msgtype__)
            )
    return path


POSES = [pose(k) for k in range(20)]
MARKERS = [hung(TIMES[k], "marker", "camera", PLACES[k]) for k in range(20)]
HARDER = ("/wrench", wrench(6.0)[1], 9.0)
HARDER[1].wrench.force.x = 8.0
_, CAMERA, _ = hung(6.0, "camera", "map", (1.0, 0.0, 0.0), SIDEWAYS)


@pytest.mark.parametrize("order", [0, 10, 20])
def test_what_stands_still_holds_for_all_times_whenever_it_is_told(tmp_path: Path, order: int) -> None:
    still = ("/tf_static", CAMERA, 6.0)
    track = read_track(recorded(tmp_path, [*MARKERS[:order], still, *MARKERS[order:]]), frame="marker")
    assert track.positions == pytest.approx(np.column_stack([1.0 - PLACES[:, 1], PLACES[:, 0], PLACES[:, 2]]))


def test_what_carries_a_marker_says_nothing_new_of_it(tmp_path: Path) -> None:
    cameras = [hung(time, "camera", "map", (0.0, 0.0, 0.0)) for time in TIMES]
    items = [item for k in range(20) for item in (cameras[k], *([MARKERS[k]] if k % 2 else []))]
    track = read_track(recorded(tmp_path, items), frame="marker")
    assert track.positions == pytest.approx(PLACES[1::2])


def test_what_carries_a_marker_is_where_it_was_when_the_marker_was_seen(tmp_path: Path) -> None:
    told = np.linspace(TIMES[0] - 0.1, TIMES[-2], 5)
    cameras = [hung(time, "camera", "map", (time, 0, 0), (0, 0, np.sin(time), np.cos(time))) for time in told]
    track = read_track(recorded(tmp_path, [*cameras, *MARKERS]), frame="marker")
    at, (x, _, z) = TIMES[:-1], PLACES[:-1].T
    assert track.missing == 1
    assert track.positions == pytest.approx(
        np.column_stack([at + x * np.cos(2 * at), x * np.sin(2 * at), z]), abs=1e-6
    )


def test_a_marker_fixed_to_what_moves_moves_with_it(tmp_path: Path) -> None:
    _, fixed, _ = hung(0.0, "marker", "drawer", (0.0, 0.0, 0.1))
    drawers = [hung(TIMES[k], "drawer", "map", PLACES[k]) for k in range(20)]
    track = read_track(recorded(tmp_path, [*drawers, ("/tf_static", fixed, 0.0)]), frame="marker")
    assert track.positions == pytest.approx(PLACES + np.array([0, 0, 0.1]))


def test_forces_are_missing_where_no_wrench_was_seen(tmp_path: Path) -> None:
    wrenches = [wrench(float(time)) for time in TIMES[4:16:2]]
    track = read_track(recorded(tmp_path, [*POSES, *wrenches]))
    assert track.missing == 9
    assert track.forces is not None
    assert track.forces[:, 0] == pytest.approx(TIMES[4:15])


@pytest.mark.parametrize(
    ("items", "message"),
    [
        ([*POSES[:9], *(pose(k, "odom") for k in range(9, 20))], "several frames: map, odom"),
        ([*POSES, *(wrench(t, f"/{t:.0f}") for t in (5.0, 9.0))], "wrenches of /5, /9; allowed: one topic"),
        ([*POSES, *(wrench(t, frame="wrist") for t in (5.0, 9.0))], "in the frame 'wrist', /handle in 'map'"),
        ([*POSES, *(wrench(t) for t in (105.0, 109.0))], "no pose is of the time of /wrench, 105.000 to 109"),
        ([*MARKERS[:9], hung(6, "camera", "map", (0, 0, 1)), *MARKERS[9:]], "camera at first and from map"),
        ([wrench(5.0, frame="wrist"), *MARKERS], "in the frame 'wrist', frame marker in 'camera'"),
        ([hung(6.0, "marker", "marker", (0.0, 0.0, 1.0))], "frame marker hangs from itself"),
        ([*MARKERS, hung(5.0, "marker", "camera", (0, 0, 1))], "two messages of frame marker .* 5.0+ s, and"),
        ([*POSES, wrench(6.0), wrench(7.0), HARDER], "two messages of /wrench are stamped 6.0+ s, and"),
    ],
)  # fmt: skip
def test_what_is_of_two_minds_is_refused(tmp_path: Path, items: list[Item], message: str) -> None:
    frame = "marker" if items[-1][0] == "/tf" else None
    with pytest.raises(MotionError, match=message):
        read_track(recorded(tmp_path, items), frame=frame)


def test_a_folder_without_a_bag_is_told_so(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is no ROS 2 bag"):
        read_track(tmp_path)


@pytest.mark.parametrize(
    ("was", "now", "message"),
    [
        (b"geometry_msgs/msg/PoseStamped", b"\xffeometry_msgs/msg/PoseStamped", "bag is no ROS bag: 'utf-8'"),
        (
            b"message_count: 20",
            b"message_count: 21",
            "bag has 20 messages, and says that it has 21; .* whole",
        ),
    ],
)
def test_a_damaged_bag_is_told_so(tmp_path: Path, was: bytes, now: bytes, message: str) -> None:
    bag = recorded(tmp_path, POSES)
    for file in bag.iterdir():
        file.write_bytes(file.read_bytes().replace(was, now))
    with pytest.raises(InputError, match=message):
        read_track(bag)


@pytest.mark.parametrize("mode", [CompressionMode.FILE, CompressionMode.MESSAGE])
def test_of_files_and_messages_no_more_is_unpacked_than_fits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, mode: CompressionMode
) -> None:
    bag = recorded(tmp_path, POSES, mode)
    assert len(read_track(bag).positions) == 20
    monkeypatch.setattr(bags, "MOST", 50)
    with pytest.raises(InputError, match="would have more than 50 bytes, and no more are"):
        read_track(bag)
