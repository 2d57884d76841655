"""A mechanism as frames that move, so that a picture follows its joints: forward kinematics on values."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import RobotAnnotation
from sdt_kg.mechanism import Joint, JointType, Mechanism

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """What one movable joint carries.

    Attributes:
        joint: It moves this frame.
        parent: Index of the frame that carries the joint.
        parent_T_joint: Where it is at position 0, shape (4, 4).
    """

    joint: Joint
    parent: int
    parent_T_joint: Array


@dataclass(frozen=True, slots=True, eq=False)
class Skeleton:
    """Frames of a mechanism, parents before children; frame 0 is the root and has no joint.

    Attributes:
        mechanism: Whose.
        frames: Those of the movable joints, frame k + 1 at index k.
        carried: Name of each body → index of its frame, and frame_T_body, shape (4, 4).
    """

    mechanism: Mechanism
    frames: tuple[Frame, ...]
    carried: dict[str, tuple[int, Array]]

    @staticmethod
    def of(mechanism: Mechanism) -> "Skeleton":
        """The frames of a mechanism's movable joints."""
        frames: list[Frame] = []
        carried = {mechanism.root: (0, np.eye(4))}
        for joint in mechanism.joints:
            index, frame_T_parent = carried[joint.parent]
            frame_T_joint = frame_T_parent @ joint.origin.matrix()
            if joint.type is JointType.FIXED:
                carried[joint.child] = (index, frame_T_joint)
            else:
                frames.append(Frame(joint, index, frame_T_joint))
                carried[joint.child] = (len(frames), np.eye(4))
        return Skeleton(mechanism, tuple(frames), carried)

    def complete(self, positions: Mapping[str, float]) -> dict[str, float]:
        """Position of every movable joint by name [rad or m]; mimicking ones follow.

        A mimicking joint that is listed while the one that it mimics is not moves that one.
        """
        joints = {frame.joint.name: frame.joint for frame in self.frames}
        whole = {name: positions.get(name, resting(joint)) for name, joint in joints.items()}
        for name in positions.keys() & joints.keys():
            mimic = joints[name].mimic
            if mimic is not None and mimic.joint not in positions and mimic.multiplier:
                whole[mimic.joint] = (positions[name] - mimic.offset) / mimic.multiplier
        for name, joint in joints.items():
            if joint.mimic is not None:
                whole[name] = joint.mimic.multiplier * whole[joint.mimic.joint] + joint.mimic.offset
        return whole

    def local(self, positions: Mapping[str, float]) -> list[Array]:
        """parent_T_frame of every frame but the root, in order, each of shape (4, 4)."""
        whole = self.complete(positions)
        return [frame.parent_T_joint @ _moved(frame.joint, whole[frame.joint.name]) for frame in self.frames]

    def placed(self, positions: Mapping[str, float], world_T_root: Array) -> list[Array]:
        """world_T_frame of every frame, the root's first, each of shape (4, 4)."""
        world = [world_T_root]
        for frame, parent_T_frame in zip(self.frames, self.local(positions), strict=True):
            world.append(world[frame.parent] @ parent_T_frame)
        return world

    def body(self, name: str, positions: Mapping[str, float], world_T_root: Array) -> Array:
        """world_T_body, shape (4, 4)."""
        index, frame_T_body = self.carried[name]
        return self.placed(positions, world_T_root)[index] @ frame_T_body


def resting(joint: Joint) -> float:
    """Position of a joint of which nothing is said: 0, or the limit nearest to it [rad or m]."""
    return float(np.clip(0.0, joint.limits.lower, joint.limits.upper))


def base_pose(skeleton: Skeleton, annotation: RobotAnnotation, base: tuple[float, float, float]) -> Array:
    """world_T_root of a robot whose base stands at x, y [m], yaw [rad], shape (4, 4)."""
    x, y, yaw = base
    world_T_base = np.eye(4)
    c, s = math.cos(yaw), math.sin(yaw)
    world_T_base[:3] = ((c, -s, 0, x), (s, c, 0, y), (0, 0, 1, annotation.base_height))
    index, root_T_base = skeleton.carried[annotation.base_body]
    assert index == 0, "the twin refuses a base body that moves against the root"
    return world_T_base @ np.linalg.inv(root_T_base)


def _moved(joint: Joint, position: float) -> Array:
    joint_T_frame = np.eye(4)
    axis = np.array(joint.axis)
    if joint.type is JointType.PRISMATIC:
        joint_T_frame[:3, 3] = position * axis
        return joint_T_frame
    x, y, z = axis
    cross = np.array(((0, -z, y), (z, 0, -x), (-y, x, 0)))
    joint_T_frame[:3, :3] += math.sin(position) * cross + (1 - math.cos(position)) * cross @ cross
    return joint_T_frame
