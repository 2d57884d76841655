"""Cubic Hermite splines of several coordinates: where they are, where they turn."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Cubic:
    """q(s) = c0 + c1 s + c2 s² + c3 s³ on each of N pieces.

    Args:
        times: Shape (T,), T = N + 1 ≥ 2, increasing [s].
        values: Shape (T, n).
        velocities: Shape (T, n).

    Attributes:
        duration: Of each piece, shape (N, 1) [s].
    """

    def __init__(self, times: Array, values: Array, velocities: Array) -> None:
        self._times, self.duration = times, np.diff(times)[:, None]
        h, step = self.duration, np.diff(values, axis=0)
        begin, end = velocities[:-1], velocities[1:]
        self._c0, self._c1 = values[:-1], begin
        self._c2 = (3 * step / h - 2 * begin - end) / h
        self._c3 = (begin + end - 2 * step / h) / h**2

    def at(self, times: Array) -> Array:
        """Values, shape (k, n), at times of shape (k,)."""
        piece, s = self._inside(times)
        c0, c1, c2, c3 = (each[piece] for each in (self._c0, self._c1, self._c2, self._c3))
        return c0 + s * (c1 + s * (c2 + s * c3))

    def velocity(self, times: Array) -> Array:
        """First derivatives, shape (k, n), at times of shape (k,)."""
        piece, s = self._inside(times)
        return self._c1[piece] + s * (2 * self._c2[piece] + 3 * s * self._c3[piece])

    def accelerations(self) -> tuple[Array, Array]:
        """Second derivatives at both ends of each piece, between which they are linear, shape (N, n)."""
        return 2 * self._c2, 2 * self._c2 + 6 * self._c3 * self.duration

    def turns(self) -> Array:
        """Times inside pieces at which a coordinate may turn, shape (k,) [s]; all extrema are among them."""
        c1, c2, c3 = self._c1, self._c2, self._c3
        root = np.sqrt(np.maximum(c2**2 - 3 * c1 * c3, 0))
        far = -(c2 + np.copysign(root, c2))  # the form of the quadratic's roots that does not cancel
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            s = np.stack((far / (3 * c3), c1 / far))
        inside = np.isfinite(s) & (s > 0) & (s < self.duration)
        found = (self._times[:-1, None] + np.where(inside, s, 0))[inside]
        return np.asarray(found, dtype=np.float64)

    def refined(self) -> Array:
        """Times of samples and `turns`: from one to the next each coordinate only rises or only falls."""
        return np.unique(np.concatenate((self._times, self.turns())))

    def _inside(self, times: Array) -> tuple[NDArray[np.intp], Array]:
        """Piece and time into it, shapes (k,) and (k, 1)."""
        last = len(self._times) - 2
        piece = np.clip(np.searchsorted(self._times, times, side="right") - 1, 0, last)
        return piece, (times - self._times[piece])[:, None]
