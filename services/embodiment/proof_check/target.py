"""Where the handle is, and whether something that the arm carries is apart from it in boxes of positions."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.embodiment.proof_check.arm import ROUNDING
from services.embodiment.proof_check.geometry.interval import apply, exact
from services.embodiment.proof_check.geometry.levers import lever_of
from services.embodiment.proof_check.geometry.mechanics import SHORTER, Chain, Placement, Swing

Array = NDArray[np.float64]

UP = np.array([0.0, 0.0, 1.0])


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


def placed(
    chain: Chain, q: Array, boxes: list[tuple[Placement, Array]], slack: Array, about: float
) -> Target:
    """Boxes of the handle's frame in the world, widened by what the joints before it may be off.

    Args:
        chain: To the handle's frame.
        q: Where its joints are [rad or m], shape (1, n).
        boxes: Where their middles are, and their half extents [m], shape (3,).
        slack: How far each joint may be from there [rad or m], shape (n,).
        about: How far from a box holds may be, where those in hand are meant [m].
    """
    origins, axes, end = chain.frames(q)
    turns = np.array([link.turns for link in chain.links])
    places: list[Placement] = []
    halves: list[Array] = []
    shifts: list[float] = []
    for middle, half in boxes:
        at = end @ middle
        arms = lever_of(origins, axes, at.translation, chain.links)
        moved = float(((arms + np.where(turns, np.linalg.norm(half), 0.0)) * slack).sum())
        places.append(Placement(at.rotation[0], at.translation[0]))
        shifts.append(moved + ROUNDING)
        halves.append(half + shifts[-1] + about)
    return Target(tuple(places), np.array(halves).reshape(-1, 3), np.array(shifts))


def _extent(d: Array, at: Placement, half: Array) -> Array:
    """How far a box reaches from its middle along directions [m], shape (L,)."""
    return (apply(at.rotation.T, exact(d)).magnitude() * exact(half)).total().hi


def _directions(box: Placement, half: Array, at: Placement, own: Array, level: bool) -> Iterator[Array]:
    """Along which things may be apart, from the handle's box to the others, shape (L, 3); any will do.

    The axes of both boxes, or that from the nearest point where the other is a point.
    """
    turn, other = (one.rotation.middle for one in (box, at))
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
