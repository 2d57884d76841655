"""Trees of boxes in each of which no two fingers come as high, or as low, as the handle.

Nodes are those of `tree.py`; a leaf names the one finger that may come there. All others stay above or below
the whole handle, by more than certification lets them be away from it. Or, by the number of fingers, it says
that their joints, which one motor drives, differ by more than certification allows.
"""

from collections.abc import Iterator
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import InputError
from services.embodiment.proof_check.pinch.fingers import Hand, Part, spans
from services.embodiment.proof_check.tree import leaves_of

Array = NDArray[np.float64]

BLOCK = 1024  # leaves that are checked at once


def refuted_pinches(
    hand: Hand, handle: tuple[float, float], near: float, nodes: Iterator[int], box: tuple[Array, Array]
) -> int:
    """Number of leaves of one tree, in each of which at most one finger comes to the handle.

    Args:
        hand: Whose fingers they are.
        handle: Heights of its lowest and its highest point [m].
        near: How far from it fingers that hold it may be [m].
        nodes: Of the tree; those beyond its end are left.
        box: Lower and upper ends of the hand's variables, shape (m,).

    Raises:
        InputError: Two may, or the tree does not cover the box.
    """
    leaves, count = leaves_of(nodes, *box, len(hand.fingers) + 1), 0
    while block := list(islice(leaves, BLOCK)):
        count += len(block)
        low, high = (np.array([one[k] for one in block]) for k in (0, 1))
        named = np.array([one[2] for one in block])
        uneven = named == len(hand.fingers)
        if not (hand.differ(low[uneven], high[uneven]) > 0).all():
            raise InputError(
                "the fingers can be as near to each other", allowed="more than their motor allows"
            )
        low, high, named = low[~uneven], high[~uneven], named[~uneven]
        middle = (low + high) / 2
        half = np.maximum(high - middle, middle - low) * (1 + 1e-12)
        for k, finger in enumerate(hand.fingers):
            of = named != k
            for part in finger if of.any() else ():
                _apart(part, hand.upright, handle, near, (middle[of], half[of]))
    return count


def _apart(
    part: Part, upright: int, handle: tuple[float, float], near: float, boxes: tuple[Array, Array]
) -> None:
    """In each box this part of a finger is above or below the whole handle.

    Raises:
        InputError: It is not, as far as was shown.
    """
    lowest, highest = handle[0] - near, handle[1] + near
    for low, high in spans(part, upright, *boxes):
        if not ((high < lowest) | (low > highest)).all():
            most = float(np.maximum(lowest - high, low - highest).min())
            raise InputError(
                f"{part.name} can come to the handle beside another: {most:.4f} m apart, as was shown",
                allowed="a gap in height",
            )
