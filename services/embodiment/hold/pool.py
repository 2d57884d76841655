"""From what grasps are drawn to be bred, and how many."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.embodiment.hold.handle import Bar
from services.embodiment.hold.sets import ANY_MOST, FREE_MOST

Array = NDArray[np.float64]

GRASPS = 96  # that are bred
BLOCKS = 20  # of grasps that are drawn together, at most, until so many fit
EMPTY_BLOCKS = 4  # at most, of which none fits
LITTERS = 3  # that are bred, one after the other
FIRST_BRED = 20_000  # number of the first grasp
FIRST_ANY = 1_000_000  # the same, where any part is held anyhow


@dataclass(frozen=True, slots=True, eq=False)
class Pool:
    """What grasps are drawn from.

    Attributes:
        bars: Parts of the handle that may be held.
        most: How far a grasp of one is turned and moved at most, see `free_grasps`.
        grasps: So many are bred.
        blocks: Drawn for that, at most.
        empty: The same, while none fits.
        fresh: Of these blocks, those of random ones; later ones are like those that were found to fit.
        litters: Bred one after the other.
        first: Number of the first grasp.
    """

    bars: tuple[Bar, ...]
    most: Array
    grasps: int
    blocks: int
    empty: int
    fresh: int
    litters: int
    first: int


def straight(bar: Bar) -> Pool:
    """A bar, held across it or nearly so."""
    return Pool((bar,), FREE_MOST, GRASPS, BLOCKS, EMPTY_BLOCKS, BLOCKS, LITTERS, FIRST_BRED)


def anyhow(bars: tuple[Bar, ...], room: bool = True, more: int = 1) -> Pool:
    """Any of these bars, held anyhow: of such random grasps fewer fit, and more are needed.

    Args:
        bars: Parts of a handle.
        room: Whether a hand is known to find room at the handle: else few are drawn until one fits.
        more: Times as many litters.
    """
    blocks, fresh = 8 * BLOCKS, 4 * BLOCKS
    empty = blocks if room else EMPTY_BLOCKS
    return Pool(bars, ANY_MOST, 2 * GRASPS, blocks, empty, fresh, more * LITTERS, FIRST_ANY)
