"""Poses of a frame in the root of a tree of TF transforms, as they come in."""

from typing import Any  # messages are classes that rosbags makes from the bag's own definitions

import numpy as np
from scipy.spatial.transform import Rotation

from predicates.learn.track import Array
from sdt_kg.errors import MotionError


class Transforms:
    """The tree of frames: what stands still is known from the start, the rest as far as it was heard."""

    def __init__(self, still: list[Any]) -> None:
        self._tree: dict[str, tuple[str, Array, Rotation]] = {}
        for each in still:
            self._hang(each)
        self._still = set(self._tree)
        self._roots: dict[str, str] = {}

    def rows(self, transforms: list[Any], frame: str | None) -> dict[str, list[float]]:
        """Frame → t x y z qx qy qz qw in the root, for the frame that is meant, or for each that is told.

        A frame has a row when it is told anew where it is, or, standing still, what carries it: what carries
        it alone says nothing new of what moves on it.

        Raises:
            MotionError: A frame hangs from itself, has no rotation, or changes its root.
        """
        for each in transforms:
            self._hang(each)
        told = {each.child_frame_id: seconds(each.header) for each in transforms}
        rows = dict[str, list[float]]()
        for name in [frame] if frame else told:
            chain = self._ancestors(name)
            moving = next((each for each in chain if each not in self._still), None)
            if moving in told:
                self._check_root(name, self._tree[chain[-1]][0])
                rows[name] = [max(told[each] for each in chain if each in told), *self._pose(chain)]
        return rows

    def _hang(self, stamped: Any) -> None:  # noqa: ANN401 - see Any
        transform = stamped.transform
        row = row_of(transform.translation, transform.rotation)
        if float(np.linalg.norm(row[3:])) < 0.5:
            raise MotionError(f"frame {stamped.child_frame_id} has no rotation", allowed="a unit quaternion")
        parent = stamped.header.frame_id
        self._tree[stamped.child_frame_id] = (parent, np.array(row[:3]), Rotation.from_quat(row[3:]))

    def _ancestors(self, frame: str) -> list[str]:
        """The frame and those that it hangs from, so far as they are known."""
        chain: list[str] = []
        while frame in self._tree:
            if frame in chain:
                raise MotionError(f"frame {frame} hangs from itself", allowed="a tree of frames")
            chain.append(frame)
            frame = self._tree[frame][0]
        return chain

    def _check_root(self, frame: str, root: str) -> None:
        if self._roots.setdefault(frame, root) != root:
            raise MotionError(
                f"frame {frame} hangs from {self._roots[frame]} at first and from {root} later",
                allowed="one root for the whole track",
                remedy="record /tf_static too, or begin when all frames are told",
            )

    def _pose(self, chain: list[str]) -> list[float]:
        place, turn = np.zeros(3), Rotation.identity()
        for name in chain:
            _, position, rotation = self._tree[name]
            place, turn = position + rotation.apply(place), rotation * turn
        return [*place.tolist(), *turn.as_quat().tolist()]


def row_of(position: Any, orientation: Any) -> list[float]:  # noqa: ANN401 - see Any
    """Columns x y z qx qy qz qw."""
    return [position.x, position.y, position.z, orientation.x, orientation.y, orientation.z, orientation.w]


def seconds(header: Any) -> float:  # noqa: ANN401 - see Any
    """When a message was stamped [s]."""
    return header.stamp.sec + header.stamp.nanosec * 1e-9
