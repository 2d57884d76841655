"""Cubic splines of joint motions: what lies between samples, and its exact extrema."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.kernel import kernel

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Excess:
    """A bound that a spline does not keep.

    Attributes:
        value: As reached, the bound it had to keep, and when [s].
        first: Whether it is the first time; else it is the worst.
    """

    value: float
    bound: float
    time: float
    first: bool


def at_rest_velocities(times: Array, values: Array) -> Array:
    """Velocities at the samples of the C² cubic spline which begins and ends at rest.

    Where two pieces meet they have one acceleration: with durations h, k and slopes s, t of the chords
    before and after sample i, k v[i - 1] + 2 (h + k) v[i] + h v[i + 1] = 3 (k s + h t).

    Args:
        times: Shape (T,), increasing [s].
        values: Shape (T, n).

    Returns:
        Shape (T, n).
    """
    velocities = np.zeros_like(values)
    if len(times) < 3:
        return velocities
    h = np.diff(times)
    bands, known = _as_smooth(h, np.diff(values, axis=0) / h[:, None])
    velocities[1:-1] = _solution(bands[:, 1:-1], known)
    return velocities


def free_velocities(times: Array, values: Array) -> Array:
    """The same of the C² cubic spline whose first two pieces are one cubic, and its last two.

    Two samples are joined by a straight line, three by a parabola.
    """
    h = np.diff(times)
    slope = np.diff(values, axis=0) / h[:, None]
    if len(times) == 2:
        return np.repeat(slope, 2, axis=0)
    if len(times) == 3:
        middle = (h[1] * slope[0] + h[0] * slope[1]) / (h[0] + h[1])
        return np.stack([2 * slope[0] - middle, middle, 2 * slope[1] - middle])
    known = np.empty(values.shape)
    bands, known[1:-1] = _as_smooth(h, slope)
    for own, inner, beside in ((0, 1, (0, 1)), (-1, -2, (2, -2))):
        both = h[own] + h[inner]
        bands[1, own], bands[beside] = h[inner], both
        known[own] = ((h[own] + 2 * both) * h[inner] * slope[own] + h[own] ** 2 * slope[inner]) / both
    return _solution(bands, known)


def _as_smooth(h: Array, slope: Array) -> tuple[Array, Array]:
    """Both sides of the equations by which pieces that meet have one acceleration.

    The diagonals, for all T velocities, are shape (3, T), of which the equations of the first and last
    sample are left open; what is known is shape (T − 2, n).
    """
    before, after = h[:-1], h[1:]
    bands = np.zeros((3, len(h) + 1))
    bands[0, 2:], bands[1, 1:-1], bands[2, :-2] = before, 2 * (before + after), after
    return bands, 3 * (after[:, None] * slope[:-1] + before[:, None] * slope[1:])


def _solution(bands: Array, known: Array) -> Array:
    """Velocities that fulfil the equations, shape (T, n), of the bands above, on and below the diagonal."""
    above, middle, below = bands.copy()
    velocities = np.array(known, order="C")
    _eliminate(above, middle, below, velocities)
    return velocities


@kernel(makes=False)
def _eliminate(above: Array, middle: Array, below: Array, known: Array) -> None:
    """The known sides become the solution: middle[i] x[i] + above[i + 1] x[i + 1] + below[i - 1] x[i - 1].

    Without exchange of rows: a row's diagonal outweighs the others, but for the ends of `free_velocities`,
    whose own diagonals stay positive.
    """
    count, joints = known.shape
    for i in range(1, count):
        share = below[i - 1] / middle[i - 1]
        middle[i] -= share * above[i]
        for j in range(joints):
            known[i, j] -= share * known[i - 1, j]
    for i in range(count - 1, -1, -1):
        for j in range(joints):
            rest = known[i, j] - above[i + 1] * known[i + 1, j] if i < count - 1 else known[i, j]
            known[i, j] = rest / middle[i]


@dataclass(frozen=True, slots=True, eq=False)
class Cubic:
    """The cubic Hermite spline of samples of n joints: times (T,), values and velocities (T, n)."""

    times: Array
    values: Array
    velocities: Array

    def at(self, times: Array) -> tuple[Array, Array]:
        """Positions and velocities at some times (M,), shape (M, n) each; outside, the end pieces go on."""
        before = np.searchsorted(self.times[1:-1], times, side="right")
        start, h = self.times[before], (self.times[before + 1] - self.times[before])[:, None]
        s = (times - start)[:, None]
        v, end = self.velocities[before], self.velocities[before + 1]
        slope = (self.values[before + 1] - self.values[before]) / h
        bend, turn = (3 * slope - 2 * v - end) / h, (v + end - 2 * slope) / (h * h)
        position = self.values[before] + s * (v + s * (bend + s * turn))
        return position, v + s * (2 * bend + 3 * s * turn)


class Hermite:
    """The cubic Hermite spline of one joint's samples; every extremum is exact.

    On a piece of duration h, with u in [0, 1] and d = q1 - q0:
    q(u) = q0 + h v0 u + (3 d - 2 h v0 - h v1) u² + (h v0 + h v1 - 2 d) u³.

    Args:
        times: Shape (T,), T ≥ 2, increasing [s].
        values: Shape (T,) [rad or m].
        velocities: Shape (T,).
    """

    def __init__(self, times: Array, values: Array, velocities: Array) -> None:
        self._start, self._h = times[:-1], np.diff(times)
        step, v0, v1 = np.diff(values), velocities[:-1] * self._h, velocities[1:] * self._h
        self._c0, self._c1 = values[:-1], v0
        self._c2, self._c3 = 3 * step - 2 * v0 - v1, v0 + v1 - 2 * step

    def position(self) -> tuple[Array, Array]:
        """Times and values among which are all extrema, shape (k,) each, in order of time."""
        # Roots of q'(u) = c1 + 2 c2 u + 3 c3 u², in the form that stays exact where c3 vanishes.
        root = np.sqrt(np.maximum(self._c2**2 - 3 * self._c3 * self._c1, 0))
        far = -(self._c2 + np.where(self._c2 < 0, -1.0, 1.0) * root)
        with np.errstate(divide="ignore", invalid="ignore"):
            inner = [far / (3 * self._c3), self._c1 / far]
        return self._sampled(
            inner, lambda u: self._c0 + u * (self._c1 + u * (self._c2 + u * self._c3)), scale=0
        )

    def velocity(self) -> tuple[Array, Array]:
        """As `position`, of the first derivative."""
        with np.errstate(divide="ignore", invalid="ignore"):
            inner = [-self._c2 / (3 * self._c3)]
        return self._sampled(inner, lambda u: self._c1 + u * (2 * self._c2 + u * 3 * self._c3), scale=1)

    def acceleration(self) -> tuple[Array, Array]:
        """As `position`, of the second derivative, which is linear on every piece."""
        return self._sampled([], lambda u: 2 * self._c2 + 6 * u * self._c3, scale=2)

    def _sampled(self, inner: list[Array], of: Callable[[Array], Array], scale: int) -> tuple[Array, Array]:
        u = np.stack([np.zeros_like(self._h), *inner, np.ones_like(self._h)])
        u = np.fmin(np.fmax(u, 0.0), 1.0)  # also what is no number
        u.sort(axis=0)
        values = of(u) / self._h**scale
        return (self._start + u * self._h).T.ravel(), values.T.ravel()


def excesses(times: Array, values: Array, lower: float, upper: float, slack: float) -> Iterator[Excess]:
    """First and worst value outside [lower, upper] by more than `slack`; one if they are the same."""
    beyond = np.maximum(lower - values, values - upper)
    outside = np.flatnonzero(beyond > slack)
    if not outside.size:
        return
    first, worst = int(outside[0]), int(np.argmax(beyond))
    for index in dict.fromkeys((first, worst)):
        value = float(values[index])
        yield Excess(value, upper if value > upper else lower, float(times[index]), index == first)
