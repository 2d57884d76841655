"""Compiled signed distance of two convex shapes, with the points and the direction in which it is found.

Apart, it is what Gilbert, Johnson and Keerthi's simplex comes to; in each other, the polytope about the
origin grows until the face that is nearest to it is one of the shapes' difference (van den Bergen 2001). A
descent is led by it; that a posture is free is said by `World`.
"""

import math

import numpy as np

from services.kernel import kernel, subkernel
from services.physics.geometry.convex import HULL, MESH, nearest, parted, support

ITERATIONS = 48
EXACT = 1e-9  # [m] under which cores touch
FINE = 1e-9  # [m] by which a polytope's nearest face may be too near
CORNERS = 48  # of a polytope
FACES = 2 * CORNERS + 64  # of it, with those that were given up
EDGES = 3 * CORNERS


def room() -> tuple:
    """What `signed` writes to: a simplex, a polytope's corners and faces, a hole's edges, one answer."""
    simplex = np.zeros(16), np.zeros(4), np.zeros(4), np.zeros(4), np.zeros(4), np.zeros((4, 3))
    corners = np.zeros((CORNERS, 3)), np.zeros((CORNERS, 3))
    faces = np.zeros((FACES, 3), np.int64), np.zeros((FACES, 3)), np.zeros(FACES), np.zeros(FACES, np.bool_)
    return simplex, corners, faces, np.zeros((EDGES, 2), np.int64), np.zeros(9)


@subkernel
def _difference(shapes, a, b, ra, ca, rb, cb, x, y, z, at, on):
    """The farthest point along (x, y, z) of shape a less shape b is in `at`, and of shape a in `on`."""
    on[0], on[1], on[2] = support(shapes, a, ra, ca, x, y, z)
    px, py, pz = support(shapes, b, rb, cb, -x, -y, -z)
    at[0], at[1], at[2] = on[0] - px, on[1] - py, on[2] - pz


@subkernel
def _convex(shapes, a, b, ra, ca, rb, cb, out, room):
    """What `signed` says of two convex shapes."""
    w, v, share, spare, other, ends = room[0]
    x, y, z = ca[0] - cb[0], ca[1] - cb[1], ca[2] - cb[2]
    if x * x + y * y + z * z == 0.0:
        x = 1.0
    count, squared = 0, math.inf
    for _ in range(ITERATIONS):
        at = w[4 * count : 4 * count + 3]
        _difference(shapes, a, b, ra, ca, rb, cb, -x, -y, -z, at, ends[count])
        if count > 0 and squared - (x * at[0] + y * at[1] + z * at[2]) <= EXACT * math.sqrt(squared):
            break
        share[0], share[1], share[2], share[3] = 1.0, 0.0, 0.0, 0.0
        had = count + 1
        count, now = nearest(w, had, share, v, spare, other)
        if count == 0:
            return _inside(shapes, a, b, ra, ca, rb, cb, out, room)
        left, total = 0, 0.0
        for i in range(had):
            if share[i] > 0.0:
                total += share[i]
                other[left] = share[i]
                for k in range(3):
                    ends[left, k] = ends[i, k]
                left += 1
        for k in range(3):
            out[3 + k] = 0.0
            for i in range(left):
                out[3 + k] += other[i] / total * ends[i, k]
        if now > EXACT * EXACT:
            x, y, z = v[0], v[1], v[2]
        if now <= EXACT * EXACT or now >= squared or count == 4:
            squared = min(now, squared)
            break
        squared = now
    apart, length = math.sqrt(squared), math.sqrt(x * x + y * y + z * z)
    out[0], out[1], out[2] = x / length, y / length, z / length
    for k in range(3):
        out[6 + k] = out[3 + k] - apart * out[k]
    return apart - shapes[2][a] - shapes[2][b]


@subkernel
def _face(n, i, j, k, points, faces):
    """Face n has these corners, seen from outside in turn; how far its plane is from the origin."""
    corner, normal, far, alive = faces
    corner[n, 0], corner[n, 1], corner[n, 2], alive[n] = i, j, k, True
    ax, ay, az = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1], points[j, 2] - points[i, 2]
    bx, by, bz = points[k, 0] - points[i, 0], points[k, 1] - points[i, 1], points[k, 2] - points[i, 2]
    x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    length = math.sqrt(x * x + y * y + z * z)
    if length <= 1e-18:
        normal[n, 0] = normal[n, 1] = normal[n, 2] = 0.0
        far[n] = math.inf
        return
    normal[n, 0], normal[n, 1], normal[n, 2] = x / length, y / length, z / length
    far[n] = (x * points[i, 0] + y * points[i, 1] + z * points[i, 2]) / length


@subkernel
def _begun(points, faces):
    """The four faces of the corners' tetrahedron, about the origin."""
    for m in range(4):
        i, j, k = (1 if m == 0 else 0), (2 if m <= 1 else 1), (3 if m <= 2 else 2)
        _face(m, i, j, k, points, faces)
        if faces[2][m] < 0.0:
            _face(m, i, k, j, points, faces)


@subkernel
def _opened(new, points, faces, edges, count):
    """How many edges the hole has that a new corner sees; the faces in it are given up."""
    corner, normal, far, alive = faces
    found = 0
    for n in range(count):
        if not alive[n]:
            continue
        seen = -far[n] if far[n] < math.inf else -math.inf
        for m in range(3):
            seen += normal[n, m] * points[new, m]
        if seen <= 1e-12:
            continue
        alive[n] = False
        for e in range(3):
            i, j, twin = corner[n, e], corner[n, (e + 1) % 3], -1
            for k in range(found):
                if edges[k, 0] == j and edges[k, 1] == i:
                    twin = k
            if twin >= 0:
                found -= 1
                edges[twin, 0], edges[twin, 1] = edges[found, 0], edges[found, 1]
            elif found < edges.shape[0]:
                edges[found, 0], edges[found, 1] = i, j
                found += 1
    return found


@subkernel
def _nearest_face(faces, count):
    """The face whose plane is nearest to the origin."""
    best = 0
    least = math.inf
    for n in range(count):
        if faces[3][n] and faces[2][n] < least:
            best, least = n, faces[2][n]
    return best


@subkernel
def _inside(shapes, a, b, ra, ca, rb, cb, out, room):
    """The same of shapes whose cores are in each other: the simplex is a tetrahedron about the origin."""
    (w, _, share, _, _, ends), (points, on), faces, edges = room[:4]
    for i in range(4):
        for k in range(3):
            points[i, k], on[i, k] = w[4 * i + k], ends[i, k]
    _begun(points, faces)
    size, count = 4, 4
    best = _nearest_face(faces, count)
    while size < points.shape[0]:
        x, y, z = faces[1][best, 0], faces[1][best, 1], faces[1][best, 2]
        _difference(shapes, a, b, ra, ca, rb, cb, x, y, z, points[size], on[size])
        if x * points[size, 0] + y * points[size, 1] + z * points[size, 2] - faces[2][best] <= FINE:
            break
        found = _opened(size, points, faces, edges, count)
        for e in range(found):
            n = 0
            while n < count and faces[3][n]:
                n += 1
            if n == faces[0].shape[0]:
                break
            count = max(count, n + 1)
            _face(n, edges[e, 0], edges[e, 1], size, points, faces)
        size += 1
        best = _nearest_face(faces, count)
    _shares(points, faces, best, share)
    deep = faces[2][best]
    for k in range(3):
        out[k], out[3 + k] = -faces[1][best, k], 0.0
        for i in range(3):
            out[3 + k] += share[i] * on[faces[0][best, i], k]
        out[6 + k] = out[3 + k] + deep * out[k]
    return -deep - shapes[2][a] - shapes[2][b]


@subkernel
def _shares(points, faces, n, share):
    """Shares of face n's corners in its point nearest to the origin."""
    total = 0.0
    for m in range(3):
        i, j = faces[0][n, (m + 1) % 3], faces[0][n, (m + 2) % 3]
        far, normal = faces[2][n], faces[1][n]
        px, py, pz = (
            points[i, 0] - far * normal[0],
            points[i, 1] - far * normal[1],
            points[i, 2] - far * normal[2],
        )
        qx, qy, qz = (
            points[j, 0] - far * normal[0],
            points[j, 1] - far * normal[1],
            points[j, 2] - far * normal[2],
        )
        x, y, z = py * qz - pz * qy, pz * qx - px * qz, px * qy - py * qx
        share[m] = max(normal[0] * x + normal[1] * y + normal[2] * z, 0.0)
        total += share[m]
    for m in range(3):
        share[m] = share[m] / total if total > 0.0 else 1.0 / 3


@kernel(makes=False, shared=True)
def signed(shapes, a, b, ra, ca, rb, cb, most, out, room):
    """Signed distance of two shapes [m], b a mesh or convex; infinite where it is seen to be above `most`.

    In `out` (12,) are the direction from b to a, and the points of a and b that are nearest, or deepest,
    their radii left out. Of a mesh it is that of its triangle which is nearest, or deepest.
    """
    if shapes[0][b] != MESH:
        if parted(shapes, a, b, ra, ca, rb, cb) > most:
            return math.inf
        return _convex(shapes, a, b, ra, ca, rb, cb, out, room)
    kind, _, _, first, last, vertices = shapes[:6]
    centre, least, n = out[9:12], math.inf, first[b]
    while n < last[b]:
        leaf = kind[n] == HULL
        middle = last[n] if leaf else first[n]
        for i in range(3):
            centre[i] = cb[i]
            for k in range(3):
                centre[i] += rb[i, k] * vertices[middle, k]
        if parted(shapes, a, n, ra, ca, rb, centre) > min(most, least):
            n = n + 1 if leaf else last[n]
            continue
        n += 1
        if not leaf:
            continue
        found = _convex(shapes, a, n - 1, ra, ca, rb, cb, room[4], room)
        if found < least:
            least = found
            for k in range(9):
                out[k] = room[4][k]
    return least
