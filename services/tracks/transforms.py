"""Poses of a frame in the root of a tree of TF transforms, each at its own time."""

from bisect import bisect
from collections import defaultdict
from typing import Any  # messages are classes that rosbags makes from the bag's own definitions

import numpy as np
from scipy.spatial.transform import Rotation

from predicates.learn.track import Array
from sdt_kg.errors import MotionError


class Transforms:
    """The tree of frames: what stands still is known from the start, what hangs where as far as it was heard.

    A frame that moves is told at times of its own; between two of them it is interpolated, as TF does.
    """

    def __init__(self, still: list[Any], moving: list[Any]) -> None:
        self._tree: dict[str, tuple[str, Array, Rotation]] = {}
        for each in still:
            self._hang(each)
        self._still = set(self._tree)
        #: Frame → the root in which its rows are.
        self.roots: dict[str, str] = {}
        self._told = defaultdict[tuple[str, str], list[tuple[float, Array, Rotation]]](list)
        for each in sorted(moving, key=lambda one: seconds(one.header)):
            told = self._told[each.child_frame_id, each.header.frame_id]
            told.append((seconds(each.header), *_placed(each)))

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
            if moving is not None and moving in told:
                self._check_root(name, self._tree[chain[-1]][0])
                rows[name] = [told[moving], *self._pose(chain, moving, told[moving])]
        return rows

    def _hang(self, stamped: Any) -> None:  # noqa: ANN401 - see Any
        self._tree[stamped.child_frame_id] = (stamped.header.frame_id, *_placed(stamped))

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
        if self.roots.setdefault(frame, root) != root:
            raise MotionError(
                f"frame {frame} hangs from {self.roots[frame]} at first and from {root} later",
                allowed="one root for the whole track",
                remedy="record /tf_static too, or begin when all frames are told",
            )

    def _pose(self, chain: list[str], seen: str, time: float) -> list[float]:
        place, turn = np.zeros(3), Rotation.identity()
        for name in chain:
            _, position, rotation = self._tree[name]
            if name != seen and name not in self._still:
                position, rotation = self._at(name, time)
            place, turn = position + rotation.apply(place), rotation * turn
        return [*place.tolist(), *turn.as_quat().tolist()]

    def _at(self, name: str, time: float) -> tuple[Array, Rotation]:
        """Where a frame is in its parent; no number before it was told first and after it was told last.

        What is told once stands still.
        """
        told = self._told[name, self._tree[name][0]]
        after = min(bisect(told, time, key=lambda one: one[0]), len(told) - 1)
        (begin, place, turn), (end, place_1, turn_1) = told[max(after - 1, 0)], told[after]
        if end <= begin:
            return place, turn
        if not begin <= time <= end:
            return np.full(3, np.nan), turn
        share = (time - begin) / (end - begin)
        between = Rotation.from_rotvec(share * (turn.inv() * turn_1).as_rotvec())
        return place + share * (place_1 - place), turn * between


def _placed(stamped: Any) -> tuple[Array, Rotation]:  # noqa: ANN401 - see Any
    """Place and turn of a transform.

    Raises:
        MotionError: It has no rotation.
    """
    row = row_of(stamped.transform.translation, stamped.transform.rotation)
    if float(np.linalg.norm(row[3:])) < 0.5:
        raise MotionError(f"frame {stamped.child_frame_id} has no rotation", allowed="a unit quaternion")
    return np.array(row[:3]), Rotation.from_quat(row[3:])


def row_of(position: Any, orientation: Any) -> list[float]:  # noqa: ANN401 - see Any
    """Columns x y z qx qy qz qw."""
    return [position.x, position.y, position.z, orientation.x, orientation.y, orientation.z, orientation.w]


def seconds(header: Any) -> float:  # noqa: ANN401 - see Any
    """When a message was stamped [s]."""
    return header.stamp.sec + header.stamp.nanosec * 1e-9
