"""How far points of a chain of joints move for a unit of each joint: upper bounds."""

import numpy as np
from numpy.typing import NDArray

from services.embodiment.proof_check.geometry.interval import Interval, cross
from services.embodiment.proof_check.geometry.mechanics import Link

Array = NDArray[np.float64]


def levers(origins: Interval, axes: Interval, k: int, links: tuple[Link, ...]) -> Array:
    """How far origin k moves at most for a unit of each joint up to it, shape (L, k + 1): upper bounds."""
    arm = cross(origins[:, k, None] - origins[:, : k + 1], axes[:, : k + 1]).norm().hi
    slides = np.array([not link.turns for link in links[: k + 1]])
    return np.where(slides, 1.0, arm)


def lever_of(origins: Interval, axes: Interval, point: Interval, links: tuple[Link, ...]) -> Array:
    """How far a point (1, 3) moves at most for a unit of each joint, shape (n,)."""
    if not links:
        return np.zeros(0)
    ends = Interval(
        np.concatenate((origins.lo, point.lo[:, None]), axis=1),
        np.concatenate((origins.hi, point.hi[:, None]), axis=1),
    )
    whole = Interval(
        np.concatenate((axes.lo, np.zeros((1, 1, 3))), axis=1),
        np.concatenate((axes.hi, np.zeros((1, 1, 3))), axis=1),
    )
    return levers(ends, whole, len(links), (*links, links[-1]))[0, :-1]
