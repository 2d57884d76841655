"""How far one joint may take a shape towards another, told by the direction that parts the two."""

import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # found through a .pth file

from services.physics.stops.passing import Array, Way

WITHIN = 1e-9
"""[m] Of a plane, within which a corner counts as beyond it: there rounding decides."""

ROUNDED = 1e-9
"""[1] By how much a direction's length may differ from 1."""


class Course:
    """Corners on the way of the one joint that moves them past others, which rest.

    Args:
        way: Of the joint, in the world.
        corners: With the joint where it begins, shape (K, 3) [m] in the world.
        against: The others, shape (L, 3) [m].
    """

    def __init__(self, way: Way, corners: Array, against: Array) -> None:
        self._way, self._against = way, against
        arm = corners - way.origin
        self._aside = np.sign(way.rate) * np.cross(way.axis, arm)
        self._out = arm - (arm @ way.axis)[:, None] * way.axis
        self._fixed = corners - self._out

    def free(self, gone: float, toward: Array, allowed: float) -> float:
        """How much farther it goes with the two no deeper in each other along a direction than is allowed.

        Args:
            gone: How far the actuated joint is on its way [its unit].
            toward: From these corners to the others; its length is 1 where there is one.
            allowed: [m].
        """
        if not abs(toward @ toward - 1.0) < ROUNDED:
            return 0.0
        bound = float((self._against @ toward).min()) + allowed
        if self._way.slides:
            rate = self._way.rate * float(self._way.axis @ toward)
            room = bound - float(((self._fixed + self._out) @ toward).max()) - gone * rate
            if not room > WITHIN:
                return 0.0
            return room / rate if rate > 0 else np.inf
        # A corner is at reach · cos(angle - crest) from the middle of its circle, and may be at `room`.
        angle, room = gone * abs(self._way.rate), bound - self._fixed @ toward
        across, aside = self._out @ toward, self._aside @ toward
        if not (np.cos(angle) * across + np.sin(angle) * aside < room - WITHIN).all():
            return 0.0
        reach, crest = np.hypot(across, aside), np.arctan2(aside, across)
        far = reach > room
        if not far.any():
            return np.inf
        before = np.arccos(np.clip(room[far] / reach[far], -1.0, 1.0))
        return float(((crest[far] - before - angle) % (2 * np.pi)).min()) / abs(self._way.rate)


def seen(at: pin.SE3, points: Array) -> Array:
    """Points, shape (K, 3), where they are with their frame there."""
    there: Array = points @ at.rotation.T + at.translation
    return there
