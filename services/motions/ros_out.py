"""Body motions as ROS 2 bags (MCAP), for those who drive a robot by them.

Each sample is a point with positions and velocities: a controller that puts cubic splines through these
moves the joints as was certified.
"""

import math
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from sdt_kg.motion import Array
from services.bags import no_library
from services.motions.ros import JOINTS, POSES
from services.store.output import write_file

FRAME = "world"
"""Of the base: the kitchen's root frame."""
BASE_JOINT = "world_T_base"
TOPICS = {"robot": "/joint_trajectory", "base": "/base_trajectory", "kitchen": "/kitchen/joint_trajectory"}
FORMAT = 9
"""[1] Version of the bag."""
NANOSECONDS = 1_000_000_000


def check_library() -> None:
    """Bags can be written.

    Raises:
        InputError: The library for that is not installed.
    """
    if find_spec("rosbags") is None:
        raise no_library()


def write_bag(path: Path, arrays: Mapping[str, np.ndarray]) -> None:
    """The motion is in the file, from time 0 on, its times to the nanosecond.

    What ROS has no message for is left out: which gripper acts, and names of phases.

    Args:
        path: Of the file.
        arrays: Of a certified body motion, velocities too; README.md has the schema.

    Raises:
        InputError: The library for bags is not installed.
    """
    check_library()
    from rosbags.rosbag2 import StoragePlugin, Writer  # noqa: PLC0415 - an extra
    from rosbags.typesys import Stores, get_typestore  # noqa: PLC0415 - an extra

    store = get_typestore(Stores.ROS2_HUMBLE)
    make = _Messages(store.types, arrays["times"])
    messages = {"robot": make.joints("robot", arrays), "base": make.base(arrays)}
    if "kitchen_joint_names" in arrays:
        messages["kitchen"] = make.joints("kitchen", arrays)
    with TemporaryDirectory() as folder:
        bag = Path(folder) / "motion"
        with Writer(bag, version=FORMAT, storage_plugin=StoragePlugin.MCAP) as out:
            for whose, message in messages.items():
                kind = message.__msgtype__
                connection = out.add_connection(TOPICS[whose], kind, typestore=store)
                out.write(connection, 0, store.serialize_cdr(message, kind))
        (made,) = bag.glob("*.mcap")
        write_file(path, made.read_bytes())


class _Messages:
    """Trajectories of one motion, at its times from start.

    Args:
        types: Of ROS 2, by name.
        times: Shape (T,) [s].
    """

    def __init__(self, types: Any, times: Array) -> None:  # noqa: ANN401 - made by the library at run time
        self._types, self._times = types, np.round((times - times[0]) * NANOSECONDS).astype(np.int64)

    def joints(self, whose: str, arrays: Mapping[str, np.ndarray]) -> Any:  # noqa: ANN401 - as above
        """A trajectory of joints, with positions and velocities at each point."""
        names = arrays[f"{whose}_joint_names"].tolist()
        q, v = (arrays[f"{whose}_{what}"] for what in ("positions", "velocities"))
        point, none = self._types["trajectory_msgs/msg/JointTrajectoryPoint"], np.empty(0)
        rows = map(np.ascontiguousarray, q), map(np.ascontiguousarray, v)  # the library takes their bytes
        points = [
            point(positions=at, velocities=rates, accelerations=none, effort=none, time_from_start=since)
            for at, rates, since in zip(*rows, self._since(), strict=True)
        ]
        return self._types[JOINTS](header=self._header(""), joint_names=names, points=points)

    def base(self, arrays: Mapping[str, np.ndarray]) -> Any:  # noqa: ANN401 - as above
        """The trajectory of world_T_base, and of the velocity of its origin."""
        point = self._types["trajectory_msgs/msg/MultiDOFJointTrajectoryPoint"]
        points = [
            point(
                transforms=[self._transform(*at)],
                velocities=[self._twist(*rates)],
                accelerations=[],
                time_from_start=since,
            )
            for at, rates, since in zip(
                arrays["base"].tolist(), arrays["base_velocities"].tolist(), self._since(), strict=True
            )
        ]
        return self._types[POSES](header=self._header(FRAME), joint_names=[BASE_JOINT], points=points)

    def _since(self) -> list[Any]:
        duration = self._types["builtin_interfaces/msg/Duration"]
        return [duration(*divmod(each, NANOSECONDS)) for each in self._times.tolist()]

    def _header(self, frame: str) -> Any:  # noqa: ANN401 - as above
        time = self._types["builtin_interfaces/msg/Time"](sec=0, nanosec=0)
        return self._types["std_msgs/msg/Header"](stamp=time, frame_id=frame)

    def _vector(self, x: float, y: float, z: float) -> Any:  # noqa: ANN401 - as above
        return self._types["geometry_msgs/msg/Vector3"](x=x, y=y, z=z)

    def _transform(self, x: float, y: float, yaw: float) -> Any:  # noqa: ANN401 - as above
        z, w = math.sin(yaw / 2), math.cos(yaw / 2)
        turn = self._types["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=z, w=w)
        return self._types["geometry_msgs/msg/Transform"](translation=self._vector(x, y, 0.0), rotation=turn)

    def _twist(self, x: float, y: float, turn: float) -> Any:  # noqa: ANN401 - as above
        linear, angular = self._vector(x, y, 0.0), self._vector(0.0, 0.0, turn)
        return self._types["geometry_msgs/msg/Twist"](linear=linear, angular=angular)
