"""Levenberg and Marquardt's descent within bounds, for few variables."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Residual = Callable[[Array], tuple[Array, Array]]

DAMPING, LEAST = 1e-4, 1e-7  # [1] at first, and at least
SOFTER, HARDER = 4.0, 6.0  # [1] by which damping falls after a step and grows before another
TRIES = 5  # dampings at one posture
STEP = 0.5  # [rad or m] largest change of a variable
GAIN = 1e-4  # [1] of the sum of squares that a step has to save


@dataclass(frozen=True, slots=True)
class Bounds:
    """What may move, and between which limits, each of shape (n,)."""

    moves: NDArray[np.bool_]
    lower: Array
    upper: Array

    def beside(self, x: Array, change: Array) -> Array:
        """x, changed by so much of what may move."""
        return np.clip(x + np.where(self.moves, change, 0.0), self.lower, self.upper)

    def free(self, x: Array, gradient: Array) -> NDArray[np.bool_]:
        """Which variables a descent may change."""
        ends = ((x <= self.lower) & (gradient > 0)) | ((x >= self.upper) & (gradient < 0))
        return self.moves & ~ends


def descend(x: Array, residual: Residual, bounds: Bounds, steps: int, enough: float) -> tuple[Array, float]:
    """Where a descent from x (n,) comes to, and the root of the sum of squares there.

    Args:
        x: Within the bounds.
        residual: Of x, shape (N,), and its derivatives (N, n); N may differ from x to x.
        bounds: Of x.
        steps: At most.
        enough: The root with which it ends.
    """
    (r, rows), damping = residual(x), DAMPING
    cost = float(r @ r)
    for _ in range(steps):
        if cost < enough**2:
            break
        gradient = rows.T @ r
        free = bounds.free(x, gradient)
        if not free.any():
            break
        some = rows[:, free]
        square, diagonal = some.T @ some, np.eye(int(free.sum()))
        for _ in range(TRIES):
            change = np.zeros(len(x))
            change[free] = -np.linalg.solve(square + damping * diagonal, gradient[free])
            change *= min(1.0, STEP / max(float(np.abs(change).max()), STEP))
            there = bounds.beside(x, change)
            r, rows = residual(there)
            now = float(r @ r)
            if now < cost * (1 - GAIN):
                break
            damping *= HARDER
        else:
            break
        x, cost, damping = there, now, max(damping / SOFTER, LEAST)
    return x, float(np.sqrt(cost))


def both(*residuals: tuple[Array, Array]) -> tuple[Array, Array]:
    """Residuals (N,) and their derivatives (N, n), one after the other."""
    values, rows = zip(*residuals, strict=True)
    return np.concatenate(values), np.concatenate(rows)
