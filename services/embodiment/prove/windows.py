"""Where a timed motion of a container is fastest: two samples between which no gripper may follow."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Drive
from services.embodiment.proof_check.haste import fastest, rests, travelled
from services.embodiment.proof_check.statement import Statement

Array = NDArray[np.float64]

SAMPLES = 33  # of the motion that are compared, each with each
SURPLUS = 1e-4  # [m] by which a way must be too long, so that the check finds so too


@dataclass(frozen=True, slots=True)
class Window:
    """Two samples of a motion.

    Attributes:
        ends: Their indices.
        asked: Mean speed of the handle between them [m/s].
        most: That the fastest gripper can have [m/s].
    """

    ends: tuple[int, int]
    asked: float
    most: float


def window(statement: Statement, drive: Drive, times: Array, values: Array) -> Window | None:
    """The window in which the handle goes farthest beyond what a gripper can; None if it never does."""
    most = max((fastest(statement, drive, gripper) for gripper in statement.grippers), default=np.inf)
    if not np.isfinite(most) or len(times) < 2:
        return None
    chosen = np.unique(np.linspace(0, len(times) - 1, SAMPLES).round().astype(int))
    targets = [statement.target(float(values[k])) for k in chosen]
    if not targets[0].boxes:
        return None
    places = np.array([one.boxes[0].translation.middle for one in targets])
    ways = np.linalg.norm(places[:, None] - places[None], axis=2)
    beyond = ways - most * (times[chosen][None] - times[chosen][:, None])
    rested = np.concatenate(([0], np.cumsum(rests(values))))[chosen]
    none = np.tri(len(chosen), k=0).astype(bool) | (rested[None] != rested[:, None])
    first, last = np.unravel_index(np.argmax(np.where(none, -np.inf, beyond)), ways.shape)
    if first >= last:
        return None
    ends = int(chosen[first]), int(chosen[last])
    way, slips = travelled(statement, float(values[ends[0]]), float(values[ends[1]]))
    time = float(times[ends[1]] - times[ends[0]])
    if way - max(slips.values()) <= most * time + SURPLUS:
        return None
    return Window(ends, way / time, most)
