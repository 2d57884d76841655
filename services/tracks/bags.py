"""Tracks in ROS 2 bags: PoseStamped, Odometry or TF, with WrenchStamped as force.

The poses are in the message's frame; those of TF in the root frame of the tree of transforms. A wrench
is taken to be given in the same frame, and is interpolated to the times of the poses.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any  # messages are classes that rosbags makes from the bag's own definitions

import numpy as np
from scipy.spatial.transform import Rotation

from predicates.learn.track import Array, Track
from sdt_kg.errors import InputError, MotionError
from services.tracks.columns import FORCE, PLACE, TURN, track_of

POSE, ODOMETRY = "geometry_msgs/msg/PoseStamped", "nav_msgs/msg/Odometry"
TRANSFORMS, WRENCH = "tf2_msgs/msg/TFMessage", "geometry_msgs/msg/WrenchStamped"

ALLOWED = "PoseStamped, Odometry or TF, optional WrenchStamped"

Tree = dict[str, tuple[str, Array, Rotation]]
"""Frame → the frame that it hangs from, and its pose there."""

LONGEST_CHAIN = 100
"""[1] Frames from a root; a longer chain is a loop."""


@dataclass(frozen=True, slots=True)
class _Found:
    """Messages of one bag: poses by topic (or frame of TF), each a row t x y z qx qy qz qw; wrenches."""

    poses: dict[str, list[list[float]]]
    wrenches: list[list[float]]


def read_bag(path: Path, topic: str | None, frame: str | None) -> Track:
    """The track in a bag.

    Raises:
        InputError: rosbags is not installed, or no bag.
        MotionError: No poses, or those of several topics and none was chosen.
    """
    try:
        from rosbags.highlevel import AnyReader, AnyReaderError  # noqa: PLC0415 - an extra
        from rosbags.typesys import Stores, get_typestore  # noqa: PLC0415 - an extra
    except ImportError:
        raise InputError("ROS bags need rosbags", remedy="pip install 'sdt-kg[ros]'") from None
    try:
        with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
            messages = (
                (c.topic, c.msgtype, reader.deserialize(raw, c.msgtype)) for c, _, raw in reader.messages()
            )
            found = _found(messages, frame)
    except AnyReaderError as error:
        raise InputError(f"{path.name} is no ROS bag: {error}", allowed=ALLOWED) from None
    chosen = _chosen(found, topic, frame, path.name)
    rows = np.array(found.poses[chosen], dtype=np.float64).reshape(-1, 8)
    _, order = np.unique(rows[:, 0], return_index=True)
    rows = rows[order]
    rows[:, 0] -= rows[0, 0] if not found.wrenches else 0
    names: tuple[str, ...] = ("t", *PLACE, *TURN)
    if found.wrenches:
        rows, names = _with_forces(rows, np.array(found.wrenches)), (*names, *FORCE)
    return track_of(rows, names, f"{chosen} of {path.name}", [f"message {k + 1}" for k in range(len(rows))])


def _found(messages: Iterator[tuple[str, str, Any]], frame: str | None) -> _Found:
    found = _Found({}, [])
    tree: Tree = {}
    for topic, kind, message in messages:
        if kind in {POSE, ODOMETRY}:
            pose = message.pose if kind == POSE else message.pose.pose
            found.poses.setdefault(topic, []).append(
                [_seconds(message.header), *_row(pose.position, pose.orientation)]
            )
        elif kind == WRENCH:
            force = message.wrench.force
            found.wrenches.append([_seconds(message.header), force.x, force.y, force.z])
        elif kind == TRANSFORMS:
            _follow(tree, message.transforms, frame, found)
    return found


def _follow(tree: Tree, transforms: list[Any], frame: str | None, found: _Found) -> None:
    """Rows for the frame that is meant, or for each that moves, once the whole message is known."""
    for each in transforms:
        _hang(tree, each)
    moved = {each.child_frame_id: _seconds(each.header) for each in transforms}
    for name in [frame] if frame else moved:
        stamps = [moved[each] for each in _ancestors(tree, name) if each in moved]
        if stamps:
            found.poses.setdefault(f"frame {name}", []).append([max(stamps), *_pose_in_root(tree, name)])


def _hang(tree: Tree, stamped: Any) -> None:  # noqa: ANN401 - see Any
    transform = stamped.transform
    row = _row(transform.translation, transform.rotation)
    if float(np.linalg.norm(row[3:])) < 0.5:
        raise MotionError(f"frame {stamped.child_frame_id} has no rotation", allowed="a unit quaternion")
    tree[stamped.child_frame_id] = (stamped.header.frame_id, np.array(row[:3]), Rotation.from_quat(row[3:]))


def _ancestors(tree: Tree, frame: str) -> list[str]:
    """The frame and those that it hangs from, so far as they are known."""
    chain: list[str] = []
    while frame in tree and len(chain) < LONGEST_CHAIN:
        chain.append(frame)
        frame = tree[frame][0]
    return chain


def _pose_in_root(tree: Tree, frame: str) -> list[float]:
    place, turn = np.zeros(3), Rotation.identity()
    for name in _ancestors(tree, frame):
        _, position, rotation = tree[name]
        place, turn = position + rotation.apply(place), rotation * turn
    return [*place.tolist(), *turn.as_quat().tolist()]


def _row(position: Any, orientation: Any) -> list[float]:  # noqa: ANN401 - see Any
    return [position.x, position.y, position.z, orientation.x, orientation.y, orientation.z, orientation.w]


def _seconds(header: Any) -> float:  # noqa: ANN401 - see Any
    return header.stamp.sec + header.stamp.nanosec * 1e-9


def _chosen(found: _Found, topic: str | None, frame: str | None, name: str) -> str:
    """The topic or frame that is meant."""
    wanted = f"frame {frame}" if frame else topic
    sources = sorted(found.poses)
    if wanted is None and len(sources) == 1:
        return sources[0]
    if wanted in found.poses:
        return str(wanted)
    what = f"no poses of {wanted}" if wanted else f"{len(sources)} sources of poses"
    remedy = "choose one with --topic or --frame" if sources else ""
    raise MotionError(f"{name} has {what}", allowed=", ".join(sources[:20]) or ALLOWED, remedy=remedy)


def _with_forces(rows: Array, wrenches: Array) -> Array:
    """Rows t, pose, force: the force interpolated in time, NaN-free, times from the first row."""
    times, order = np.unique(wrenches[:, 0], return_index=True)
    forces = [np.interp(rows[:, 0], times, wrenches[order, k]) for k in (1, 2, 3)]
    began = rows[:, 0] - rows[0, 0]
    return np.column_stack([began, rows[:, 1:], *forces])
