"""Orientations of a track: the axis that they show, and which joint they speak for."""

import math
from dataclasses import dataclass

import numpy as np

from predicates.learn.fitting.cells import Cells
from predicates.learn.fitting.priors import SCALE, SCALE_WEIGHT, TURN_SCALE, log_scale_density
from predicates.learn.fitting.student import FREEDOM, log_student
from predicates.learn.fitting.vectors import cross
from predicates.learn.track import Array, Track

LEAST_TURN = math.radians(10)
"""[rad] An axis is read from orientations that turn by more than this: five times their usual deviation."""

EVENLY = math.sqrt(12)
"""[1] A turn at even speed, by the standard deviation of its angles."""

SMALLEST = 1e-12
"""[1] Sine below which an angle has no axis."""

ROUNDS = 20
"""[1] Rounds of reweighting."""


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """An axis that orientations show.

    Attributes:
        axis: Shape (3,).
        spread: Its standard deviation [rad].
        arm: From the axis to the point at the middle sample, shape (3,) [m].
        arm_spread: Standard deviation of its length [m].
    """

    axis: Array
    spread: float
    arm: Array
    arm_spread: float


@dataclass(frozen=True, slots=True, eq=False)
class Turning:
    """Orientations as rotation vectors from the middle sample, in the track's frame.

    Attributes:
        vectors: Shape (T, 3) [rad].
        weights: Shape (T,): independent observations that each sample is worth.
        seen: The axis that they turn about; None where they hardly turn.
    """

    vectors: Array
    weights: Array
    seen: Seen | None

    def evidence_still(self) -> float:
        """Log evidence of the orientations if nothing turns."""
        return _evidence(self.vectors - np.median(self.vectors, axis=0), self.weights)

    def evidence_turning(self, axis: Array, angles: Array, spread: float) -> float:
        """Log evidence if the body turns about an axis by angles, shape (T,), known within a spread."""
        turned = np.unwrap(self.vectors @ axis)
        along = turned - angles
        along = (along - np.median(along)) / math.hypot(1, spread / TURN_SCALE)
        across = self.vectors - (self.vectors @ axis)[:, None] * axis
        across = across - np.median(across, axis=0)
        return _evidence(across + along[:, None] * axis, self.weights)


def turns_of(orientations: Array) -> Array:
    """Rotation vectors from the middle sample, shape (T, 3) [rad], of unit quaternions xyzw, shape (T, 4)."""
    vectors, scalars = orientations[:, :3], orientations[:, 3]
    middle = orientations[len(orientations) // 2]
    # product with the conjugate of the middle one
    sines: Array = (
        vectors * float(middle[3]) - scalars[:, None] * middle[:3] - cross(vectors, middle[None, :3])
    )
    cosines: Array = scalars * float(middle[3]) + vectors @ middle[:3]
    lengths = np.asarray(np.linalg.norm(sines, axis=1), dtype=np.float64)
    angles = 2 * np.arctan2(lengths, np.abs(cosines)) * np.where(cosines < 0, -1.0, 1.0)
    return np.asarray(sines * (angles / np.maximum(lengths, SMALLEST))[:, None], dtype=np.float64)


def turning_of(track: Track, vectors: Array, cells: Cells) -> Turning:
    """What rotation vectors, shape (T, 3), say of turning."""
    weights = cells.shares()
    total = float(weights.sum())
    off = vectors - weights @ vectors / total  # the middle sample is no better than others
    _, sizes, axes = np.linalg.svd(off * np.sqrt(weights)[:, None], full_matrices=False)
    axis, noise = axes[0], float(np.sum(sizes[1:] ** 2)) / 2
    angles = np.unwrap(vectors @ axis)
    square = float(weights @ (angles - weights @ angles / total) ** 2) - noise
    turn = math.sqrt(max(square, 0.0))
    if EVENLY * turn < LEAST_TURN * math.sqrt(total):
        return Turning(vectors, weights, None)
    arm, spread_of_arm = _arm(track.positions, axis, angles, weights, turn)
    short = float(np.linalg.norm(arm)) * noise / square  # by so much noise of the angles shortens it
    seen = Seen(axis, max(TURN_SCALE / turn, 1e-3), arm, math.hypot(spread_of_arm, short))
    return Turning(vectors, weights, seen)


def _arm(positions: Array, axis: Array, angles: Array, weights: Array, turn: float) -> tuple[Array, float]:
    """From the axis to the point at angle 0, shape (3,) [m], and the standard deviation of its length.

    Least squares, reweighted, over p = c + cos(angle) d + sin(angle) axis × d, where d is across the axis.
    """
    flattest: Array = np.eye(3)[int(np.argmin(np.abs(axis)))]
    side = cross(axis, flattest)
    side = np.asarray(side / np.linalg.norm(side), dtype=np.float64)
    other = cross(axis, side)
    flat = positions @ np.stack([side, other], axis=1)
    cosine, sine = np.cos(angles), np.sin(angles)
    zero, one = np.zeros_like(cosine), np.ones_like(cosine)
    first, second = np.stack([cosine, -sine, one, zero], axis=1), np.stack([sine, cosine, zero, one], axis=1)
    rows: Array = np.stack([first, second], axis=1)
    pull, solution = weights, np.zeros(4)
    for _ in range(ROUNDS):
        left: Array = np.einsum("n,nri,nrj->ij", pull, rows, rows) + SMALLEST * np.eye(4)
        right: Array = np.einsum("n,nri,nr->i", pull, rows, flat)
        solution = np.asarray(np.linalg.solve(left, right), dtype=np.float64)
        squares = np.asarray(((flat - rows @ solution) ** 2) @ np.ones(2), dtype=np.float64)
        pull = weights * (FREEDOM + 2) / (FREEDOM + squares / SCALE**2)
    return float(solution[0]) * side + float(solution[1]) * other, 2 * SCALE / turn


def _evidence(residuals: Array, weights: Array) -> float:
    """Log evidence of rotation residuals, shape (T, 3) [rad], their scale fitted."""
    squares, total, scale = (residuals**2).sum(axis=1), float(weights.sum()), TURN_SCALE
    for _ in range(ROUNDS):
        pull = weights * (FREEDOM + 3) / (FREEDOM + squares / scale**2)
        seen = float(pull @ squares) / 3
        scale = math.sqrt((seen + SCALE_WEIGHT * TURN_SCALE**2) / (total + SCALE_WEIGHT))
    return float(log_student(squares, scale, 3) @ weights) + log_scale_density(scale, TURN_SCALE)
