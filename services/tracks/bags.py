"""Tracks in ROS 2 bags: PoseStamped, Odometry or TF, with WrenchStamped as force.

The poses are in the message's frame; those of TF in the root frame of the tree of transforms, what carries
a frame interpolated to its times. A wrench is given in the same frame, and interpolated likewise.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any  # messages are classes that rosbags makes from the bag's own definitions

import numpy as np

from predicates.learn.track import Array, Track
from sdt_kg.errors import InputError, MotionError
from services.bags import bag_at
from services.tracks.columns import FORCE, PLACE, TURN, track_of
from services.tracks.transforms import Transforms, row_of, seconds

POSE, ODOMETRY = "geometry_msgs/msg/PoseStamped", "nav_msgs/msg/Odometry"
TRANSFORMS, WRENCH = "tf2_msgs/msg/TFMessage", "geometry_msgs/msg/WrenchStamped"

ALLOWED = "PoseStamped, Odometry or TF, optional WrenchStamped"
STILL = "tf_static"
"""End of the topic of transforms that hold for all times, whenever they are told."""

Messages = Iterator[tuple[str, str, Any]]


@dataclass(frozen=True, slots=True)
class _Found:
    """Messages of one bag.

    Attributes:
        poses: Topic (or frame of TF) → rows t x y z qx qy qz qw.
        wrenches: Topic → rows t fx fy fz.
        frames: Topic (or frame of TF) → the frames in which it is given.
    """

    poses: dict[str, list[list[float]]] = field(default_factory=dict[str, list[list[float]]])
    wrenches: dict[str, list[list[float]]] = field(default_factory=dict[str, list[list[float]]])
    frames: dict[str, set[str]] = field(default_factory=dict[str, set[str]])


def read_bag(path: Path, topic: str | None, frame: str | None) -> Track:
    """The track in a bag.

    Raises:
        InputError: rosbags is not installed, or no bag that can be read.
        MotionError: No poses, those of several topics and none was chosen, or in several frames.
    """
    try:
        with bag_at(path) as reader:

            def messages(*, still: bool) -> Messages:
                # rosbags takes an empty list of connections for all of them
                for c, _, raw in reader.messages():
                    if c.topic.endswith(STILL) == still:
                        yield c.topic, c.msgtype, reader.deserialize(raw, c.msgtype)

            _check_whole(reader, path.name)
            known, moving = (
                [each for _, kind, one in heard if kind == TRANSFORMS for each in one.transforms]
                for heard in (messages(still=True), messages(still=False))
            )
            found = _found(messages(still=False), Transforms(known, moving), frame)
    except InputError:
        raise
    except Exception as error:  # noqa: BLE001 - whatever a foreign, damaged file makes the library raise
        raise InputError(f"{path} is no ROS bag: {error}", allowed=ALLOWED) from None
    chosen = _chosen(found, topic, frame, path.name)
    _check_frames(found, chosen)
    rows, names = _in_time(found.poses[chosen], chosen), ("t", *PLACE, *TURN)
    if found.wrenches:
        rows, names = _with_forces(rows, *next(iter(found.wrenches.items()))), (*names, *FORCE)
    rows[:, 0] -= rows[0, 0]
    return track_of(rows, names, f"{chosen} of {path.name}", [f"message {k + 1}" for k in range(len(rows))])


def _check_whole(reader: Any, name: str) -> None:  # noqa: ANN401 - of a library that may not be there
    """The bag has as many messages as it says.

    Raises:
        MotionError: It has others.
    """
    count, said = sum(1 for _ in reader.messages()), reader.message_count
    if count != said:
        raise MotionError(f"{name} has {count} messages, and says that it has {said}", allowed="a whole bag")


def _found(messages: Messages, transforms: Transforms, frame: str | None) -> _Found:
    found = _Found()
    for topic, kind, message in messages:
        if kind in {POSE, ODOMETRY}:
            pose = message.pose if kind == POSE else message.pose.pose
            row = [seconds(message.header), *row_of(pose.position, pose.orientation)]
            found.poses.setdefault(topic, []).append(row)
        elif kind == WRENCH:
            force = message.wrench.force
            row = [seconds(message.header), force.x, force.y, force.z]
            found.wrenches.setdefault(topic, []).append(row)
        elif kind == TRANSFORMS:
            for name, row in transforms.rows(message.transforms, frame).items():
                found.poses.setdefault(f"frame {name}", []).append(row)
                found.frames.setdefault(f"frame {name}", set()).add(transforms.roots[name])
        if kind in {POSE, ODOMETRY, WRENCH}:
            found.frames.setdefault(topic, set()).add(message.header.frame_id)
    return found


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


def _check_frames(found: _Found, chosen: str) -> None:
    """One topic of wrenches at most, and all of it and of the poses in one frame.

    Raises:
        MotionError: It is not so.
    """
    if len(found.wrenches) > 1:
        topics = ", ".join(sorted(found.wrenches))
        raise MotionError(f"wrenches of {topics}", allowed="one topic of WrenchStamped")
    for topic in (chosen, *found.wrenches):
        if len(frames := found.frames[topic]) > 1:
            what = f"{topic} is given in several frames: {', '.join(sorted(frames))}"
            raise MotionError(what, allowed="one frame, that of the world")
    if found.wrenches:
        (topic,), (poses,) = found.wrenches, found.frames[chosen]
        (wrenches,) = found.frames[topic]
        if poses != wrenches:
            what = f"{topic} is given in the frame '{wrenches}', {chosen} in '{poses}'"
            raise MotionError(what, allowed="wrenches in the frame of the poses", remedy="transform them")


def _in_time(said: list[list[float]], source: str) -> Array:
    """Rows in the order of their stamps; what is said twice, once.

    Raises:
        MotionError: Two rows of one stamp differ.
    """
    rows = np.unique(np.array(said, dtype=np.float64), axis=0)
    again = np.flatnonzero(np.diff(rows[:, 0]) == 0)
    if again.size:
        at = rows[again[0], 0]
        raise MotionError(
            f"two messages of {source} are stamped {at:.9f} s, and are not the same",
            allowed="stamps of when each was observed",
        )
    return rows


def _with_forces(rows: Array, topic: str, wrenches: list[list[float]]) -> Array:
    """Rows t, pose, force: interpolated between wrenches, missing before the first and after the last.

    Raises:
        MotionError: No pose is seen while wrenches are.
    """
    table = _in_time(wrenches, topic)
    at, times = rows[:, 0], table[:, 0]
    forces = [np.interp(at, times, table[:, k], left=np.nan, right=np.nan) for k in (1, 2, 3)]
    if not ((at >= times[0]) & (at <= times[-1])).any():
        what = f"no pose is of the time of {topic}, {times[0]:.3f} to {times[-1]:.3f} s"
        raise MotionError(what, allowed=f"{at[0]:.3f} to {at[-1]:.3f} s, one clock for both")
    return np.column_stack([rows, *forces])
