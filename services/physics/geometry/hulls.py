"""Convex pieces that together contain a mesh's surface: one hull fills what is hollow or bent.

A piece is split by a plane across its longest gain until nothing much is gained. Which plane is a
guess from a few of the points; that the hulls contain every triangle is not, since triangles are
cut at the plane.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LEAST_VOLUME = 2e-6  # [m³] pieces below this (12 mm cubed) are not split
CUTS = (0.25, 0.5, 0.75)  # of a piece's extent along each axis
SAMPLE = 100  # triangles from which volumes are guessed


@dataclass(frozen=True, slots=True)
class Fineness:
    """How far to go; more pieces make every distance check of the robot slower.

    Attributes:
        least_gain: Part of a piece's volume which a split has to save.
        most_pieces: Of one mesh.
    """

    least_gain: float
    most_pieces: int


COARSE = Fineness(0.25, 4)
FINE = Fineness(0.04, 24)  # opens the gaps of 10 to 30 mm between neighbouring links that COARSE fills


def convex_pieces(triangles: Array, fineness: Fineness) -> list[Array]:
    """Points of each piece, shape (K, 3): their convex hulls together contain the triangles.

    Args:
        triangles: Corners, shape (M, 3, 3) [m].
        fineness: How far to go.
    """
    pieces, done = [(_volume(_some(triangles)), triangles)], list[Array]()
    while pieces:
        volume, piece = pieces.pop(0)
        halves = None
        if len(pieces) + len(done) + 1 < fineness.most_pieces:
            halves = _split(piece, volume, fineness.least_gain)
        if halves is None:
            done.append(piece)
        else:
            pieces.extend((_volume(_some(half)), half) for half in halves)
            pieces.sort(key=lambda each: -each[0])
    return [piece.reshape(-1, 3) for piece in done]


def _some(triangles: Array) -> Array:
    return triangles[:: max(1, len(triangles) // SAMPLE)]


def _split(triangles: Array, volume: float, least_gain: float) -> tuple[Array, Array] | None:
    """Both halves, if their hulls are that much smaller than that of all, whose volume is given [m³]."""
    if volume < LEAST_VOLUME:
        return None
    some = _some(triangles)
    low, high = some.min(axis=(0, 1)), some.max(axis=(0, 1))
    planes = [(axis, low[axis] + cut * (high[axis] - low[axis])) for axis in range(3) for cut in CUTS]
    both = [sum(_volume(half) for half in _halves(some, *plane)) for plane in planes]
    best = int(np.argmin(both))
    halves = _halves(triangles, *planes[best])
    split = both[best] < (1 - least_gain) * volume and min(len(half) for half in halves) > 0
    return halves if split else None


def _halves(triangles: Array, axis: int, at: float) -> tuple[Array, Array]:
    return _below(triangles, axis, at), _below(triangles * _mirror(axis), axis, -at) * _mirror(axis)


def _mirror(axis: int) -> Array:
    signs = np.ones(3)
    signs[axis] = -1
    return signs


def _below(triangles: Array, axis: int, at: float) -> Array:
    """What of the triangles lies where the coordinate is at most `at`, as triangles again."""
    inside = triangles[:, :, axis] <= at
    count = inside.sum(axis=1)
    kept = [triangles[count == 3]]
    for several in (False, True):  # one corner inside leaves a triangle, two leave a quadrangle
        chosen = count == (2 if several else 1)
        odd = np.argmax(inside[chosen] != several, axis=1)
        a, b, c = (triangles[chosen][np.arange(len(odd)), (odd + k) % 3] for k in range(3))
        ab, ac = _cross_at(a, b, axis, at), _cross_at(a, c, axis, at)
        if several:
            kept += [np.stack((b, c, ac), axis=1), np.stack((b, ac, ab), axis=1)]
        else:
            kept.append(np.stack((a, ab, ac), axis=1))
    return np.concatenate(kept)


def _cross_at(one: Array, other: Array, axis: int, at: float) -> Array:
    """Points where the edges meet the plane, shape (M, 3)."""
    part = (at - one[:, axis]) / (other[:, axis] - one[:, axis])
    return one + part[:, None] * (other - one)


def _volume(triangles: Array) -> float:
    """Volume of the hull; nothing for what is flat or empty."""
    from scipy.spatial import ConvexHull, QhullError  # noqa: PLC0415 - slow to import, and pieces are kept

    try:
        return float(ConvexHull(triangles.reshape(-1, 3)).volume)
    except (QhullError, ValueError):
        return 0.0
