"""A track as few weighted points: standstill and slow samples count once, not a hundred times."""

import math
from dataclasses import dataclass

import numpy as np

from predicates.learn.fitting.shifts import is_blind, shifts
from predicates.learn.track import Array

CELL = 0.005
"""[m] Samples nearer to each other than this see the same deviation from the path: they count as one."""

CELLS = 150
"""[1] A track is divided into no more than about so many cells along its extent."""

CORRELATION = 0.04
"""[m] Over this length deviations keep their sign (play, a hand that slips), so that it counts as one
observation: median integrated autocorrelation of the reference tracks' residuals, quartiles 28 and 57 mm."""

CORRELATED = 0.004
"""[m] Deviation that keeps its sign so long, of a handle and its tracker. With half of it, noise of the
reference's tracks counts as independent, and their second half is predicted 0.3 mm worse."""

LEVER = 0.3
"""[m] Turns an observed angle into a length: a body that turns in place moves too."""

NOISE_SPAN = 9.0
"""[1] Diagonal of the box that some hundred samples of noise fill, in standard deviations."""

NOISE_MOST = 0.01
"""[m] No tracker of handles is noisier; what differs more from sample to sample are outliers, or motion."""

LEAST_TRAVEL = 1e-4
"""[m] What is left where noise explains all of a track's extent."""

CALM = 0.15
"""[1] Share of second differences that tell the noise: of those without outliers half, if a third are."""

CALM_OF_NORMAL, SECOND_DIFFERENCE = 0.1891, 6**0.5
"""[1] That quantile of |z| for a standard normal z; standard deviation of z0 - 2 z1 + z2."""

WINDOW = 11
"""[1] Samples among which a lone spike is told from motion."""

NOISE_OF_MEDIAN = math.sqrt(math.pi / 2)
"""[1] Standard deviation of the median of many samples, over that of their mean."""

PASSES = 3
"""[1] How often spikes are looked for among what is left."""

SPIKE = 4.0
"""[1] Median distances from the window's middle beyond which a sample is a spike."""

SPIKE_LEAST = 0.02
"""[m] A nearer sample is no spike."""


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """Weighted points in the order of their first sample.

    Attributes:
        points: Shape (N, 3), mean position of each cell's samples [m].
        weights: Shape (N,): independent observations that each is worth.
        members: Shape (T,): cell of each sample; -1 for spikes, which belong to none.
        extent: Diagonal of the box that holds the positions [m].
        travel: The same, turning included, less what noise alone would spread over [m].
        noise: Standard deviation of a coordinate from one sample to the next [m].
        may_shift: Whether the samples shift in time by more than noise explains, or noise would hide it.
    """

    points: Array
    weights: Array
    members: np.ndarray
    extent: float
    travel: float
    noise: float
    may_shift: bool

    @property
    def observations(self) -> float:
        """Independent observations in all."""
        return float(self.weights.sum())

    def shares(self) -> Array:
        """Independent observations that each sample is worth, shape (T,)."""
        counts = np.bincount(self.members[self.members >= 0])
        return np.where(self.members >= 0, (self.weights / counts)[self.members], 0.0)


def cells_of(positions: Array, turns: Array | None = None) -> Cells:
    """Cells of a track.

    Args:
        positions: Shape (T, 3) [m].
        turns: Rotation vectors, shape (T, 3) [rad], where orientations were observed.
    """
    kept = ~spikes(positions)
    seen = positions[kept]
    both = seen if turns is None else np.hstack([seen, LEVER * turns[kept]])
    low, high = both.min(axis=0), both.max(axis=0)
    extent, travel = float(np.linalg.norm((high - low)[:3])), float(np.linalg.norm(high - low))
    size = max(CELL, travel / CELLS)
    key = np.floor((both - low) / size).astype(np.int64)
    _, first, inverse = np.unique(key, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    cell = rank[inverse.ravel()]
    counts = np.bincount(cell)
    points = np.stack([np.bincount(cell, column) / counts for column in seen.T], axis=1)
    members = np.full(len(positions), -1)
    members[kept] = cell
    noise = min(_white_noise(seen), NOISE_MOST)
    moved = max(travel - NOISE_SPAN * noise, _calm_travel(both, noise), LEAST_TRAVEL)
    worth = np.full(len(points), _worth(size, noise))
    may_shift = shifts(both) or is_blind(seen)
    return Cells(points, worth, members, extent, moved, noise, may_shift)


def _worth(size: float, noise: float) -> float:
    """Independent observations that a cell of such a size [m] is worth.

    Of what a sample deviates by, the handle's share is alike over a correlation length, the noise's is not.
    """
    alike = CORRELATED**2 / (CORRELATED**2 + noise**2)
    return 1 / (1 + max(0.0, CORRELATION / size - 1) * alike)


def _calm_travel(both: Array, noise: float) -> float:
    """Travel of the running median, less what noise alone would spread it over [m]."""
    if len(both) < 2 * WINDOW:
        return 0.0
    middle = np.median(np.lib.stride_tricks.sliding_window_view(both, WINDOW, axis=0), axis=2)
    travel = float(np.linalg.norm(middle.max(axis=0) - middle.min(axis=0)))
    return travel - NOISE_SPAN * noise * NOISE_OF_MEDIAN / math.sqrt(WINDOW)


def _white_noise(positions: Array) -> float:
    """Standard deviation of a coordinate's noise, from second differences [m]; 0 of very few samples.

    Differences of 0 are of a source that says one sample twice, or rounds.
    """
    second = np.abs(np.diff(positions, 2, axis=0))
    second = second[second > 0]
    if len(second) < WINDOW:
        return 0.0
    return float(np.quantile(second, CALM)) / (CALM_OF_NORMAL * SECOND_DIFFERENCE)


def spikes(positions: Array) -> np.ndarray:
    """Which samples lie far from those just before and after them, shape (T,).

    Several in one window hide each other: the rest is looked at again.
    """
    found = np.zeros(len(positions), dtype=bool)
    for _ in range(PASSES):
        left = np.flatnonzero(~found)
        found[left] = _lone(positions[left])
    return found


def _lone(positions: Array) -> np.ndarray:
    if len(positions) < WINDOW:
        return np.zeros(len(positions), dtype=bool)
    windows = np.lib.stride_tricks.sliding_window_view(positions, WINDOW, axis=0)
    middle = np.median(windows, axis=2)
    usual = np.median(np.linalg.norm(windows - middle[:, :, None], axis=1), axis=1)
    # at both ends the first and the last whole window tell: an end repeated would be its own middle
    nearest = np.clip(np.arange(len(positions)) - WINDOW // 2, 0, len(windows) - 1)
    away = np.linalg.norm(positions - middle[nearest], axis=1)
    return away > np.maximum(SPIKE * usual[nearest], SPIKE_LEAST)
