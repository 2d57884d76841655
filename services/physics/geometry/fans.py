"""Which vertices of a convex shape may be the farthest along a direction: a few, told by where it points.

Directions are sorted into cones, the squares on the faces of a cube. A direction between the four edges of a
cone is a sum of them, with no negative share: a vertex that another one exceeds, or equals, along all four
is not needed for any direction of the cone. What is left out changes no support, so no distance.
"""

import numpy as np
from numpy.typing import NDArray

from services.kernel import kernel, subkernel

Array = NDArray[np.float64]

EDGE = 5
"""[1] Squares along an edge of the cube."""
CONES = 6 * EDGE * EDGE
FEW = 16
"""[1] Vertices of a shape that are looked at one and all: looking for the cone takes as long."""


@subkernel
def cone(x, y, z):
    """Number of the cone of directions in which (x, y, z) lies."""
    a, b, c = abs(x), abs(y), abs(z)
    face, most, u, v = (0 if x > 0.0 else 1), a, y, z
    if b > a and b >= c:
        face, most, u, v = (2 if y > 0.0 else 3), b, x, z
    elif c > a:
        face, most, u, v = (4 if z > 0.0 else 5), c, x, y
    if most == 0.0:
        return 0
    half = EDGE / 2
    i, j = int((u / most + 1.0) * half), int((v / most + 1.0) * half)
    return (face * EDGE + min(i, EDGE - 1)) * EDGE + min(j, EDGE - 1)


def fanned(points: Array) -> tuple[NDArray[np.int64], Array]:
    """Where the vertices of each cone begin, and where those of the last end; and the vertices (K, 3).

    Args:
        points: Vertices of a convex shape, shape (V, 3) [m].
    """
    starts, rows = cones_of(points)
    return starts, points[rows]


def cones_of(points: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The same with rows of `points` in place of vertices, shape (K,)."""
    starts, rows = np.empty(CONES + 1, np.int64), np.empty(CONES * len(points), np.int64)
    _fan(np.ascontiguousarray(points), np.empty((len(points), 4)), starts, rows)
    return starts, rows[: starts[-1]]


@kernel
def _fan(points, along, starts, rows):
    """Rows of `points` of all cones, one after the other, are in `rows`; `along` is room, shape (V, 4)."""
    count, best = 0, np.zeros(4, np.int64)
    for n in range(6 * EDGE * EDGE):
        starts[n] = first = count
        _edges(n, points, along, best)
        for one in range(points.shape[0]):
            needed = True
            for k in range(4):
                needed = needed and not _exceeds(along, best[k], one)
            if needed:
                rows[count] = one
                count += 1
        kept = first
        for k in range(first, count):
            needed = True
            for m in range(first, count):
                needed = needed and not _exceeds(along, rows[m], rows[k])
            if needed:
                rows[kept], rows[k] = rows[k], rows[kept]
                kept += 1
        count = kept
    starts[6 * EDGE * EDGE] = count


@subkernel
def _edges(n, points, along, best):
    """How far each point is along the four edges of cone n, and which is the farthest along each."""
    face, i, j = n // (EDGE * EDGE), n // EDGE % EDGE, n % EDGE
    sign = 1.0 if face % 2 == 0 else -1.0
    for k in range(4):
        u, v = 2.0 * (i + k // 2) / EDGE - 1.0, 2.0 * (j + k % 2) / EDGE - 1.0
        x, y, z = sign, u, v
        if face // 2 == 1:
            x, y, z = u, sign, v
        elif face // 2 == 2:
            x, y, z = u, v, sign
        best[k] = 0
        for p in range(points.shape[0]):
            along[p, k] = points[p, 0] * x + points[p, 1] * y + points[p, 2] * z
            if along[p, k] > along[best[k], k]:
                best[k] = p


@subkernel
def _exceeds(along, one, other):
    """Whether a point is as far as another along all edges, and farther along one; of equals the first is."""
    farther = one < other
    for k in range(4):
        if along[one, k] < along[other, k]:
            return False
        farther = farther or along[one, k] > along[other, k]
    return farther
