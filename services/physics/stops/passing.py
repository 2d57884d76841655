"""Where two boxes may meet while one joint moves one of them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Boxes:
    """Boxes in the world, in any number of dimensions before the last.

    Attributes:
        rotation: Their axes as columns, shape (…, 3, 3).
        middle: Shape (…, 3) [m].
        half: Half extents along their own axes, shape (…, 3) [m].
    """

    rotation: Array
    middle: Array
    half: Array

    def corners(self) -> tuple[Array, Array]:
        """Lowest and highest coordinates of each, shape (…, 3) [m]."""
        reach = (np.abs(self.rotation) @ self.half[..., None])[..., 0]
        return self.middle - reach, self.middle + reach

    def where(self, index: NDArray[np.intp]) -> "Boxes":
        """Some of them, along the last dimension."""
        return Boxes(self.rotation[..., index, :, :], self.middle[..., index, :], self.half[..., index, :])


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """That of the one joint that moves.

    Attributes:
        axis: Of the joint in the world, of length 1, shape (3,).
        origin: A point of it, shape (3,) [m].
        slides: Whether it is prismatic.
        rate: [rad or m per unit of the actuated joint] How fast it goes, negative where it goes back.
    """

    axis: Array
    origin: Array
    slides: bool
    rate: float

    def shift(self, directions: Array, boxes: Boxes, part: float) -> Array:
        """How far points of the boxes move along directions (…, 3, k) on a part of it, shape (…, k) [m].

        A point at a distance ρ from the axis ω moves along n by at most |n × ω| ρ for each radian.
        """
        along, part = self.axis @ directions, part * abs(self.rate)
        if self.slides:
            return np.abs(along) * part
        arm = boxes.middle - self.origin
        arm = arm - (arm @ self.axis)[..., None] * self.axis
        reach: Array = np.linalg.norm(arm, axis=-1) + np.linalg.norm(boxes.half, axis=-1)
        return np.sqrt(np.maximum(1.0 - along**2, 0.0)) * reach[..., None] * part


def may_meet(way: Way, half: float, moved: Boxes, resting: Boxes, least: Array) -> NDArray[np.bool_]:
    """On which pieces of the way a moved box may be deeper than `least` in a resting one, shape (N, P).

    On a piece they are not if they are parted along an axis of one of the two: in its middle by more than
    they can come nearer along that axis until its ends. What is in the boxes is then no deeper either.

    Args:
        way: How one of them moves.
        half: Half of a piece [unit of the actuated joint].
        moved: One for each pair in the middle of each piece, shape (N, P).
        resting: Those against which they move, shape (P,).
        least: Depth that is allowed, shape (P,) [m].
    """
    between = (moved.middle - resting.middle)[..., None, :]
    widest = np.full(between.shape[:-2], -np.inf)
    # Seen from the box whose axis it is, it is the points of the other one that move.
    for own, other in ((resting, moved), (moved, resting)):
        gap = np.abs((between @ own.rotation)[..., 0, :]) - own.half
        gap -= (np.abs(np.swapaxes(own.rotation, -1, -2) @ other.rotation) @ other.half[..., None])[..., 0]
        widest = np.maximum(widest, (gap - way.shift(own.rotation, other, half)).max(axis=-1))
    return widest < -least
