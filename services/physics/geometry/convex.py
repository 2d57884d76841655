"""Compiled distances between convex shapes, as an interval that is right whatever the iteration did.

Gilbert, Johnson and Keerthi (1988): the nearest point of the difference of two shapes to the origin
is approached over simplices of its points. Every direction on the way gives a lower bound (the shapes
lie on two sides of a slab), every point an upper one; both hold even where the iteration stops early.
Balls and capsules are a point and a segment with a radius.
"""

import math

from services.kernel import subkernel
from services.physics.geometry.fans import cone

BOX, BALL, CYLINDER, CAPSULE, HULL, MESH = 0, 1, 2, 3, 4, 5
"""What a shape is; only a MESH is not convex."""

ITERATIONS = 48
EXACT = 1e-9  # [m] between the bounds of a distance that counts as known
GOOD = 0.8  # [1] share of the upper bound from which a lower bound that is high enough is not raised
ROOM = 52
"""Length of the array that `bounds` and `packed.bounds_of` write to: of rows of four."""
FLAT = 1e-14  # [1] relative volume or area under which a simplex says nothing


@subkernel(inline=True)
def support(shapes, k, r, c, x, y, z):
    """Point of shape k, its radius left out, that is farthest along (x, y, z) in the world."""
    kind, size, _, first, last, vertices, fan, starts = shapes
    a = r[0, 0] * x + r[1, 0] * y + r[2, 0] * z
    b = r[0, 1] * x + r[1, 1] * y + r[2, 1] * z
    d = r[0, 2] * x + r[1, 2] * y + r[2, 2] * z
    what = kind[k]
    if what == CYLINDER:
        level = math.sqrt(a * a + b * b)
        u, v = (a / level * size[k, 0], b / level * size[k, 0]) if level > 0.0 else (0.0, 0.0)
        w = size[k, 2] if d > 0.0 else -size[k, 2]
    elif what == HULL:
        begin, end = first[k], last[k]
        if fan[k] >= 0:
            n = cone(a, b, d)
            begin, end = starts[fan[k], n], starts[fan[k], n + 1]
        best, at = -math.inf, begin
        for i in range(begin, end):
            along = vertices[i, 0] * a + vertices[i, 1] * b + vertices[i, 2] * d
            if along > best:
                best, at = along, i
        u, v, w = vertices[at, 0], vertices[at, 1], vertices[at, 2]
    elif what == BALL:
        u, v, w = 0.0, 0.0, 0.0
    else:
        u = size[k, 0] if a > 0.0 else -size[k, 0]
        v = size[k, 1] if b > 0.0 else -size[k, 1]
        w = size[k, 2] if d > 0.0 else -size[k, 2]
    return (
        c[0] + r[0, 0] * u + r[0, 1] * v + r[0, 2] * w,
        c[1] + r[1, 0] * u + r[1, 1] * v + r[1, 2] * w,
        c[2] + r[2, 0] * u + r[2, 1] * v + r[2, 2] * w,
    )


@subkernel
def _dot(w, i, j):
    """Product of corners i and j; of w each corner has four numbers, of which the first three count."""
    i, j = 4 * i, 4 * j
    return w[i] * w[j] + w[i + 1] * w[j + 1] + w[i + 2] * w[j + 2]


@subkernel
def _combined(w, share, v):
    """v is the point with these shares of the four corners; its squared length."""
    total = share[0] + share[1] + share[2] + share[3]
    for k in range(3):
        v[k] = (share[0] * w[k] + share[1] * w[4 + k] + share[2] * w[8 + k] + share[3] * w[12 + k]) / total
    return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]


@subkernel
def _shared(share, a, b, c, d):
    """The shares are these four."""
    share[0], share[1], share[2], share[3] = a, b, c, d


@subkernel
def _on_segment(w, i, j, share):
    """Shares of corners i, j in the point of their segment nearest to the origin."""
    here, both = _dot(w, i, i), _dot(w, i, j)
    along, length = here - both, here - 2 * both + _dot(w, j, j)
    t = min(max(along / length, 0.0), 1.0) if length > 0.0 else 0.0
    _shared(share, 0.0, 0.0, 0.0, 0.0)
    share[i], share[j] = 1.0 - t, t


@subkernel
def _on_triangle(w, i, j, k, share, v, other):
    """Shares of corners i, j, k in the point of their triangle nearest to the origin."""
    aa, ab, ac, bb, bc, cc = (
        _dot(w, i, i),
        _dot(w, i, j),
        _dot(w, i, k),
        _dot(w, j, j),
        _dot(w, j, k),
        _dot(w, k, k),
    )
    d1, d2, d3, d4, d5, d6 = aa - ab, aa - ac, ab - bb, ab - bc, ac - bc, ac - cc
    a, b, c = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    scale = max(aa, bb, cc)
    if a > 0.0 and b > 0.0 and c > 0.0 and a + b + c > FLAT * scale * scale:
        _shared(share, 0.0, 0.0, 0.0, 0.0)
        share[i], share[j], share[k] = a, b, c
        return
    best = math.inf
    for n in range(3):
        one, two = (i, j) if n == 0 else ((j, k) if n == 1 else (i, k))
        _on_segment(w, one, two, other)
        at = _combined(w, other, v)
        if at < best:
            best = at
            _shared(share, other[0], other[1], other[2], other[3])


@subkernel
def _outside(w, i, j, k, m):
    """Whether the origin is not strictly on corner m's side of the plane through the others."""
    i, j, k, m = 4 * i, 4 * j, 4 * k, 4 * m
    x, y, z = w[i], w[i + 1], w[i + 2]
    ax, ay, az = w[j] - x, w[j + 1] - y, w[j + 2] - z
    bx, by, bz = w[k] - x, w[k + 1] - y, w[k + 2] - z
    nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    here = -(nx * x + ny * y + nz * z)
    there = nx * (w[m] - x) + ny * (w[m + 1] - y) + nz * (w[m + 2] - z)
    farther = max(x * x + y * y + z * z, w[m] * w[m] + w[m + 1] * w[m + 1] + w[m + 2] * w[m + 2], 1e-300)
    size = math.sqrt((nx * nx + ny * ny + nz * nz) * farther)
    return here * there <= 0.0 or abs(there) < 1e-12 * size


@subkernel
def nearest(w, count, share, v, spare, other):
    """(corners left, squared length) of the simplex' point nearest to the origin, which is in v.

    The corners that carry it come first; 0 corners: the origin is inside.
    """
    if count == 1:
        v[0], v[1], v[2] = w[0], w[1], w[2]
        return 1, _dot(w, 0, 0)
    if count == 2:
        _on_segment(w, 0, 1, share)
    elif count == 3:
        _on_triangle(w, 0, 1, 2, share, v, other)
    else:
        best = math.inf
        for m in range(4):
            i, j, k = (1 if m == 0 else 0), (2 if m <= 1 else 1), (3 if m <= 2 else 2)
            if not _outside(w, i, j, k, m):
                continue
            _on_triangle(w, i, j, k, spare, v, other)
            at = _combined(w, spare, v)
            if at < best:
                best = at
                _shared(share, spare[0], spare[1], spare[2], spare[3])
        if best == math.inf:
            return 0, 0.0
    squared = _combined(w, share, v)
    left = 0
    for i in range(count):
        if share[i] > 0.0:
            for k in range(3):
                w[4 * left + k] = w[4 * i + k]
            left += 1
    return left, squared


@subkernel
def parted(shapes, a, b, ra, ca, rb, cb):
    """The signed distance of two shapes is not below this: the widest gap of their own boxes [m].

    Gaps are those along the six axes of the boxes. Of shapes that are far apart it says so much sooner
    than `bounds`; the arguments are the same.
    """
    x, y, z = cb[0] - ca[0], cb[1] - ca[1], cb[2] - ca[2]
    size, around, widest = shapes[1], shapes[2][a] + shapes[2][b], -math.inf
    for i in range(3):
        here = abs(ra[0, i] * x + ra[1, i] * y + ra[2, i] * z) - size[a, i]
        there = abs(rb[0, i] * x + rb[1, i] * y + rb[2, i] * z) - size[b, i]
        for k in range(3):
            here -= abs(ra[0, i] * rb[0, k] + ra[1, i] * rb[1, k] + ra[2, i] * rb[2, k]) * size[b, k]
            there -= abs(rb[0, i] * ra[0, k] + rb[1, i] * ra[1, k] + rb[2, i] * ra[2, k]) * size[a, k]
        widest = max(widest, here, there)
    return widest - around


@subkernel
def bounds(shapes, a, b, ra, ca, rb, cb, free, hit, work):
    """(low, high): the signed distance of two shapes is not below low and not above high [m].

    `shapes` is what `packed.pack` gives, a and b say which; (ra, ca), (rb, cb) are world poses of the middles
    of their own boxes. The search ends when low > free, when high <= hit, or when both agree to EXACT.
    Where the shapes without their radii touch, low is −inf: their depth is not looked for. `work` is
    room, of length ROOM; its 4th, 8th and 12th are the direction from b to a along which low was found.
    """
    w, v, share, spare, other = work[:16], work[16:20], work[20:24], work[24:28], work[28:32]
    around = shapes[2][a] + shapes[2][b]
    x, y, z = ca[0] - cb[0], ca[1] - cb[1], ca[2] - cb[2]
    if x * x + y * y + z * z == 0.0:
        x = 1.0
    low, high, count = -math.inf, math.inf, 0
    for _ in range(ITERATIONS):
        length = math.sqrt(x * x + y * y + z * z)
        px, py, pz = support(shapes, a, ra, ca, -x, -y, -z)
        qx, qy, qz = support(shapes, b, rb, cb, x, y, z)
        px, py, pz = px - qx, py - qy, pz - qz
        here = (x * px + y * py + z * pz) / length - around
        if here > low:
            low, w[3], w[7], w[11] = here, x, y, z
        if high - low <= EXACT or (low > free and low >= GOOD * high):
            break
        w[4 * count], w[4 * count + 1], w[4 * count + 2] = px, py, pz
        count, squared = nearest(w, count + 1, share, v, spare, other)
        if count == 0 or squared <= EXACT * EXACT:
            return -math.inf, -around
        at = math.sqrt(squared) - around
        if at >= high:  # rounding: no nearer point is found
            break
        high = at
        if high <= hit:
            break
        x, y, z = v[0], v[1], v[2]
    return low, high
