"""Shapes whose depth in each other means something: primitives, and the convex components of meshes."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache, partial
from itertools import product

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
from numpy.typing import NDArray

from sdt_kg.mechanism import Geometry, ShapeType
from services.kernel import kernel
from services.physics.geometry.deepest import WAITING, deepest_point
from services.physics.geometry.shapes import (
    PADDING,
    Triangles,
    corners,
    faces_of,
    hull_of_solid,
    surface,
    with_volume,
)

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

SAME_POINT = 6
"""[1] Decimals of a metre to which vertices are one: files repeat a vertex for each of its faces."""

CONVEX_SHARE = 0.02
"""[1] By how much of its hull a component's volume may fall short to count as convex: chamfers do."""

MOST_DENT = 0.01
"""[m] How deep a dent in it may be then, as deep as parts may be in each other: what is drawn into a slot of
a wall is not in the wall. The fronts of the kitchens' sources have grooves of 9 mm."""

FINE_DENT = 1e-4  # [m] precision of how deep it is

AROUND = 32
"""[1] Points about what is round that stand for it where it is cut."""


@dataclass(frozen=True, eq=False)
class Piece:
    """A shape that is made when it is first asked for: most of a kitchen's are far from all that moves.

    Attributes:
        low, high: Corners of its own box, in the geometry's frame [m], shape (3,).
        make: What it is.
    """

    low: Array
    high: Array
    make: Callable[[], coal.CollisionGeometry]

    @cached_property
    def shape(self) -> coal.CollisionGeometry:
        """Itself."""
        return self.make()

    @cached_property
    def thickness(self) -> float:
        """Least extent [m]: of a hull between a face and what is farthest from it, else that of its box.

        A plate may lie anyhow in the file of its mesh, so that a box about it there is no measure of it.
        """
        shape = self.shape
        if not isinstance(shape, coal.Convex):
            return float((self.high - self.low).min())
        return float(np.ptp(self.corners @ np.array(shape.normals()).T, axis=0).min())

    @cached_property
    def corners(self) -> Array:
        """Points whose hull is the shape, shape (K, 3) [m]; none of what is round or triangles."""
        return outline(self.shape) if isinstance(self.shape, coal.ConvexBase | coal.Box) else np.empty((0, 3))


def pieces(geometry: Geometry) -> tuple[Piece, ...]:
    """A primitive as it is, but no thinner than what is flat; of a mesh its `components`.

    How deep something is in what is thinner is less than depths are precise. Triangles have no inside: how
    deep something is in them is too little, never too much.
    """
    if geometry.shape is not ShapeType.MESH:
        (shape,) = surface(replace(geometry, size=tuple(max(each, 2 * PADDING) for each in geometry.size)))
        box = shape.aabb_local
        return (Piece(box.min_.copy(), box.max_.copy(), lambda: shape),)
    (shape,) = surface(geometry)
    return components(shape)


@lru_cache(maxsize=1024)
def components(mesh: coal.BVHModelBase) -> tuple[Piece, ...]:
    """Of a mesh each convex component as its hull, the others as triangles; kept, so not to be changed."""
    points, faces = faces_of(mesh)
    index = same_points(points)[1][faces]
    label = joined(index, int(index.max()) + 1)[index[:, 0]]
    return tuple(_piece(points, faces[label == each]) for each in np.unique(label))


def same_points(points: Array) -> tuple[Array, Indices]:
    """Points that differ, shape (K, 3), as rounded, and for each of N points which it is, shape (N,)."""
    rounded = np.round(points, SAME_POINT)
    order = np.lexsort(rounded.T[::-1])  # np.unique sorts rows as structures: ten times slower
    ordered = rounded[order]
    first = np.ones(len(order), dtype=bool)
    first[1:] = (np.diff(ordered, axis=0) != 0).any(axis=1)
    index = np.empty(len(order), np.intp)
    index[order] = np.cumsum(first) - 1
    return ordered[first], index


def joined(links: Indices, count: int) -> Indices:
    """The least of all that each of `count` is joined to, shape (count,), rows of `links` joining theirs."""
    label = np.arange(count)
    _join(np.ascontiguousarray(links), label)
    return label


@kernel(makes=False)
def _join(links: Indices, label: Indices) -> None:
    """Union-find by least number: what a label leads to, step by step, joins the same."""
    rows, columns = links.shape
    for i in range(rows):
        for k in range(1, columns):
            one, other = links[i, 0], links[i, k]
            while label[one] != one:
                label[one] = label[label[one]]
                one = label[one]
            while label[other] != other:
                label[other] = label[label[other]]
                other = label[other]
            label[max(one, other)] = min(one, other)
    for i in range(len(label)):
        label[i] = label[label[i]]


def bent(triangles: Array) -> Piece:
    """Triangles as such, shape (M, 3, 3) [m]."""
    return Piece(triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1)), partial(_triangles, triangles))


def beyond(piece: Piece, way: Array, least: float) -> Piece | None:
    """The part of a piece that is farther along a direction than that [m]; None if there is none.

    Of what is round, that of points on its surface: it falls short by at most 1 % of the radius.
    """
    middle, reach = way @ (piece.low + piece.high) / 2, np.abs(way) @ (piece.high - piece.low) / 2
    if middle - reach > least:
        return piece
    if middle + reach <= least:
        return None
    shape = piece.shape
    if isinstance(shape, coal.BVHModelBase):
        triangles = corners(shape)
        triangles = _clipped(triangles, triangles @ way - least)
        return bent(triangles) if len(triangles) else None
    points = piece.corners if len(piece.corners) else outline(shape)
    along = points @ way - least
    if (along > 0).all():
        return piece
    if not (along > 0).any():
        return None
    ends, begins = points[along > 0][:, None], points[along <= 0][None]
    share = along[along > 0][:, None] / (along[along > 0][:, None] - along[along <= 0])
    cut = (ends + share[:, :, None] * (begins - ends)).reshape(-1, 3)
    kept = with_volume(np.vstack((points[along > 0], cut)))
    return Piece(kept.min(axis=0), kept.max(axis=0), partial(hull_of_solid, kept))


def outline(shape: coal.CollisionGeometry) -> Array:
    """Points of a convex shape's surface, shape (K, 3), whose hull it is; of what is round nearly [m]."""
    if isinstance(shape, coal.ConvexBase):
        return np.array(shape.points())
    if isinstance(shape, coal.Box):
        return np.array(list(product((-1.0, 1.0), repeat=3))) * shape.halfSide
    turn = np.linspace(0.0, 2 * np.pi, AROUND, endpoint=False)
    ring = np.stack((np.cos(turn), np.sin(turn), np.zeros(AROUND)), axis=1)
    rise = np.linspace(-np.pi / 2, np.pi / 2, AROUND // 2 + 1)
    ball = np.vstack(
        [np.append(np.cos(each) * ring[:, :2], np.full((AROUND, 1), np.sin(each)), 1) for each in rise]
    )
    half = 0.0 if isinstance(shape, coal.Sphere) else shape.halfLength
    about = shape.radius * (ring if isinstance(shape, coal.Cylinder) else ball)
    return np.vstack([about + end for end in np.outer((-half, half), (0.0, 0.0, 1.0))])


@lru_cache(maxsize=512)
def skin(shape: coal.CollisionGeometry) -> Array:
    """Triangles of a convex shape's surface, that of its `outline`, shape (M, 3, 3) [m]; kept."""
    from scipy.spatial import ConvexHull  # noqa: PLC0415 - slow to import, and few need it

    points = outline(shape)
    return points[ConvexHull(points).simplices]


def _clipped(triangles: Array, along: Array) -> Array:
    """The parts of triangles, shape (M, 3, 3), where what their corners have `along`, (M, 3), is above 0."""
    above = along > 0
    parts = [triangles[above.all(axis=1)]]
    for count in (1, 2):
        some = above.sum(axis=1) == count
        # From the corner on, that is on its side of the plane alone.
        order = (np.argmax(above[some] == (count == 1), axis=1)[:, None] + np.arange(3)) % 3
        at = np.take_along_axis(along[some], order, 1)
        a, b, c = np.moveaxis(np.take_along_axis(triangles[some], order[:, :, None], 1), 1, 0)
        ab, ac = (a + (at[:, 0] / (at[:, 0] - at[:, k]))[:, None] * (to - a) for k, to in ((1, b), (2, c)))
        cut = [(a, ab, ac)] if count == 1 else [(ab, b, c), (ab, c, ac)]
        parts += [np.stack(each, axis=1) for each in cut]
    return np.concatenate(parts)


def _piece(points: Array, faces: Indices) -> Piece:
    """One component, of some faces."""
    own = points[np.unique(faces)]
    solid = with_volume(own, PADDING)
    flat = len(solid) > len(own)
    return Piece(solid.min(axis=0), solid.max(axis=0), partial(_shape, points[faces], solid, flat))


def _shape(triangles: Array, solid: Array, flat: bool) -> coal.CollisionGeometry:
    """A component's hull, of its corners with volume, if it is convex or flat; else its triangles."""
    whole = hull_of_solid(solid)
    if flat:
        return whole
    filled = whole.computeVolume()
    volume = abs(float(np.linalg.det(triangles - triangles.mean(axis=(0, 1))).sum())) / 6
    full = abs(volume - filled) <= CONVEX_SHARE * filled
    return whole if full and _dent(triangles, whole) <= MOST_DENT else _triangles(triangles)


def _dent(triangles: Array, whole: coal.Convex) -> float:
    """How deep the deepest point of a component's triangles is in its hull [m], to `FINE_DENT`."""
    normals, offsets = np.array(whole.normals()), -np.array(whole.offsets()).ravel()
    room = np.empty((WAITING, 3, 3))
    return deepest_point(np.ascontiguousarray(triangles), normals, offsets, FINE_DENT, room)


def _triangles(triangles: Array) -> coal.BVHModelBase:
    points = np.ascontiguousarray(triangles.reshape(-1, 3))
    return Triangles(points, np.arange(len(points)).reshape(-1, 3))
