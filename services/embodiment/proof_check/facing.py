r"""How a hand has to be turned: where its axes point, as intervals along directions of the world.

With joint j of a chain moved by at most :math:`h_j` from the middle of a box of positions, the product of a
unit vector u of the last frame and a fixed direction d changes by at most the sum over the hinges of

.. math:: h_j \min(|a_j \times u|,\; |d \cdot (a_j \times u)| + |a_j \times u| (h_j / 2 + \sum_{i < j} h_i))

(`Swing.turned`). Where that leaves it outside of the interval, no posture in the box has the hand turned so.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import InputError
from services.embodiment.proof_check.arm import Arm
from services.embodiment.proof_check.geometry.interval import exact
from services.embodiment.proof_check.geometry.mechanics import Swing

Array = NDArray[np.float64]

WAYS = 9
"""Products: row i, column j of `Facing` have the number 3 i + j."""
ROUNDING = 1e-9  # [1] more than such a product is off by


@dataclass(frozen=True, slots=True, eq=False)
class Facing:
    """Between which ends products of axes of the tool and directions of the world are.

    Attributes:
        ways: Directions of the world, no longer than 1, one in each row, shape (3, 3).
        low, high: Of direction i and axis j of the tool, shape (3, 3).
    """

    ways: Array
    low: Array
    high: Array


def all_turned(arm: Arm, facing: Facing, block: list[tuple[Array, Array, int]]) -> None:
    """In each box the named axis of the tool points elsewhere.

    Raises:
        InputError: It need not, as far as was shown.
    """
    low, high = (np.array([one[k] for one in block]) for k in (0, 1))
    rows, columns = np.divmod([one[2] for one in block], 3)
    middle = (low + high) / 2
    half = np.maximum(high - middle, middle - low) * (1 + 1e-12)
    origins, axes, tool = arm.chain.frames(middle)
    swing = Swing(origins, axes, half, np.array([link.turns for link in arm.chain.links]))
    d, u = facing.ways[rows], tool.rotation.T[np.arange(len(rows)), columns]
    at, moved = (exact(d) * u).total(), swing.turned(d, u) + ROUNDING
    beyond = np.maximum(at.lo - moved - facing.high[rows, columns], facing.low[rows, columns] - at.hi - moved)
    if not (beyond > 0).all():
        raise InputError(
            f"the hand can be turned as a grasp asks: to within {-beyond.min():.4f}, as far as was shown",
            allowed="a hand that is turned otherwise",
        )
