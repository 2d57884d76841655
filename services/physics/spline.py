"""Cubic splines of joint motions: what lies between samples, and its exact extrema."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_banded

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
    before, after, slope = h[:-1], h[1:], np.diff(values, axis=0) / h[:, None]
    bands = np.zeros((3, len(times) - 2))
    bands[0, 1:], bands[1], bands[2, :-1] = before[:-1], 2 * (before + after), after[1:]
    known = 3 * (after[:, None] * slope[:-1] + before[:, None] * slope[1:])
    velocities[1:-1] = solve_banded((1, 1), bands, known)
    return velocities


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
        u = np.clip(np.nan_to_num(u, nan=0.0, posinf=1.0, neginf=0.0), 0.0, 1.0)
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
