"""Shapes as compiled loops take them: convex ones, and meshes as trees of triangles.

A mesh is its surface, as for coal: what lies wholly inside it touches nothing. Its tree is flat, each
node before what is below it: a node whose box is far enough is skipped with all of that.
"""

import math
from collections.abc import Sequence
from functools import lru_cache

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
from numpy.typing import NDArray

from services.kernel import kernel, subkernel
from services.physics.geometry.convex import BALL, BOX, CAPSULE, CYLINDER, HULL, MESH, bounds, support
from services.physics.geometry.fans import CONES, FEW, fanned
from services.physics.geometry.shapes import Hull, corners

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

FANS_KEPT = 512
"""[1] Hulls whose fans are kept: those of some robots."""

MESHES_KEPT = 512
"""[1] Meshes whose trees are kept: those of some kitchens."""

PARTS_KEPT = 2048
"""[1] Shapes that are kept as numbers: those of both."""

DEEPEST = 64
"""[1] Parts of a mesh that wait while its tree grows; each is less than half of the one before."""


def pack(shapes: Sequence[coal.CollisionGeometry]) -> tuple:
    """What `bounds_of` takes.

    It is (kind, half extents or radius and half length, radius, first, last, vertices, fan, starts).
    Vertices are seen from the middle of a shape's own box, which is where `bounds_of` wants its centre.
    Behind the shapes follow the nodes of meshes, as shapes of their own: a leaf is a triangle, with the
    middle of its box as one vertex more; below any other node lie those up to its `last`. A mesh has its
    nodes from `first` to `last`. Of a shape with a `fan`, which is not below 0, the vertices of each cone lie
    apart, from one of `starts[fan]` to the next.
    """
    parts = [_part(shape) for shape in shapes]
    kind, size, radius = (np.array([part[i] for part in parts], np.float64) for i in range(3))
    kind, size = kind.astype(np.int64), size.reshape(-1, 3)
    first, last = np.zeros(len(shapes), np.int64), np.zeros(len(shapes), np.int64)
    vertices, total = [np.empty((0, 3))], 0
    trees, nodes = list[tuple](), len(shapes)
    fan, starts = np.full(len(shapes), -1, np.int64), list[Indices]()
    for k, (_, _, _, points) in enumerate(parts):
        if kind[k] == HULL:
            first[k], last[k] = total, total + len(points)
            vertices.append(points)
            total += len(points)
            if len(points) > FEW:
                begins, some = _fanned(shapes[k])
                fan[k] = len(starts)
                starts.append(begins + total)
                vertices.append(some)
                total += len(some)
        elif len(points):
            of_node, half, begin, end, some = _grown(shapes[k])
            first[k], last[k] = nodes, nodes + len(of_node)
            vertices.append(some)
            trees.append((of_node, half, begin + total, end + np.where(of_node == HULL, total, nodes)))
            total, nodes = total + len(some), int(last[k])
    whole = zip((kind, size, first, last), *trees, strict=True) if trees else None
    kind, size, first, last = map(np.concatenate, whole) if whole else (kind, size, first, last)
    radius = np.concatenate([radius, np.zeros(len(kind) - len(radius))])
    fan = np.concatenate([fan, np.full(len(kind) - len(fan), -1)])
    begins = np.array(starts, np.int64).reshape(-1, CONES + 1)
    return kind, np.ascontiguousarray(size), radius, first, last, np.concatenate(vertices), fan, begins


@lru_cache(maxsize=FANS_KEPT)
def _fanned(shape: coal.ConvexBase) -> tuple[Indices, Array]:
    """What `fanned` says of a hull, seen from the middle of its box; kept for the next scene."""
    points = _part(shape)[3]
    return (shape.starts, points[shape.rows]) if isinstance(shape, Hull) else fanned(points)


@lru_cache(maxsize=MESHES_KEPT)
def _grown(mesh: coal.BVHModelBase) -> tuple[Indices, Array, Indices, Indices, Array]:
    """The tree of a mesh, seen from the middle of its box; kept for the next scene."""
    return grown(_part(mesh)[3])


@lru_cache(maxsize=PARTS_KEPT)
def _part(shape: coal.CollisionGeometry) -> tuple[int, tuple[float, ...] | Array, float, Array]:
    """Kind, size, radius and vertices, or triangles of a mesh, of one shape."""
    box, nothing = shape.aabb_local, np.empty((0, 3))
    middle, half = (box.min_ + box.max_) / 2, (box.max_ - box.min_) / 2
    match shape:
        case coal.Box():
            return BOX, half, 0.0, nothing
        case coal.Sphere():
            return BALL, np.zeros(3), shape.radius, nothing
        case coal.Cylinder():
            return CYLINDER, (shape.radius, shape.radius, shape.halfLength), 0.0, nothing
        case coal.Capsule():
            return CAPSULE, (0.0, 0.0, shape.halfLength), shape.radius, nothing
        case coal.ConvexBase():
            return HULL, half, 0.0, np.array(shape.points()) - middle
    assert isinstance(shape, coal.BVHModelBase), f"{type(shape)} is made nowhere in `shapes`"
    return MESH, half, 0.0, corners(shape) - middle


def grown(triangles: Array) -> tuple[Indices, Array, Indices, Indices, Array]:
    """(kind, half, first, last, vertices) of a tree's nodes, of triangles of shape (T, 3, 3) [m].

    Nodes and vertices are numbered from 0 on.
    """
    count = len(triangles)
    total = 2 * count - 1
    kind, first, last = np.empty((3, total), np.int64)
    half, points, middle = np.empty((total, 3)), np.empty((total + 3 * count, 3)), np.empty((count, 3))
    room = np.arange(count), middle, np.empty((DEEPEST, 2), np.int64)
    _grow(np.ascontiguousarray(triangles), room, (kind, half, first, last, points))
    return kind, half, first, last, points


@kernel
def _grow(corners, room, tree):
    """The tree is in `tree`; in `room` are its triangles in order, their middles, and ranges that wait."""
    count = corners.shape[0]
    order, middle, ranges = room
    kind, half, first, last, points = tree
    for t in range(count):
        for i in range(3):
            one, two, three = corners[t, 0, i], corners[t, 1, i], corners[t, 2, i]
            middle[t, i] = (min(one, two, three) + max(one, two, three)) / 2
    ranges[0, 0], ranges[0, 1], waiting, n, row = 0, count, 1, 0, 0
    while waiting > 0:
        waiting -= 1
        start, end = ranges[waiting, 0], ranges[waiting, 1]
        first[n], last[n] = row, n + 2 * (end - start) - 1
        kind[n] = HULL if end - start == 1 else MESH
        if end - start == 1:
            for k in range(3):
                for i in range(3):
                    points[row + k, i] = corners[order[start], k, i]
            last[n], row = row + 3, row + 3
        widest = 0
        for i in range(3):
            low, high = math.inf, -math.inf
            for t in range(start, end):
                for k in range(3):
                    at = corners[order[t], k, i]
                    low, high = min(low, at), max(high, at)
            half[n, i], points[row, i] = (high - low) / 2, (high + low) / 2
            if half[n, i] > half[n, widest]:
                widest = i
        row, n = row + 1, n + 1
        if end - start > 1:
            cut = _cut(order, start, end, middle, widest)
            for larger in (True, False):  # the smaller part is the next: few ranges wait
                second = (end - cut > cut - start) == larger
                ranges[waiting, 0], ranges[waiting, 1] = (cut, end) if second else (start, cut)
                waiting += 1


@subkernel
def _cut(order, start, end, middle, axis):
    """Where `order` is cut in two: before it lie the triangles whose middle is below the mean."""
    mean, cut = 0.0, start
    for t in range(start, end):
        mean += middle[order[t], axis] / (end - start)
    for t in range(start, end):
        if middle[order[t], axis] < mean:
            order[t], order[cut] = order[cut], order[t]
            cut += 1
    return cut if start < cut < end else (start + end) // 2


@kernel(makes=False, shared=True)
def bounds_of(shapes, a, b, ra, ca, rb, cb, free, hit, work):
    """What `bounds` says, of two shapes of which one may be a mesh.

    Where both are, low is −inf: nothing is known.
    """
    if shapes[0][a] != MESH and shapes[0][b] != MESH:
        return bounds(shapes, a, b, ra, ca, rb, cb, free, hit, work)
    if shapes[0][a] != MESH:
        return _of_mesh(shapes, b, a, rb, cb, ra, ca, free, hit, work)
    if shapes[0][b] != MESH:
        return _of_mesh(shapes, a, b, ra, ca, rb, cb, free, hit, work)
    return -math.inf, math.inf


@subkernel
def _of_mesh(shapes, m, b, rm, cm, rb, cb, free, hit, work):
    """Bounds of the distance of mesh m and a convex shape: of the least of all triangles' distances."""
    kind, size, radius, first, last, vertices = shapes[:6]
    turn, at, reach = work[32:44], work[44:48], work[48:52]
    for i in range(3):  # shape b as the mesh sees it
        at[i], reach[i] = 0.0, radius[b]
        for k in range(3):
            at[i] += rm[k, i] * (cb[k] - cm[k])
            turn[4 * i + k] = rm[0, i] * rb[0, k] + rm[1, i] * rb[1, k] + rm[2, i] * rb[2, k]
            reach[i] += abs(turn[4 * i + k]) * size[b, k]
    low, high, n, seed = math.inf, math.inf, first[m], -1
    dx, dy, dz, face = 0.0, 0.0, 0.0, 0.0  # beyond this plane of the mesh's frame is no point of b
    if hit == -math.inf:  # the distance itself is asked for: what is near is looked at first
        seed = _near(shapes, m, at, reach)
        low, high = bounds(shapes, seed, b, rm, cm, rb, cb, free, hit, work)
        if low == -math.inf:
            return -math.inf, high
        dx, dy, dz, face = _facing(shapes, b, rm, cm, rb, cb, work)
    while n < last[m]:
        leaf = kind[n] == HULL
        middle = last[n] if leaf else first[n]
        x, y, z = at[0] - vertices[middle, 0], at[1] - vertices[middle, 1], at[2] - vertices[middle, 2]
        u, v, w = (
            abs(x) - size[n, 0] - reach[0],
            abs(y) - size[n, 1] - reach[1],
            abs(z) - size[n, 2] - reach[2],
        )
        gap = math.sqrt(max(u, 0.0) ** 2 + max(v, 0.0) ** 2 + max(w, 0.0) ** 2)
        if gap <= free and gap < high:
            gap = max(gap, _beyond(shapes, n, leaf, middle, dx, dy, dz) - face)
        if gap <= free and gap < high:
            for k in range(3):
                apart = abs(turn[k] * x + turn[4 + k] * y + turn[8 + k] * z) - size[b, k] - radius[b]
                for i in range(3):
                    apart -= abs(turn[4 * i + k]) * size[n, i]
                gap = max(gap, apart)
        if gap > free or gap >= high:
            low = min(low, gap)
            n = n + 1 if leaf else last[n]
            continue
        if leaf and n != seed:
            near, far = bounds(shapes, n, b, rm, cm, rb, cb, min(free, high), hit, work)
            low, high = min(low, near), min(high, far)
            if high <= hit or low == -math.inf:
                return -math.inf, high  # other triangles may be nearer
            dx, dy, dz, face = _facing(shapes, b, rm, cm, rb, cb, work)
        n += 1
    return low, high


@subkernel
def _facing(shapes, b, rm, cm, rb, cb, work):
    """The direction in which `bounds` parted shape b from a triangle, and how far along it b reaches.

    Both are in the frame of the mesh, which is at (rm, cm): of a node that begins farther on, b is free.
    """
    x, y, z = work[3], work[7], work[11]
    length = math.sqrt(x * x + y * y + z * z)
    x, y, z = x / length, y / length, z / length
    u, v, w = support(shapes, b, rb, cb, x, y, z)
    return (
        rm[0, 0] * x + rm[1, 0] * y + rm[2, 0] * z,
        rm[0, 1] * x + rm[1, 1] * y + rm[2, 1] * z,
        rm[0, 2] * x + rm[1, 2] * y + rm[2, 2] * z,
        x * (u - cm[0]) + y * (v - cm[1]) + z * (w - cm[2]) + shapes[2][b],
    )


@subkernel
def _beyond(shapes, n, leaf, middle, x, y, z):
    """How far along (x, y, z) node n of a mesh begins, in the mesh's frame."""
    _, size, _, first, last, vertices = shapes[:6]
    if not leaf:
        here = x * vertices[middle, 0] + y * vertices[middle, 1] + z * vertices[middle, 2]
        return here - abs(x) * size[n, 0] - abs(y) * size[n, 1] - abs(z) * size[n, 2]
    begins = math.inf
    for k in range(first[n], last[n]):
        begins = min(begins, x * vertices[k, 0] + y * vertices[k, 1] + z * vertices[k, 2])
    return begins


@subkernel
def _near(shapes, m, at, reach):
    """A triangle of mesh m near a box about `at` that reaches so far along the mesh's axes."""
    kind, size, _, first, last, vertices = shapes[:6]
    n = first[m]
    while kind[n] != HULL:
        one = n + 1
        other = one + 1 if kind[one] == HULL else last[one]
        n, least = one, math.inf
        for child in (one, other):
            middle, apart = last[child] if kind[child] == HULL else first[child], -math.inf
            for i in range(3):
                apart = max(apart, abs(at[i] - vertices[middle, i]) - size[child, i] - reach[i])
            if apart < least:
                n, least = child, apart
    return n
