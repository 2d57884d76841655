"""How deep one body is in another: the deepest point of either inside the other, or of a surface in a body.

This is what is reported of a collision. It is no more than the shift that would part the two shapes,
which says little of a rod through a board, and it changes no faster than the bodies move.
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
from numpy.typing import NDArray

from services.physics.geometry.shapes import hull_of_solid

Array = NDArray[np.float64]

SIDES = 64  # of the prism about a cylinder: its edges stand out by 0.12 % of the radius
DIRECTIONS = 100  # of the polyhedron about what is round, before it is cut where the answer lies
CUTS = 30  # such cuts at most; without the last ones a depth is a little too large
EXACT = 1e-4  # [m] what is round is cut until its polyhedron stands out by less
FINE = 1e-5  # [m] precision of how deep triangles are: they are parted where they may be deeper by more
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


def placed(one: Faces, rotation: Array, origin: Array) -> Faces:
    """The same polyhedron at world_T_shape."""
    normals = one.normals @ rotation.T
    core = None if one.core is None else one.core @ rotation.T + origin
    return Faces(normals, one.offsets + normals @ origin, core, one.radius)


def surface_depth(triangles: Array, body: Faces) -> float:
    """Depth of the deepest point of triangles (N, 3, 3) in a body [m], by up to `FINE` too large; 0 outside.

    A point is as deep as the nearest plane of a face is far. For each of these that is linear on a triangle,
    so that the middle is as deep as the least of the corners' means, and no point deeper than the least of
    their largest: what may be deeper than the deepest middle is cut in four.
    """
    found, left = 0.0, triangles
    while len(left):
        deep = body.offsets - left @ body.normals.T
        most = deep.max(axis=1).min(axis=1)
        found = max(found, float(deep.mean(axis=1).min(axis=1).max()))
        left = left[most > found + FINE]
        middles = (left + np.roll(left, -1, axis=1)) / 2
        corners = np.stack((left, middles, np.roll(middles, 1, axis=1)), axis=2)
        left = np.concatenate((corners.reshape(-1, 3, 3), middles))
    return found + FINE if found > 0 else 0.0


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
