"""How deep one body is in another: the deepest point of either inside the other.

This is what is reported of a collision. It is no more than the shift that would part the two shapes,
which says little of a rod through a board, and it changes no faster than the bodies move.
"""

import numpy as np
from numpy.typing import NDArray

from services.physics.geometry.depth import Faces

Array = NDArray[np.float64]

CUTS = 30  # of what is round where the answer lies at most; without the last a depth is a little too large
EXACT = 1e-4  # [m] what is round is cut until its polyhedron stands out by less


def deepest(one: Faces, other: Faces) -> float:
    """Depth of the deepest point of either shape inside the other [m]; 0 if they are apart."""
    return max(_inside(one, other), _inside(other, one), 0.0)


def _inside(points: Faces, body: Faces) -> float:
    """Largest depth in one shape of the points of another; not positive if they are apart.

    What is round is cut where its polyhedron stands out (Kelley, 1960), so that from above the answer
    comes as near as `EXACT`.
    """
    depth = 0.0
    for _ in range(CUTS):
        found = _lp(points, body)
        if found is None:
            return 0.0
        depth, point = float(found[3]), found[:3]
        if depth <= 0:
            return depth
        fits = True
        if points.core is not None and (outside := points.beyond(point))[0] > EXACT:
            points, fits = points.cut(outside[1]), False
        if body.core is not None:
            away, direction = body.beyond(point)
            if depth + away > EXACT and np.linalg.norm(direction) > 0:
                body, fits = body.cut(direction), False
        if fits:
            return depth
    return depth


def _lp(points: Faces, body: Faces) -> Array | None:
    """X and the largest r, shape (4,), with x in one polyhedron and n·x + r ≤ d for faces of the other."""
    from scipy.optimize import linprog  # noqa: PLC0415 - slow to import, and only refusals tell depths

    rows = np.vstack(
        (np.hstack((body.normals, np.ones((len(body.normals), 1)))), np.pad(points.normals, ((0, 0), (0, 1))))
    )
    limits = np.concatenate((body.offsets, points.offsets))
    found = linprog((0.0, 0.0, 0.0, -1.0), A_ub=rows, b_ub=limits, bounds=(None, None))
    return np.asarray(found.x) if found.status == 0 else None
