"""Interval arithmetic on arrays, rounded outwards: what holds for intervals holds for the reals in them."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

TRIG = 4e-15  # [1] more than NumPy's sine and cosine err (4 units in the last place of 1)
UNIT = 2.0**-52  # [1] so large a part of a number is one to two units in its last place
LEAST = 1e-300  # more than what is too small to be told so is off by
LARGEST = float(np.finfo(np.float64).max)  # below what was rounded to infinity


def _down(x: Array) -> Array:
    """Below what was rounded to x; NumPy's `nextafter` takes several times as long."""
    off = _off(x)
    return np.minimum(np.subtract(x, off, out=off), LARGEST, out=off)


def _up(x: Array) -> Array:
    """Above it."""
    off = _off(x)
    return np.maximum(np.add(x, off, out=off), -LARGEST, out=off)


def _off(x: Array) -> Array:
    """By how much, in an array of its own: large ones cost more to be had than to be filled."""
    off = np.asarray(np.abs(x))
    np.minimum(off, LARGEST, out=off)
    np.multiply(off, UNIT, out=off)
    return np.add(off, LEAST, out=off)


@dataclass(frozen=True, slots=True, eq=False)
class Interval:
    """Arrays of intervals of one shape.

    Attributes:
        lo, hi: Their ends.
    """

    lo: Array
    hi: Array

    def __add__(self, other: "Interval") -> "Interval":
        return Interval(_down(self.lo + other.lo), _up(self.hi + other.hi))

    def __sub__(self, other: "Interval") -> "Interval":
        return Interval(_down(self.lo - other.hi), _up(self.hi - other.lo))

    def __mul__(self, other: "Interval") -> "Interval":
        a, b, c, d = self.lo * other.lo, self.lo * other.hi, self.hi * other.lo, self.hi * other.hi
        low = np.minimum(np.minimum(a, b), np.minimum(c, d))
        return Interval(_down(low), _up(np.maximum(np.maximum(a, b), np.maximum(c, d))))

    def __getitem__(self, index: Any) -> "Interval":  # noqa: ANN401 - whatever NumPy takes
        return Interval(self.lo[index], self.hi[index])

    @property
    def T(self) -> "Interval":
        """The last two axes exchanged."""
        return Interval(np.swapaxes(self.lo, -1, -2), np.swapaxes(self.hi, -1, -2))

    @property
    def middle(self) -> Array:
        """Between both ends, rounded."""
        return (self.lo + self.hi) / 2

    def magnitude(self) -> "Interval":
        """Absolute values."""
        across = (self.lo <= 0) & (self.hi >= 0)
        ends = np.abs(self.lo), np.abs(self.hi)
        return Interval(np.where(across, 0.0, np.minimum(*ends)), np.maximum(*ends))

    def total(self) -> "Interval":
        """Sums over the last axis."""
        whole = self[..., 0]
        for k in range(1, self.lo.shape[-1]):
            whole = whole + self[..., k]
        return whole

    def norm(self) -> "Interval":
        """Euclidean norms over the last axis."""
        square = self.magnitude()
        square = (square * square).total()
        return Interval(
            np.maximum(_down(np.sqrt(np.maximum(square.lo, 0.0))), 0.0),
            _up(np.sqrt(np.maximum(square.hi, 0.0))),
        )


def exact(x: object) -> Interval:
    """Intervals of one value each."""
    array = np.asarray(x, dtype=np.float64)
    return Interval(array, array)


def times(one: Interval, other: Interval) -> Interval:
    """Matrix products, shapes (…, n, m) and (…, m, k)."""
    return (one[..., :, None, :] * other.T[..., None, :, :]).total()


def apply(matrix: Interval, vector: Interval) -> Interval:
    """Matrices times vectors, shapes (…, n, m) and (…, m)."""
    return (matrix * vector[..., None, :]).total()


def cross(one: Interval, other: Interval) -> Interval:
    """Cross products, shape (…, 3)."""
    a, b = [1, 2, 0], [2, 0, 1]
    return one[..., a] * other[..., b] - one[..., b] * other[..., a]


def turning(axis: Array, angle: Array) -> Interval:
    """Rotations about a unit axis (3,) by exact angles (…,), shape (…, 3, 3): Rodrigues' formula."""
    x, y, z = axis
    skew = exact([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sine, versine = np.sin(angle)[..., None, None], 1 - np.cos(angle)[..., None, None]
    sines = Interval(sine - TRIG, sine + TRIG)
    versines = Interval(versine - TRIG, versine + TRIG)
    return exact(np.eye(3)) + sines * skew + versines * times(skew, skew)
