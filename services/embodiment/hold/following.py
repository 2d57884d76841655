"""How a limb may move while its hand holds: as its drive does, but straight on if that is differential.

A differential base is led along its heading only. Seen from where it stands, that is its first variable; so
postures are solved each in the frame of its own base, with the others at rest.
"""

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Drive
from services.embodiment.body import ik
from services.embodiment.body.limb import BASE
from services.embodiment.body.track import EXACT
from services.embodiment.hold.holding import STEPS, Searcher

Array = NDArray[np.float64]

SIDEWAYS = slice(1, 3)  # variables of the base but the way along its heading, in its own frame


class Following:
    """Moves of one limb that its drive allows while the handle is held."""

    def __init__(self, searcher: Searcher) -> None:
        self._searcher, self._straight = searcher, searcher.drive is Drive.DIFFERENTIAL
        self._weight = searcher.weight.copy()
        if self._straight:
            self._weight[SIDEWAYS] = 0.0

    def met(self, xs: Array, target_r: Array, target_p: Array) -> NDArray[np.bool_]:
        """Which of xs (N, n) were moved to where the tool is at its target (N, 3, 3), (N, 3)."""
        if not self._straight:
            return self._solved(xs, target_r, target_p)
        bases, turns = xs[:, BASE].copy(), _turns(xs[:, 2])
        xs[:, BASE] = 0.0
        back = turns.transpose(0, 2, 1)
        away = target_p - bases * (1.0, 1.0, 0.0)
        met = self._solved(xs, back @ target_r, (back @ away[:, :, None])[:, :, 0])
        xs[:, BASE] = bases + xs[:, :1] * turns[:, :, 0]
        return met

    def beside(self, xs: Array, change: Array) -> Array:
        """The postures xs (N, n), changed by so much of what may move, within limits."""
        change = np.where(self._weight == 0.0, 0.0, change)
        if self._straight:
            change[:, BASE] = change[:, :1] * _turns(xs[:, 2])[:, :, 0]
        return np.clip(xs + change, self._searcher.lower, self._searcher.upper)

    def _solved(self, xs: Array, target_r: Array, target_p: Array) -> NDArray[np.bool_]:
        one = self._searcher
        limits = one.lower, one.upper
        return ik.solve_many(xs, target_r, target_p, one.limb.chain, self._weight, *limits, STEPS, EXACT)


def _turns(yaws: Array) -> Array:
    """Turns about the vertical, shape (N, 3, 3)."""
    turns = np.zeros((len(yaws), 3, 3))
    turns[:, 0, 0] = turns[:, 1, 1] = np.cos(yaws)
    turns[:, 1, 0] = np.sin(yaws)
    turns[:, 0, 1] = -turns[:, 1, 0]
    turns[:, 2, 2] = 1.0
    return turns
