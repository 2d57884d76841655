r"""Where the handle is, and whether something that the arm carries is apart from it in boxes of positions.

Along a fixed unit direction d, from the middle of a box of joint positions, with joint j moved by at most
:math:`h_j`, a point p moves by at most the sum over the joints of

.. math:: h_j \min(l_j,\; |d \cdot (a_j \times (p - o_j))| + l_j (h_j / 2 + \sum_{i < j} h_i)),

where :math:`a_j` and :math:`o_j` are the joint's axis and origin in the middle,
:math:`l_j = |a_j \times (p - o_j)|`, and i are the hinges before j: a turn by h is its first-order part to
within :math:`l_j h^2 / 2`, and what is before the joint has turned the whole of it by no more than the sum of
these angles.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.embodiment.proof_check.arm import ROUNDING
from services.embodiment.proof_check.interval import Interval, apply, cross, exact
from services.embodiment.proof_check.mechanics import Placement

Array = NDArray[np.float64]

SHORTER = 1 - 1e-12  # [1] so that no direction is longer than 1
UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, slots=True, eq=False)
class Swing:
    """L boxes of positions of n joints, and where these are in the boxes' middles.

    Attributes:
        origins, axes: Of the joints, shape (L, n, 3).
        half: From the middle to the ends of a box [rad or m], shape (L, n).
        turns: Which joints are hinges, shape (n,).
        upright: How many of the first joints only lift and turn about the vertical, where heights count.
    """

    origins: Interval
    axes: Interval
    half: Array
    turns: NDArray[np.bool_]
    upright: int = 0

    def along(self, d: Array, at: Placement, own: Array) -> Array:
        """How far points of boxes, which all joints carry, move along directions at most [m], shape (L,).

        Args:
            d: Directions no longer than 1, shape (L, 3).
            at: Where the boxes are, L of them.
            own: Their half extents [m], shape (3,).
        """
        ways, radius = exact(d)[:, None], float(np.linalg.norm(own)) * (1 + 1e-12)
        moves = cross(self.axes, at.translation[:, None] - self.origins)
        first = (ways * moves).total().magnitude().hi
        if own.any():
            across = apply(at.rotation.T[:, None], cross(ways, self.axes)).magnitude()
            first = (exact(first) + (across * exact(own)).total()).hi
        slid = (ways * self.axes).total().magnitude().hi
        whole = np.where(self.turns, moves.norm().hi + radius, 1.0)
        angles = np.where(self.turns, self.half, 0.0)
        before = np.cumsum(angles, axis=1) - angles
        second = whole * (angles / 2 + before) * (1 + 1e-12)
        arms = np.minimum(whole, np.where(self.turns, first, slid) + second)
        lifts = np.where(self.turns, 0.0, self.axes[..., 2].magnitude().hi)
        arms = np.where(np.arange(len(self.turns)) < self.upright, lifts, arms)
        return (arms * self.half).sum(axis=1) * (1 + 1e-12)


@dataclass(frozen=True, slots=True, eq=False)
class Target:
    """The handle with the container at one value.

    Attributes:
        boxes: Where its shapes' boxes are in the world.
        half: Their half extents, widened by what certification tolerates, and by the distance at which a
            hold has the handle in hand, where that is meant [m], shape (B, 3).
        shift: How far each may be from there [m], shape (B,).
    """

    boxes: tuple[Placement, ...]
    half: Array
    shift: Array

    def apart(self, at: Placement, own: Array, swing: Swing, level: bool) -> Array:
        """How far boxes, which joints carry, are from the nearest of the handle all the time [m], shape (L,).

        Lower bounds; below 0 where nothing is shown.

        Args:
            at: Where the boxes are in the middles, L of them.
            own: Their half extents [m], shape (3,).
            swing: The joints that carry them.
            level: Whether only heights are known.
        """
        nearest = np.full(len(at.translation.lo), np.inf)
        for box, half in zip(self.boxes, self.half, strict=True):
            widest = np.full(len(nearest), -np.inf)
            local = at.translation - box.translation
            for d in _directions(box, half, at, own, level):
                gap = (exact(d) * local).total().lo - _extent(d, box, half) - _extent(d, at, own)
                widest = np.maximum(widest, gap - swing.along(d, at, own))
            nearest = np.minimum(nearest, widest - ROUNDING)
        return nearest


def _extent(d: Array, at: Placement, half: Array) -> Array:
    """How far a box reaches from its middle along directions [m], shape (L,)."""
    return (apply(at.rotation.T, exact(d)).magnitude() * exact(half)).total().hi


def _directions(box: Placement, half: Array, at: Placement, own: Array, level: bool) -> Iterator[Array]:
    """Along which things may be apart, from the handle's box to the others, shape (L, 3); any will do.

    The axes of both boxes, or that from the nearest point where the other is a point.
    """
    turn, other = ((one.rotation.lo + one.rotation.hi) / 2 for one in (box, at))
    away = (at.translation.lo + at.translation.hi - box.translation.lo - box.translation.hi) / 2
    if level:
        axes = [np.tile(UP, (len(away), 1))]
    elif own.any():
        axes = [np.tile(turn[:, k], (len(away), 1)) for k in range(3)] + [other[:, :, k] for k in range(3)]
    else:
        local = away @ turn
        axes = [(local - np.clip(local, -half, half)) @ turn.T]
    for axis in axes:
        length = np.linalg.norm(axis, axis=1, keepdims=True)
        sign = np.where((axis * away).sum(axis=1, keepdims=True) < 0, -1.0, 1.0)
        yield sign * axis * SHORTER / np.maximum(length, np.finfo(float).tiny)
