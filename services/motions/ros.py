"""Motions as ROS 2 bags (MCAP): JointTrajectory messages, and where they say the base is.

Whose joints those of a `trajectory_msgs/JointTrajectory` are, the models tell: `services.motions.whose`.
The base comes either from a `trajectory_msgs/MultiDOFJointTrajectory` of one joint, whose transforms are
world_T_base, or from three joints named `base_x`, `base_y`, `base_yaw`.
Velocities of the base are those of its origin in the same frame, and of its turn about z.
Each topic has one trajectory, which may be repeated; all must have the same stamp and times from start.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from sdt_kg.errors import InputError, MotionError
from sdt_kg.motion import BASE_JOINTS, Array
from services.bags import bag_at
from services.motions.base import check_plane, planar
from services.motions.given import Given
from services.motions.whose import BASE_JOINT, rates_of, whole

JOINTS, POSES = "trajectory_msgs/msg/JointTrajectory", "trajectory_msgs/msg/MultiDOFJointTrajectory"
TYPES = (
    *(JOINTS, POSES, "trajectory_msgs/msg/JointTrajectoryPoint", "std_msgs/msg/Header"),
    *("trajectory_msgs/msg/MultiDOFJointTrajectoryPoint", "builtin_interfaces/msg/Time"),
    *("builtin_interfaces/msg/Duration", "geometry_msgs/msg/Transform", "geometry_msgs/msg/Twist"),
    *("geometry_msgs/msg/Vector3", "geometry_msgs/msg/Quaternion"),
)
"""Of trajectories, and of what they consist of."""
CDR = "cdr"
"""How ROS 2 writes messages."""
NANO = 1e-9
SAME_TIME = 1e-6  # [s]
ALLOWED = f"messages of {JOINTS}, with the base as {POSES} or as joints {', '.join(BASE_JOINTS)}"

Message = Any  # types of rosbags' messages are made at run time


def read_bag(path: Path) -> Given:
    """The arrays in a bag, of joints that are somebody's; samples are its points.

    Raises:
        InputError: The library for bags is not installed.
        MotionError: No bag, no trajectory, no base, or parts that do not fit together.
    """
    joints, poses = _messages(path)
    _check_stamps([*joints, *poses])
    times = _times(joints[0][1].points, joints[0][0])
    columns: dict[str, Array] = {}
    speeds: dict[str, Array] = {}
    whose: dict[str, str] = {}
    for topic, message in joints:
        _check_times(times, _times(message.points, topic), topic)
        for name, q, v in _columns(topic, message):
            if name in columns:
                said = f"the trajectories of {whose[name]} and {topic} have the joint '{name}'"
                raise MotionError(said, allowed="each joint once")
            columns[name], whose[name] = q, topic
            if v is not None:
                speeds[name] = v
    arrays = {"times": times} | _base(columns, speeds, poses, times, _frame(joints))
    arrays |= whole(columns, {name: v for name, v in speeds.items() if name in columns})
    return Given(arrays)


def _messages(path: Path) -> tuple[list[tuple[str, Message]], list[tuple[str, Message]]]:
    """The trajectory of each topic, of joints and of poses.

    Raises:
        MotionError: No bag, none of joints, several on a topic, or messages that are not as the bag says.
    """
    found: dict[str, tuple[str, Message]] = {}
    try:
        with bag_at(path) as reader:
            wanted = [each for each in reader.connections if each.msgtype in {JOINTS, POSES}]
            _check_some(reader.connections)
            _check_fields(reader.typestore.fielddefs, reader.default_typestore.fielddefs)
            for topic, (kind, raw) in _raw(reader, wanted).items():
                found[topic] = kind, reader.deserialize(raw, kind)
    except InputError:
        raise
    except Exception as error:  # noqa: BLE001 - whatever a foreign, damaged file makes the library raise
        why = str(error).rstrip(".")
        raise MotionError(f"it is no readable ROS 2 bag: {why}", allowed=ALLOWED) from None
    of_kind = {
        kind: [(topic, message) for topic, (each, message) in sorted(found.items()) if each == kind]
        for kind in (JOINTS, POSES)
    }
    return of_kind[JOINTS], of_kind[POSES]


def _check_some(connections: list[Message]) -> None:
    """There is a trajectory of joints."""
    if not any(each.msgtype == JOINTS and each.msgcount for each in connections):
        there = sorted({f"{each.topic} ({each.msgtype})" for each in connections if each.msgcount})
        said = f"it has no trajectory of joints, but {', '.join(there[:8]) or 'no messages'}"
        raise MotionError(said, allowed=ALLOWED)


def _raw(reader: Message, wanted: list[Message]) -> dict[str, tuple[str, bytes]]:
    """Kind and bytes of the one trajectory of each topic."""
    found: dict[str, tuple[str, bytes]] = {}
    counts = dict.fromkeys((each.topic for each in wanted), 0)
    for each in wanted:
        if each.ext.serialization_format != CDR:
            said = f"messages of {each.topic} are written as '{each.ext.serialization_format}'"
            raise MotionError(said, allowed=CDR)
    for connection, _, raw in reader.messages(wanted):
        counts[connection.topic] += 1
        trajectory = connection.msgtype, bytes(raw)
        if found.setdefault(connection.topic, trajectory) != trajectory:
            raise MotionError(
                f"message {counts[connection.topic]} of {connection.topic} is another than the first",
                allowed="one on each topic; it may be repeated",
                remedy="keep the one that is meant, or join them to one",
            )
    for topic, count in counts.items():
        said = sum(each.msgcount for each in wanted if each.topic == topic)
        if count != said:
            raise MotionError(
                f"it has {count} messages of {topic}, and says that it has {said}",
                allowed="a whole bag",
            )
    return found


def _check_fields(theirs: Mapping[str, object], ours: Mapping[str, object]) -> None:
    """What the bag calls by the name of a message that is read here is that message."""
    for name in TYPES:
        if name in theirs and theirs[name] != ours[name]:
            raise MotionError(f"its messages {name} have other fields than those of ROS 2", allowed=ALLOWED)


def _check_stamps(messages: list[tuple[str, Message]]) -> None:
    """All trajectories begin at once: their points' times are from their own stamps."""
    first, *others = [(topic, each.header.stamp) for topic, each in messages]
    for topic, stamp in others:
        if abs(stamp.sec - first[1].sec + NANO * (stamp.nanosec - first[1].nanosec)) > SAME_TIME:
            raise MotionError(
                f"the trajectory of {topic} begins at {_seconds(stamp)} s by its header's stamp",
                allowed=f"{_seconds(first[1])} s, as that of {first[0]}: all begin at once",
                remedy="give all trajectories one stamp",
            )


def _seconds(stamp: Message) -> str:
    return f"{stamp.sec}.{stamp.nanosec:09d}"


def _times(points: list[Message], topic: str) -> Array:
    if not points:
        raise MotionError(f"the trajectory of {topic} has no samples", allowed="two or more")
    stamps = [each.time_from_start for each in points]
    return np.array([stamp.sec + NANO * stamp.nanosec for stamp in stamps])


def _check_times(times: Array, others: Array, topic: str) -> None:
    if len(times) != len(others):
        raise MotionError(
            f"{topic} has {len(others)} samples", allowed=f"{len(times)}, as the first trajectory"
        )
    apart = np.flatnonzero(np.abs(times - others) > SAME_TIME)
    if apart.size:
        k = int(apart[0])
        raise MotionError(
            f"sample {k} of {topic} is at {others[k]:.6g} s", allowed=f"{times[k]:.6g} s, as in the first"
        )


def _columns(topic: str, message: Message) -> Iterator[tuple[str, Array, Array | None]]:
    """Name, positions and, if all points have them, velocities of each joint."""
    names, points = list(message.joint_names), message.points
    for k, point in enumerate(points):
        if len(point.positions) != len(names):
            raise MotionError(
                f"sample {k} of {topic} has {len(point.positions)} positions",
                allowed=f"{len(names)}, one for each joint",
            )
    moving = _has_velocities(topic, points, len(names))
    for i, name in enumerate(names):
        q = np.array([point.positions[i] for point in points])
        yield name, q, np.array([point.velocities[i] for point in points]) if moving else None


def _has_velocities(topic: str, points: list[Message], count: int) -> bool:
    """Whether all points have so many velocities, not none."""
    for k, point in enumerate(points):
        if len(point.velocities) != len(points[0].velocities) or len(point.velocities) not in {0, count}:
            raise MotionError(
                f"sample {k} of {topic} has {len(point.velocities)} velocities",
                allowed=f"{count}, one for each joint, at every sample, or none at any",
            )
    return len(points[0].velocities) > 0


def _frame(joints: list[tuple[str, Message]]) -> str:
    """The one frame that trajectories of the base's joints name; none where they name none."""
    named = {each.header.frame_id for _, each in joints if {*BASE_JOINTS} & {*each.joint_names}} - {""}
    if len(named) > 1:
        said = f"joints of the base are given in the frames {' and '.join(sorted(named))}"
        raise MotionError(said, allowed="one frame for all of them")
    return next(iter(named), "")


def _base(
    columns: dict[str, Array],
    speeds: dict[str, Array],
    poses: list[tuple[str, Message]],
    times: Array,
    frame: str,
) -> dict[str, np.ndarray]:
    """Base, its velocities and its frame; joints of the base are taken out of the columns."""
    own = [columns.pop(name) for name in BASE_JOINTS if name in columns]
    if len(own) == len(BASE_JOINTS) and not poses:
        return _framed(np.array(own).T, rates_of(speeds, BASE_JOINTS), frame)
    if own or len(poses) != 1 or len(poses[0][1].joint_names) != 1:
        raise _of_base(len(own), poses)
    topic, message = poses[0]
    _check_times(times, _times(message.points, topic), topic)
    for k, point in enumerate(message.points):
        if len(point.transforms) != 1:
            said = f"sample {k} of {topic} has {len(point.transforms)} transforms"
            raise MotionError(said, allowed="1, of the base")
    base = np.array([planar(k, point.transforms[0]) for k, point in enumerate(message.points)])
    base[:, 2] = np.unwrap(base[:, 2])
    turning = _has_velocities(topic, message.points, 1)
    twists = [point.velocities[0] for point in message.points] if turning else []
    check_plane(topic, [point.transforms[0].translation.z for point in message.points], twists)
    rates = np.array([(each.linear.x, each.linear.y, each.angular.z) for each in twists])
    of = {BASE_JOINT: np.array(message.joint_names, dtype=np.str_)}
    return of | _framed(base, rates if turning else None, message.header.frame_id)


def _of_base(own: int, poses: list[tuple[str, Message]]) -> MotionError:
    """That the bag does not say where the base is, or says it twice.

    Args:
        own: How many of the base's three joints it has.
        poses: The trajectories of poses that it has.
    """
    where = [topic for topic, _ in poses]
    if not own and not poses:
        stands = "add it, at every sample the same pose where the base stands still"
        return MotionError("the bag does not say where the base is", allowed=ALLOWED, remedy=stands)
    if not poses:
        return MotionError(
            f"the bag has {own} of the base's joints", allowed=f"all of {', '.join(BASE_JOINTS)}"
        )
    if own or len(poses) > 1:
        said = " and in ".join([*(["joints"] if own else []), *where])
        return MotionError(
            f"the bag says in {said} where the base is", allowed="once", remedy="keep one of them"
        )
    names = poses[0][1].joint_names
    said = f"{where[0]} has poses of {len(names)} joints{': ' if len(names) else ''}{', '.join(names)}"
    return MotionError(said, allowed="1, of the base")


def _framed(base: Array, rates: Array | None, frame: str) -> dict[str, np.ndarray]:
    arrays = {"base": base} | ({"base_frame": np.array(frame)} if frame else {})
    return arrays if rates is None else arrays | {"base_velocities": rates}
