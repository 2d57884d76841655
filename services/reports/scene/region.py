"""The region of a proof as lines: no gripper holds the handle in these boxes."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from predicates.case import Verdict
from sdt_kg.twin import Twin
from services.reports.scene.clip import Line
from services.viewer.judging.measure import region

ROUND = (0, 1, 3, 2, 0, 4, 5, 1, 5, 7, 3, 7, 6, 2, 6, 4)
"""Corners of a box, numbered by the bits of their signs, in an order that draws all its edges."""


def excluded(twin: Twin, verdict: Verdict) -> Iterator[Line]:
    """The edges of each box of a proof; none for a verdict that rests on none.

    Args:
        twin: Kitchen and robot that the verdict is about.
        verdict: Of the whole Law.
    """
    performed = verdict.can_perform
    mark = None if performed is None else region(twin, performed.artefact)
    if mark is None:
        return
    for box in mark.boxes:
        sides = np.array(box.sides) / 2
        yield Line(
            _edges(sides) @ Rotation.from_quat(box.orientation).as_matrix().T + box.middle, mark.text, "gap"
        )


def _edges(half: NDArray[np.float64]) -> NDArray[np.float64]:
    """A way along all edges of a box about the origin, shape (16, 3) [m]."""
    corners = np.array([[1 if k >> axis & 1 else -1 for axis in range(3)] for k in ROUND])
    return corners * half
