"""Whether a track shifts in the course of time, by more than noise of single samples explains, or may."""

import math

import numpy as np

from predicates.learn.track import Array

BLOCKS = 10
"""[1] Parts of a track, one after the other, whose medians tell how far it shifts."""

LEAST_SHIFT = 0.0012
"""[m] By less a tracker may drift, or a handle give way."""

WAVES = (2, 4, 8, 16)
"""[1] Half waves of cosines that may describe the shift: there; there and back; several times."""

SAMPLES_PER_WAVE = 3
"""[1] With fewer samples half waves describe noise, too."""

CHANCE = 1e-3
"""[1] Probability at which noise that forgets itself from sample to sample is taken for a shift."""


MAD = 1.4826
"""[1] Standard deviation of a normal distribution, over its median absolute deviation."""

SHOWN = 6.5
"""[1] Standard deviations of a slope's way at which a steady shift is found 19 times of 20."""

LEAST_MOTION = 0.02
"""[m] A track stands still for sure only if it would have shown a steady shift of so much."""


def is_blind(positions: Array) -> bool:
    """Whether scatter hides so small a motion in so few samples that standstill cannot be told from it."""
    scatter = MAD * float(np.median(np.abs(positions - np.median(positions, axis=0))))
    return SHOWN * scatter * math.sqrt(12 / len(positions)) > LEAST_MOTION


def shifts(positions: Array) -> bool:
    """Whether the order of the samples shows: by rank, so that outliers count no more than others.

    Args:
        positions: Shape (T, D) [m], in the order of time.
    """
    parts = np.array_split(positions, min(BLOCKS, len(positions)))
    middles: Array = np.stack([np.median(part, axis=0) for part in parts])
    if float(np.linalg.norm(np.ptp(middles, axis=0))) < LEAST_SHIFT:
        return False
    ranks = np.stack([_ranks(column) for column in positions.T if np.ptp(column) > 0], axis=1)
    tried = [count for count in WAVES if len(ranks) >= SAMPLES_PER_WAVE * count]
    return any(_chance(ranks, count) * len(tried) < CHANCE for count in tried)


def _ranks(values: Array) -> Array:
    """Rank of each value less the mean rank, of equal values the mean of theirs, shape (T,)."""
    _, inverse, counts = np.unique(values, return_inverse=True, return_counts=True)
    ranks = np.cumsum(counts) - (counts + 1) / 2
    return ranks[inverse] - (len(values) - 1) / 2


def _chance(ranks: Array, count: int) -> float:
    """Probability that so many half waves describe that much of columns in any order: Fisher's, of all."""
    phases = np.pi * (np.arange(len(ranks)) + 0.5) / len(ranks)
    waves = np.cos(phases[:, None] * np.arange(1, count + 1)) * math.sqrt(2 / len(ranks))
    left = 1 - ((waves.T @ ranks) ** 2).sum(axis=0) / (ranks**2).sum(axis=0)
    total = -sum(_log_chance(max(float(each), 1e-12), len(ranks), count) for each in left)
    return math.exp(-total) * sum(total**j / math.factorial(j) for j in range(len(left)))


def _log_chance(left: float, samples: int, count: int) -> float:
    """Log probability that no more than a share is left, which is Beta((T - 1 - K) / 2, K / 2) of noise."""
    half, terms = (samples - 1 - count) / 2, [1.0]
    for j in range(1, count // 2):
        terms.append(terms[-1] * (half + j - 1) / j * (1 - left))
    return half * math.log(left) + math.log(sum(terms))
