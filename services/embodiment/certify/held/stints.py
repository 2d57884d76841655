"""When a container moves and when it rests, along a motion.

It may be let go where it rests, and nowhere else. In between it moves; less than `MOVES` before it first
does, and after it last does, is rounding.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from services.embodiment.certify.sweep.pieces import Pieces

MOVES = 1e-6  # [rad or m] less is rounding
RESTS = 1e-9
"""[rad or m] What rests on the way moves by no more: less than any proof about an exact value leaves."""


def begin(pieces: Pieces, k: int) -> int | None:
    """First piece on which coordinate k moves, None if it never does."""
    moved = _away(pieces, k, float(pieces.c[0, 0, k]))
    return int(moved[0]) if len(moved) else None


def last(pieces: Pieces, k: int) -> int:
    """Last piece on which it moves; that of the motion if it hardly does."""
    moved = _away(pieces, k, float(pieces.end[k]))
    return int(moved[-1]) if len(moved) else len(pieces.start) - 1


def rests(pieces: Pieces, k: int, after: int) -> Iterator[slice]:
    """Pieces during which it rests, between a piece on which it moves and the last one, in order.

    What creeps does not rest: all of a run of pieces that are still is at one value, or moves.
    """
    end, at = last(pieces, k), pieces.of(k)
    for run in _runs(np.ptp(at[:, :end], axis=0) <= RESTS, after + 1):
        value = np.median(at[0, run])
        for part in _runs(np.abs(at[:, run] - value).max(axis=0) <= RESTS, 0):
            yield slice(run.start + part.start, run.start + part.stop)


def _runs(mask: NDArray[np.bool_], first: int) -> Iterator[slice]:
    """Maximal runs of what holds, from `first` on."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], mask[first:], [False])).astype(np.int8)))
    for start, stop in (first + edges).reshape(-1, 2).tolist():
        yield slice(start, stop)


def _away(pieces: Pieces, k: int, value: float) -> NDArray[np.intp]:
    """Pieces on which a coordinate is not all the time at a value."""
    return np.flatnonzero(np.abs(pieces.of(k) - value).max(axis=0) > MOVES)
