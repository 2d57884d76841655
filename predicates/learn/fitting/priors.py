r"""What a kitchen's mechanisms are like before one is seen.

Every candidate is a curve with the density of its parameters. Where the curve begins and how long
it is are equally likely for all; what tells them apart is the direction of the axis and, for an
arc, its radius: a drawer is not a 5 m arc.
"""

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np

from predicates.learn.fitting.vectors import cross
from predicates.learn.track import Array

RADIUS = 0.45
"""[m] Median distance of a handle from its hinge: cabinet doors 0.3 to 0.5, fridges and ovens to 0.8."""

RADIUS_SPREAD = 0.5
"""[1] Standard deviation of the logarithm of the radius: 95 % lie in 0.17 to 1.2 m."""

LARGE_RADIUS = 1.2
"""[m] One that few handles exceed, see above."""

KNOBS = 0.01
"""[1] Share of joints whose handle is near the axis, per unit of log radius: only orientations show them."""

TRAVEL = 0.35
"""[m] Median travel of a handle along its path."""

TRAVEL_SPREAD = 0.8
"""[1] Standard deviation of the logarithm of the travel: 95 % lie in 0.07 to 1.7 m."""

TILT = math.radians(0.5)
"""[rad] How far a mechanism, in the frame it is seen in, is out of plumb. With 0.5 degrees the second half of
the reference's drawers is predicted within 4.4 mm at the median, with 2 degrees within 6: hands sag."""

SCALE = 0.002
"""[m] Typical deviation of a handle from its ideal path: play, compliance, a hand that slips."""

SCALE_WEIGHT = 4.0
"""[1] Samples that such an expectation is worth. With fewer, a few outliers make a straight line that nothing
follows likelier than an arc that most samples follow, and a drawer that is seen to come out 3 cm is taken to
stand still; with more, what a tracker wanders by 4 mm in seconds is taken for motion."""

STILL_SCALE = 0.001
"""[m] Deviation of a point that nothing moves, beside noise of single samples: no hand slips on it."""

TURN_SCALE = math.radians(2)
"""[rad] The same for an observed orientation."""


class Plumb(Enum):
    """How an axis lies to gravity."""

    FREE = "free"
    HORIZONTAL = "horizontal"
    VERTICAL = "vertical"


SHARES = {
    "revolute": {Plumb.FREE: 0.2, Plumb.HORIZONTAL: 0.3, Plumb.VERTICAL: 0.5},
    "prismatic": {Plumb.FREE: 0.2, Plumb.HORIZONTAL: 0.75, Plumb.VERTICAL: 0.05},
}
"""[1] How often an axis is free, horizontal or vertical. The free part keeps a frame that is not upright
from misleading: it costs one or two units of evidence, no more."""


@dataclass(frozen=True, slots=True)
class Gravity:
    """What is known of the direction up.

    Attributes:
        up: Unit vector, shape (3,), or None where the frame says nothing of it.
        level: Two horizontal unit vectors, shape (3, 2).
    """

    up: Array | None
    level: Array

    @staticmethod
    def towards(up: Array | None) -> "Gravity":
        """Gravity against a direction up, or none known."""
        if up is None:
            return Gravity(None, np.zeros((3, 2)))
        flattest: Array = np.eye(3)[int(np.argmin(np.abs(up)))]
        east = cross(up, flattest)
        east = east / np.linalg.norm(east)
        level: Array = np.stack([east, cross(up, east)], axis=1)
        return Gravity(up, level)

    def classes(self, joint_type: str) -> dict[Plumb, float]:
        """Which ways an axis may lie, each with its probability."""
        return {Plumb.FREE: 1.0} if self.up is None else SHARES[joint_type]

    def residuals(self, axes: Array, plumb: Plumb) -> Array:
        """How far axes are from lying so, in units of TILT: shape (K, 0, 1 or 2) for axes (K, 3)."""
        if plumb is Plumb.FREE or self.up is None:
            return np.zeros((len(axes), 0))
        if plumb is Plumb.HORIZONTAL:
            return (axes @ self.up)[:, None] / TILT
        return axes @ self.level / TILT

    def log_density(self, axis: Array, plumb: Plumb) -> float:
        """Log density of an axis, its sign not counting, on the half sphere [1/sr]."""
        squares = float((self.residuals(axis[None], plumb) ** 2).sum())
        if plumb is Plumb.FREE:
            return -math.log(2 * math.pi)
        if plumb is Plumb.HORIZONTAL:
            return -squares / 2 - math.log(math.sqrt(2 * math.pi) * TILT * math.pi)
        return -squares / 2 - math.log(2 * math.pi * TILT**2)


def log_radius_density(radius: float) -> float:
    """Log density of the logarithm of a radius."""
    return log_normal(radius, RADIUS, RADIUS_SPREAD)


def log_seen_radius_density(radius: float) -> float:
    """The same where orientations show the turning: a handle may then be at its axis."""
    return float(np.logaddexp(log_radius_density(radius), math.log(KNOBS)))


def log_travel_density(travel: float) -> float:
    """Log density of the logarithm of a travel; a mechanism that hardly moves hardly is one."""
    return log_normal(travel, TRAVEL, TRAVEL_SPREAD)


def log_normal(value: float, median: float, spread: float) -> float:
    """Log density of log(value) about log(median)."""
    z = math.log(max(value, 1e-9) / median) / spread
    return -z * z / 2 - math.log(spread * math.sqrt(2 * math.pi))


def log_scale_density(scale: float, expected: float) -> float:
    """Log density of the logarithm of a deviation's scale, up to a constant that all candidates share."""
    ratio = (expected / scale) ** 2
    return SCALE_WEIGHT * (math.log(ratio) + 1 - ratio)
