"""Samples of a path, and what bounds how fast it is followed."""

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from services.embodiment.certify.sweep.pieces import ahead, hermite, positions

Array = NDArray[np.float64]

LAG = 5e-5  # [rad or m] behind the motion, of what is slowed near a limit: half of what certification allows
STEPS = 30  # of a convex search that is mostly there after three


@dataclass(frozen=True, slots=True, eq=False)
class Timed:
    """Samples of a path: times (T,) [s], positions (T, n), velocities (T, n)."""

    times: Array
    x: Array
    v: Array

    def slower(self, factor: float) -> "Timed":
        """The same way in so many times the time."""
        return self if factor == 1.0 else Timed(self.times * factor, self.x, self.v / factor)


@dataclass(frozen=True, slots=True, eq=False)
class Bound:
    """Limits of velocity and acceleration, shape (n,); the first two columns are bounded together.

    Attributes:
        lower, upper, gain: Of what is slowed near its limits of position, see `sdt_kg.mechanism.Limits`.
    """

    velocity: Array
    acceleration: Array
    lower: Array
    upper: Array
    gain: Array

    @staticmethod
    def alone(velocity: Array, acceleration: Array) -> "Bound":
        """Of what is nowhere slowed."""
        far = np.full(len(velocity), np.inf)
        return Bound(velocity, acceleration, -far, far, far)

    def beside(self, other: "Bound") -> "Bound":
        """The limits of these variables, then those of the others."""
        pairs = ((getattr(self, each.name), getattr(other, each.name)) for each in fields(self))
        return Bound(*(np.append(own, more) for own, more in pairs))

    def haste(self, timed: Timed) -> float:
        """How many times too fast they come near limits that slow them, between samples too; 1 if not.

        Where the gain is k, a variable has to be within its limits 1/k later at the speed it has. How much
        later it is, is looked for by Newton's method: bounded next where it was exceeded most.
        """
        slowed = np.flatnonzero(np.isfinite(self.gain))
        if not len(slowed):
            return 1.0
        pieces = hermite(timed.times, timed.x[:, slowed], timed.v[:, slowed])
        lower, upper = self.lower[slowed] - LAG, self.upper[slowed] + LAG
        asked = 1.0 / self.gain[slowed]
        seconds = asked.copy()
        for _ in range(STEPS):
            values, s = positions(ahead(pieces, seconds))
            excess = np.maximum(lower - values, values - upper)
            if not (excess > LAG / 2).any():
                break
            for k in np.flatnonzero((excess > LAG / 2).any(axis=(0, 1))):
                i, n = np.unravel_index(np.argmax(excess[:, :, k]), excess.shape[:2])
                q, v, _ = (each[0, k] for each in pieces.at(np.array([n]), s[i, n, [k]]))
                if v:  # what stands beyond a limit is no nearer to it more slowly
                    seconds[k] = max(upper[k] - q if v > 0 else q - lower[k], LAG / 2) / abs(v)
        return float((asked / seconds).max(initial=1.0))
