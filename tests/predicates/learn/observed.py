"""Synthetic observations: a point on a drawer or door, seen with noise."""

import numpy as np
from numpy.typing import NDArray

from predicates.learn import Track

Array = NDArray[np.float64]

NOISE = 0.002
"""[m] Standard deviation of an observed coordinate."""


def stopping(end: float, still: int = 50, moving: int = 150) -> Array:
    """Joint positions: at rest at 0, then steadily to the end, then at rest."""
    return np.concatenate([np.zeros(still), np.linspace(0, end, moving), np.full(still, end)])


def drawer(positions: Array, axis: tuple[float, float, float] = (0.6, -0.8, 0.0)) -> Array:
    """Points of a drawer's handle, shape (T, 3) [m]."""
    return np.array([0.5, 0.2, 0.7]) + positions[:, None] * np.array(axis)


def door(positions: Array, radius: float = 0.4) -> Array:
    """Points of the handle of a door with a vertical hinge at (1.0, 0.2)."""
    return np.column_stack(
        [1.0 + radius * np.cos(positions), 0.2 + radius * np.sin(positions), np.full(len(positions), 0.9)]
    )


def seen(points: Array, seed: int = 0, noise: float = NOISE, outliers: float = 0.0) -> Track:
    """The points with noise, and a share of them anywhere within 15 cm."""
    generator = np.random.default_rng(seed)
    noisy = points + generator.normal(0, noise, points.shape)
    wrong = generator.random(len(points)) < outliers
    noisy[wrong] += generator.uniform(-0.15, 0.15, (int(wrong.sum()), 3))
    return Track(noisy, np.arange(len(points)) * 0.03, timed=True)


def about_z(positions: Array, seed: int = 0, noise: float = 0.01) -> Array:
    """Quaternions xyzw of a body that turns about z by the positions, seen with noise [rad]."""
    generator = np.random.default_rng(seed)
    small = generator.normal(0, noise / 2, (len(positions), 3))
    half = np.column_stack([small[:, :2], np.sin(positions / 2) + small[:, 2], np.cos(positions / 2)])
    return half / np.linalg.norm(half, axis=1, keepdims=True)
