"""How far the tool is from its pose on the handle at the moment of a grasp."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from services.embodiment.certify.sweep.kinematics import Of, Placed
from services.embodiment.certify.sweep.pieces import Spans
from services.embodiment.certify.sweep.subject import Subject

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

DEEPEST = 12
"""[1] Halvings of a piece in a check of the tool."""


@dataclass(frozen=True, slots=True, eq=False)
class Attached:
    """A frame that is fixed to a carrier: carrier_T_frame, shape (4, 4)."""

    carrier: int
    placement: Array

    def world(self, placed: Placed) -> tuple[Array, Array]:
        """Rotations and origins in the world, shapes (U, 3, 3) and (U, 3)."""
        rotation, origin = placed.rotation[:, self.carrier], placed.origin[:, self.carrier]
        return rotation @ self.placement[:3, :3], origin + rotation @ self.placement[:3, 3]


class Slip:
    """The error of a tool on a handle along a motion.

    Args:
        checked: The motion.
        tool, handle: Their frames.
        begin: The piece whose start is the moment of the grasp.
    """

    def __init__(self, checked: Subject, tool: Attached, handle: Attached, begin: int) -> None:
        self._checked, self._tool, self._handle, self._begin = checked, tool, handle, begin
        self._pieces, self._kinematics = checked.timeline.pieces, checked.kinematics
        most = checked.tolerances.tool_position, 2 * np.sin(checked.tolerances.tool_angle / 2)
        self._most = np.array(most)[:, None]

    @cached_property
    def at_grasp(self) -> Placed:
        """The scene at the moment of the grasp."""
        q, v, _ = self._pieces.at(np.array([self._begin]), np.zeros(1))
        return self._kinematics.place(q, v)

    @cached_property
    def _grasp(self) -> tuple[Array, Array]:
        return self._relative(self.at_grasp)

    def _relative(self, placed: Placed) -> tuple[Array, Array]:
        """handle_T_tool: rotations (U, 3, 3) and origins (U, 3)."""
        tool_R, tool_p = self._tool.world(placed)
        handle_R, handle_p = self._handle.world(placed)
        back = np.swapaxes(handle_R, 1, 2)
        return back @ tool_R, (back @ (tool_p - handle_p)[:, :, None])[:, :, 0]

    def _errors(self, placed: Placed) -> Array:
        """How far the tool is from its grasp [m], and the norm of its rotation's change, shape (2, U)."""
        rotation, origin = self._relative(placed)
        rotation_0, origin_0 = self._grasp
        turned = np.linalg.norm(rotation - rotation_0, axis=(1, 2)) / np.sqrt(2)
        return np.stack((np.linalg.norm(origin - origin_0, axis=1), turned))

    def on(self, level: int, intervals: Indices) -> tuple[Spans, Array, Array]:
        """Intervals of a level of the timeline; errors in their middles, and at most, shape (2, U) each."""
        spans = self._checked.timeline.spans(level, intervals)
        placed = self._kinematics.place(spans.q, spans.v)
        error, (_, origin) = self._errors(placed), self._tool.world(placed)
        ball = Of(self._tool.carrier, self._handle.carrier, origin, 0.0)
        return spans, error, error + np.stack(self._kinematics.bounds(spans, placed, ball))

    def off(self, first: int, stop: int) -> Indices:
        """Which of these samples have the tool out of its grasp."""
        samples, end = np.arange(first, stop), len(self._pieces.start) - 1
        pieces = np.minimum(samples, end)
        q, v, _ = self._pieces.at(pieces, np.where(samples > end, self._pieces.duration[pieces], 0.0))
        return samples[(self._errors(self._kinematics.place(q, v)) > self._most).any(axis=0)]

    def leaving(self, first: int, stop: int) -> Indices:
        """On which of these pieces the tool is not shown to stay in its grasp, between samples too."""
        level, intervals = self._checked.timeline.depth, np.arange(first, stop)
        found = [intervals[:0]]
        for halving in range(DEEPEST + 1):
            if not len(intervals):
                break
            _, error, upper = self.on(level + halving, intervals)
            out = ((upper if halving == DEEPEST else error) > self._most).any(axis=0)
            found.append(intervals[out] >> halving)
            intervals = intervals[~out & (upper > self._most).any(axis=0)]
            intervals = np.concatenate((2 * intervals, 2 * intervals + 1))
        return np.unique(np.concatenate(found))
