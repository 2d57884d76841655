"""Vectors and numbers known within a ball, for many spans of time at once: sound bounds, no directions kept.

What is computed of centres is what holds in the middle of a span; radii bound how far the span may lead
away from it. `interval` widens by more than rounding errs.
"""

from dataclasses import dataclass

import numpy as np

from services.dynamics.model import Array
from services.embodiment.proof_check.geometry.interval import Interval

ROUNDING = 1e-9
"""[1] Share of a figure by which a bound is widened: far more than some hundred operations err."""


@dataclass(frozen=True, slots=True, eq=False)
class Numbers:
    """C numbers, each within a radius of its centre; both of the shape (C,)."""

    centre: Array
    radius: Array

    def __add__(self, other: "Numbers") -> "Numbers":
        return Numbers(self.centre + other.centre, self.radius + other.radius)

    def __mul__(self, other: "Numbers") -> "Numbers":
        return Numbers(self.centre * other.centre, _product(abs(self.centre), self.radius, other))

    def scaled(self, factor: float) -> "Numbers":
        """Times a number that is known."""
        return Numbers(self.centre * factor, self.radius * abs(factor))

    def interval(self) -> Interval:
        """Lower and upper ends."""
        wide = self.radius + ROUNDING * (np.abs(self.centre) + self.radius)
        return Interval(self.centre - wide, self.centre + wide)


@dataclass(frozen=True, slots=True, eq=False)
class Vectors:
    """C vectors, centres of shape (C, 3), each within a radius of its centre, shape (C,)."""

    centre: Array
    radius: Array

    @property
    def size(self) -> Array:
        """Lengths of the centres, shape (C,)."""
        return np.sqrt(np.einsum("ci,ci->c", self.centre, self.centre))

    def __add__(self, other: "Vectors") -> "Vectors":
        return Vectors(self.centre + other.centre, self.radius + other.radius)

    def __sub__(self, other: "Vectors") -> "Vectors":
        return Vectors(self.centre - other.centre, self.radius + other.radius)

    def times(self, other: Numbers) -> "Vectors":
        """Each vector times a number."""
        centre = self.centre * other.centre[:, None]
        return Vectors(centre, _product(self.size, self.radius, other))

    def scaled(self, factor: float) -> "Vectors":
        """Times a number that is known."""
        return Vectors(self.centre * factor, self.radius * abs(factor))

    def dot(self, other: "Vectors") -> Numbers:
        """Inner products."""
        centre = np.einsum("ci,ci->c", self.centre, other.centre)
        return Numbers(centre, self._bilinear(other))

    def cross(self, other: "Vectors") -> "Vectors":
        """Cross products."""
        return Vectors(_cross(self.centre, other.centre), self._bilinear(other))

    def unit(self) -> "Vectors":
        """Directions; a ball that holds 0 has any direction. |x/|x| - y/|y|| <= 2 |x - y| / |x|."""
        size = np.maximum(self.size, np.finfo(float).tiny)
        return Vectors(self.centre / size[:, None], np.minimum(2 * self.radius / size, 2.0))

    def length(self) -> Interval:
        """Bounds of the lengths."""
        wide = self.radius + ROUNDING * (self.size + self.radius)
        return Interval(np.maximum(self.size - wide, 0.0), self.size + wide)

    def _bilinear(self, other: "Vectors") -> Array:
        return self.size * other.radius + other.size * self.radius + self.radius * other.radius


def fixed(vector: Array, count: int) -> Vectors:
    """A vector that is known, shape (3,), for each span."""
    return Vectors(np.tile(vector, (count, 1)), np.zeros(count))


def _product(size: Array, radius: Array, other: Numbers) -> Array:
    return size * other.radius + np.abs(other.centre) * radius + radius * other.radius


def _cross(a: Array, b: Array) -> Array:
    ahead, behind = [1, 2, 0], [2, 0, 1]
    return a[:, ahead] * b[:, behind] - a[:, behind] * b[:, ahead]
