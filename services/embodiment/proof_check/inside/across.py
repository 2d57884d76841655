"""Where a core of the robot reaches across something solid, wherever the joints are in a box of positions.

A solid is seen along its shortest side, as a plate, by a plane in it across that. Of a chord of a core one
end stays below that plane and the other above it; so some point of it, and of the core, is in the plane. It
lies between both ends, and if, wherever these are, that is within the plate, the box is refuted. Nothing has
to stay in a panel, however thin, and which point of the core it is may change.

With ends at heights from :math:`a_0` to :math:`a_1` and from :math:`b_0` to :math:`b_1`, and a plane at l
between :math:`a_1` and :math:`b_0`, the share s of the way from end to end at which a chord crosses it is
from :math:`(l - a_1) / (b_1 - a_1)` to :math:`(l - a_0) / (b_0 - a_0)`; along any other side the point is at
:math:`(1 - s) a' + s b'`, which is largest, as smallest, at one of both.
"""

import numpy as np
from numpy.typing import NDArray

from services.embodiment.proof_check.geometry.interval import Interval, apply, exact
from services.embodiment.proof_check.geometry.mechanics import HERE, SHORTER, Chain, Placement, Swing
from services.embodiment.proof_check.inside.boxes import Core
from services.embodiment.proof_check.inside.solids import ROUNDING, WORLD, Around, Solids

Array = NDArray[np.float64]

Core3 = tuple[Array, Array, Array]
"""Cores in floats: rotations (L, 3, 3), middles (L, 3), and the half extents of all (3,) [m]."""

SHARES = (2.0, 1.4, 1.0, 0.7, 0.4, 0.2, 0.0)
LEEWAY = 0.02
"""Of how far a core sways along a plate, and so much [m]: so far from its rim a chord is, if any is there."""
FLAT = 1e-5  # [1] cosine to a face below which a line does not leave a core by it
APART = 1e-6  # [m] an end is at least from the plane: shares of the way are then known to some 1e-9


def reaches_across(
    cores: tuple[Core, ...], c: int, chain: Chain, around: tuple[Around, ...], boxes: tuple[Array, Array]
) -> NDArray[np.bool_]:
    """Whether core c reaches across something solid in all of each box of positions, shape (L,).

    False where no such chord was found. What the robot itself carries is not looked at.

    Args:
        cores: Boxes inside bodies of the arm.
        c: Index of the one that is meant.
        chain: The arm.
        around: What is solid.
        boxes: Middles and half widths of the positions of the chain's joints, shapes (L, n).
    """
    found, core = np.zeros(len(boxes[0]), dtype=np.bool_), cores[c]
    at, swing = core.seen_from(WORLD, chain, boxes)
    for one in (one for one in around if one.carrier == WORLD):
        for s in np.flatnonzero(one.keeps[c]).tolist():
            left = np.flatnonzero(~found)
            found[left] = Plate(one.solids, s).is_crossed(at.some(left), core.half, swing.some(left))
    return found


class Plate:
    """One of several solids, seen along its shortest side."""

    def __init__(self, solids: Solids, s: int) -> None:
        self._half = solids.half[s]
        self._side = int(self._half.argmin())
        self._at = Placement(solids.at.rotation[s], solids.at.translation[s])
        #: Directions of its sides, rows; and where it is. In floats.
        self._ways, self._place = self._at.rotation.middle.T * SHORTER, self._at.translation.middle

    def is_crossed(self, at: Placement, own: Array, swing: Swing) -> NDArray[np.bool_]:
        """Whether a chord of a core stays across it, shape (L,).

        Args:
            at: Where the core is in the middles of boxes, L of them.
            own: Its half extents [m], shape (3,).
            swing: The joints that carry it.
        """
        found = np.zeros(len(at.translation.lo), dtype=np.bool_)
        local = np.abs((at.translation.middle - self._place) @ self._ways.T)
        reach = np.abs(np.einsum("ij,ljk->lik", self._ways, at.rotation.middle)) @ own
        near = np.flatnonzero((local < reach + self._half).all(axis=1))
        if not len(near):
            return found
        at, some = at.some(near), swing.some(near)
        core = at.rotation.middle, at.translation.middle, own - 2 * ROUNDING
        for ends in (self._upright(core, self._sways(at.translation, some)), self._slanting(core)):
            seen = [self._seen(exact(one), some) for one in ends]
            found[near] |= _inside(at, own, ends) & self._between(*seen)
        return found

    def _upright(self, core: Core3, sways: Array) -> Array:
        """Lines across the plate, far from its rim and near the middles of cores, where they leave these.

        Ends of shape (2, L, 3); at the middle of a core where no such line meets it. In floats.
        """
        turn, place, half = core
        local = (place - self._place) @ self._ways.T
        way = np.einsum("lji,j->li", turn, self._ways[self._side])
        ends, left = np.stack((place, place)), np.ones(len(place), dtype=np.bool_)
        for share in SHARES:
            room = np.maximum(self._half - share * (sways + LEEWAY), 0.0)
            moved = np.clip(local, -room, room) - local
            moved[:, self._side] = 0.0
            point = place + moved @ self._ways
            where = np.einsum("lji,lj->li", turn, point - place)
            with np.errstate(divide="ignore", invalid="ignore"):
                each = np.sort(np.stack((-half - where, half - where)) / way, axis=0)
            beside = (np.abs(way) < FLAT) & (np.abs(where) > half)
            each = np.where(np.abs(way) < FLAT, np.array([-np.inf, np.inf])[:, None, None], each)
            low, high = each[0].max(axis=1), each[1].min(axis=1)
            now = left & (low < high) & ~beside.any(axis=1)
            ends[:, now] = point[now] + np.stack((low, high))[:, now, None] * self._ways[self._side]
            left &= ~now
        return ends

    def _slanting(self, core: Core3) -> Array:
        """Diagonals of cores, from the corner lowest across the plate to the highest one, as above."""
        turn, place, half = core
        way = np.einsum("lji,j->li", turn, self._ways[self._side])
        off = np.einsum("lij,lj->li", turn, np.copysign(half, way))
        return np.stack((place - off, place + off))

    def _seen(self, point: Interval, swing: Swing) -> Interval:
        """Where points (L, 3) are along the sides of the plate, wherever the joints are, shape (L, 3)."""
        local, far = apply(self._at.rotation.T, point - self._at.translation), self._sways(point, swing)
        return Interval(local.lo - far, local.hi + far)

    def _sways(self, point: Interval, swing: Swing) -> Array:
        """How far points (L, 3) move along the sides of the plate at most [m], shape (L, 3)."""
        at, none = Placement(HERE.rotation, point), np.zeros(3)
        ways = (np.tile(way, (len(point.lo), 1)) for way in self._ways)
        return np.stack([swing.along(way, at, none) for way in ways], axis=1) + ROUNDING

    def _between(self, below: Interval, above: Interval) -> NDArray[np.bool_]:
        """Whether what lies between ends that are so far along its sides crosses a plane of it within it."""
        n, half = self._side, self._half - ROUNDING
        # At an equal part of what both may sway.
        low, high = ((each.hi[:, n] - each.lo[:, n]) / 2 for each in (below, above))
        level = (below.middle[:, n] * high + above.middle[:, n] * low) / (low + high)
        level = np.clip(level, -half[n], half[n])
        crosses = (below.hi[:, n] + APART < level) & (level + APART < above.lo[:, n]) & (half[n] > 0)
        one, other = below[crosses], above[crosses]
        level = level[crosses, None]
        first = (level - one.hi[:, [n]]) / (other.hi[:, [n]] - one.hi[:, [n]])
        last = (level - one.lo[:, [n]]) / (other.lo[:, [n]] - one.lo[:, [n]])
        least = np.minimum(*((1 - s) * one.lo + s * other.lo for s in (first, last)))
        most = np.maximum(*((1 - s) * one.hi + s * other.hi for s in (first, last)))
        inside = (least > ROUNDING - half) & (most < half - ROUNDING)
        inside[:, n] = True
        crosses[crosses] = inside.all(axis=1)
        return crosses


def _inside(at: Placement, own: Array, ends: Array) -> NDArray[np.bool_]:
    """Whether both ends (2, L, 3) of chords are in cores, and so what is between them, shape (L,)."""
    back = at.rotation.T
    each = [apply(back, exact(one) - at.translation).magnitude().hi for one in ends]
    return np.all(np.maximum(*each) <= own - ROUNDING, axis=1)
