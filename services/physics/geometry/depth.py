"""How deep points are in a convex body: it is bounded by faces, and the nearest of their planes says so."""

from dataclasses import dataclass, replace
from functools import lru_cache

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
from numpy.typing import NDArray

from services.physics.geometry.deepest import WAITING, deepest_point
from services.physics.geometry.inside import is_closed, within
from services.physics.geometry.shapes import Triangles, corners, hull_of_solid

Array = NDArray[np.float64]

SIDES = 64  # of the prism about a cylinder: its edges stand out by 0.12 % of the radius
DIRECTIONS = 100  # of the polyhedron about what is round
FINE = 1e-5  # [m] precision of how deep triangles are
FINE_SKIN = 1e-4  # [m] precision of how deep a body's surface is in a mesh
SKIN = 1e-5  # [m] by which a triangle is taken smaller that is to meet none of a mesh: less than `FINE_SKIN`
THIN = 1e-9  # [m] radius of what stands for a point or a line
POINT, STILL, ORIGIN = coal.Sphere(THIN), np.eye(3), np.zeros(3)
GOLDEN = np.pi * (3 - np.sqrt(5))


@dataclass(frozen=True, slots=True, eq=False)
class Faces:
    """A polyhedron about a convex shape: a point x inside has n·x ≤ d.

    Attributes:
        normals: Outward unit normals, shape (F, 3).
        offsets: d, shape (F,) [m].
        core: Ends of the segment about which a ball or a capsule is round, shape (2, 3) [m]; else None.
        radius: Of what is round [m].
    """

    normals: Array
    offsets: Array
    core: Array | None = None
    radius: float = 0.0

    def beyond(self, point: Array) -> tuple[float, Array]:
        """How far a point is from the surface of what is round [m], negative inside; and where to.

        Both of the point of the core that is nearest.
        """
        assert self.core is not None, "only what is round has a core"
        start, way = self.core[0], self.core[1] - self.core[0]
        length = float(way @ way)
        part = float(np.clip((point - start) @ way / length, 0, 1)) if length > 0 else 0.0
        off = point - start - part * way
        return float(np.linalg.norm(off)) - self.radius, off

    def cut(self, direction: Array) -> "Faces":
        """The same with one more face, which touches what is round in this direction."""
        assert self.core is not None, "only what is round is cut"
        normal = direction / np.linalg.norm(direction)
        offset = self.radius + float((self.core @ normal).max())
        return replace(
            self, normals=np.vstack((self.normals, normal)), offsets=np.append(self.offsets, offset)
        )


@lru_cache(maxsize=512)
def faces(shape: coal.CollisionGeometry) -> Faces:
    """A polyhedron about a convex shape, in its own frame; kept, so not to be changed."""
    if isinstance(shape, coal.Box):
        return Faces(np.vstack((np.eye(3), -np.eye(3))), np.tile(shape.halfSide, 2))
    if isinstance(shape, coal.Cylinder):
        ends = np.array(((0.0, 0.0, 1.0), (0.0, 0.0, -1.0)))
        offsets = np.concatenate((np.full(SIDES, shape.radius), np.full(2, shape.halfLength)))
        return Faces(np.vstack((_around(), ends)), offsets)
    if isinstance(shape, coal.Sphere):
        return _round(0.0, shape.radius)
    if isinstance(shape, coal.Capsule):
        return _round(shape.halfLength, shape.radius)
    assert isinstance(shape, coal.Convex), f"{type(shape)} has no inside"
    # A hull that was kept has its points alone: qhull tells the faces.
    whole = shape if shape.num_normals_and_offsets else hull_of_solid(np.array(shape.points()))
    return Faces(np.array(whole.normals()), -np.array(whole.offsets()).ravel())


def _round(half_length: float, radius: float) -> Faces:
    normals = np.vstack((_directions(), _around()))
    core = np.array(((0.0, 0.0, -half_length), (0.0, 0.0, half_length)))
    return Faces(normals, radius + half_length * np.abs(normals[:, 2]), core, radius)


def _around() -> Array:
    """Directions around z, shape (SIDES, 3)."""
    angle = 2 * np.pi * np.arange(SIDES) / SIDES
    return np.column_stack((np.cos(angle), np.sin(angle), np.zeros(SIDES)))


def _directions() -> Array:
    """Directions that are spread evenly over the sphere, shape (DIRECTIONS, 3)."""
    k = np.arange(DIRECTIONS) + 0.5
    z, turn = 1 - 2 * k / DIRECTIONS, GOLDEN * k
    flat = np.sqrt(1 - z**2)
    return np.column_stack((flat * np.cos(turn), flat * np.sin(turn), z))


def skin_depth(mesh: coal.BVHModelBase, triangles: Array) -> float:
    """How deep the deepest point of triangles (M, 3, 3) of a mesh's frame is inside it [m]; else 0.

    It is too large by `FINE_SKIN` at most. What is in the mesh is no deeper than its corners are off that
    triangle of the mesh which is nearest to its middle: how far a triangle is off is convex. What may be
    deeper is cut, where that triangle ends: so of what lies flat on the mesh little is left. Of a closed one,
    what has its middle outside and meets no triangle is outside.
    """
    box, found, closed = mesh.aabb_local, 0.0, is_closed(mesh)
    while len(triangles):
        near = (triangles.min(axis=1) < box.max_) & (triangles.max(axis=1) > box.min_)
        left: list[Array] = []
        for part in triangles[near.all(axis=1)]:
            middle = part.mean(axis=0)
            reach = float(np.linalg.norm(part - middle, axis=1).max())
            off, nearest = _off(mesh, POINT, STILL, middle)
            if off + reach <= found + FINE_SKIN:
                continue
            if within(mesh, middle):
                found = max(found, off)
            elif reach - off <= found + FINE_SKIN or (closed and _is_clear(mesh, part, SKIN / reach)):
                continue
            if _off_triangle(mesh, nearest, part) > found + FINE_SKIN:
                left += _cut(part, _corners(mesh, nearest), found + FINE_SKIN)
        triangles = np.array(left)
    return found + FINE_SKIN if found > 0 else 0.0


def _is_clear(mesh: coal.BVHModelBase, corners: Array, less: float) -> bool:
    """Whether a triangle (3, 3) meets none of a mesh, smaller by a share of what it is."""
    smaller = corners + (corners.mean(axis=0) - corners) * less
    return _off(mesh, _alone(smaller), STILL, ORIGIN)[0] > THIN


def _off_triangle(mesh: coal.BVHModelBase, number: int, points: Array) -> float:
    """How far the farthest of some points (K, 3) is from one triangle of a mesh [m]."""
    return max(_off(_triangle(mesh, number), POINT, STILL, point)[0] for point in points)


@lru_cache(maxsize=4096)
def _triangle(mesh: coal.BVHModelBase, number: int) -> coal.BVHModelBase:
    """One triangle of a mesh; kept, so not to be changed."""
    return _alone(_corners(mesh, number))


def _alone(corners: Array) -> coal.BVHModelBase:
    """One triangle (3, 3)."""
    return Triangles(corners, np.array([[0, 1, 2]]))


def _corners(mesh: coal.BVHModelBase, number: int) -> Array:
    """Of one triangle of a mesh, shape (3, 3) [m]."""
    vertices, indices = mesh.vertices(), mesh.tri_indices(number)
    return np.array([vertices[indices[k]] for k in range(3)])


def _cut(triangle: Array, other: Array, flat: float) -> list[Array]:
    """A triangle (3, 3) in parts: cut where another one ends, if it lies so flat on it [m], or in halves."""
    normal = np.cross(other[1] - other[0], other[2] - other[0])
    if np.abs((triangle - other[0]) @ normal).max() <= flat * np.linalg.norm(normal):
        sides = np.cross(normal, other[[1, 2, 0]] - other)
        for corner, across in zip(other, sides, strict=True):
            beyond = (triangle - corner) @ across
            least = SKIN * np.linalg.norm(across)
            if beyond.min() < -least and beyond.max() > least:
                return [*_kept(triangle, beyond), *_kept(triangle, -beyond)]
    return _halves(triangle)


def _kept(triangle: Array, beyond: Array) -> list[Array]:
    """What of a triangle (3, 3) is beyond a plane, by how far its corners are, in any unit; as triangles."""
    around: list[Array] = []
    for k in range(3):
        here, there = beyond[k], beyond[(k + 1) % 3]
        if here >= 0:
            around.append(triangle[k])
        if here * there < 0:
            around.append(triangle[k] + (triangle[(k + 1) % 3] - triangle[k]) * (here / (here - there)))
    return [np.array((around[0], around[k], around[k + 1])) for k in range(1, len(around) - 1)]


def _halves(triangle: Array) -> list[Array]:
    """A triangle (3, 3), cut across its longest edge."""
    longest = int(np.argmax(np.linalg.norm(triangle[[1, 2, 0]] - triangle, axis=1)))
    a, b, c = triangle[[longest, longest - 2, longest - 1]]
    middle = (a + b) / 2
    return [np.array((a, middle, c)), np.array((middle, b, c))]


def _off(
    body: coal.CollisionGeometry, shape: coal.CollisionGeometry, rotation: Array, origin: Array
) -> tuple[float, int]:
    """How far a shape without volume is from a body, in whose frame its pose is [m]; 0 where they touch.

    Of a mesh, too, the number of its triangle that is nearest.
    """
    request, result, at = coal.DistanceRequest(), coal.DistanceResult(), coal.Transform3s(rotation, origin)
    distance = float(coal.distance(body, coal.Transform3s(), shape, at, request, result))
    return max(0.0, distance), int(result.b1)


def placed(one: Faces, rotation: Array, origin: Array) -> Faces:
    """The same polyhedron at world_T_shape."""
    normals = one.normals @ rotation.T
    core = None if one.core is None else one.core @ rotation.T + origin
    return Faces(normals, one.offsets + normals @ origin, core, one.radius)


def surface_depth(
    mesh: coal.BVHModelBase, shape: coal.CollisionGeometry, rotation: Array, origin: Array
) -> float:
    """Depth of the deepest point of a mesh's triangles in a convex shape [m]; 0 outside.

    It is too large by `FINE` at most. What coal tells of the two is how deep that of the triangles is which
    it finds first.

    Args:
        mesh: Its triangles.
        shape: A cylinder is taken as a prism about it.
        rotation: Of the shape in the mesh's frame, shape (3, 3).
        origin: Of the shape there [m], shape (3,).
    """
    if isinstance(shape, coal.Sphere | coal.Capsule):
        half = 0.0 if isinstance(shape, coal.Sphere) else shape.halfLength
        return max(0.0, shape.radius - _off(mesh, coal.Capsule(THIN, 2 * half), rotation, origin)[0])
    body, room = placed(faces(shape), rotation, origin), np.empty((WAITING, 3, 3))
    triangles = np.ascontiguousarray(corners(mesh))
    found = deepest_point(triangles, body.normals, body.offsets, FINE, room)
    return found + FINE if found > 0 else 0.0
