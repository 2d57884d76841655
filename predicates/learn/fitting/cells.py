"""A track as few weighted points: standstill and slow samples count once, not a hundred times."""

from dataclasses import dataclass

import numpy as np

from predicates.learn.track import Array

CELL = 0.005
"""[m] Samples nearer to each other than this see the same deviation from the path: they count as one."""

CELLS = 150
"""[1] A track is divided into no more than about so many cells along its extent."""

CORRELATION = 0.04
"""[m] Over this length deviations keep their sign (play, a hand that slips), so that it counts as one
observation: median integrated autocorrelation of the reference tracks' residuals, quartiles 28 and 57 mm."""

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
    """

    points: Array
    weights: Array
    members: np.ndarray
    extent: float
    travel: float
    noise: float

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
    moved = max(travel - NOISE_SPAN * noise, LEAST_TRAVEL)
    return Cells(points, np.full(len(points), min(1.0, size / CORRELATION)), members, extent, moved, noise)


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
    """Which samples lie far from those just before and after them, shape (T,)."""
    if len(positions) < WINDOW:
        return np.zeros(len(positions), dtype=bool)
    half = WINDOW // 2
    padded = np.pad(positions, ((half, half), (0, 0)), mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, WINDOW, axis=0)
    middle = np.median(windows, axis=2)
    usual = np.median(np.linalg.norm(windows - middle[:, :, None], axis=1), axis=1)
    away = np.linalg.norm(positions - middle, axis=1)
    return away > np.maximum(SPIKE * usual, SPIKE_LEAST)
