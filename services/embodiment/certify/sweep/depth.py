"""How deep one body is in another: the deepest point of either inside the other.

This is what is reported of a collision. It is no more than the shift that would part the two shapes,
which says little of a rod through a board, and it changes no faster than the bodies move.
"""

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.spatial import ConvexHull

Array = NDArray[np.float64]
Faces = tuple[Array, Array]
"""Outward unit normals, shape (F, 3), and offsets, shape (F,): a point x inside has n·x ≤ d."""

SIDES = 64  # of the prism about a cylinder: its edges stand out by 0.12 % of the radius
DIRECTIONS = 400  # of the polyhedron about a sphere: its corners stand out by less than 1 % of the radius
GOLDEN = np.pi * (3 - np.sqrt(5))


def faces(shape: coal.CollisionGeometry) -> Faces | None:
    """A polyhedron about a convex shape, in its own frame; None for a shape that is not convex."""
    if isinstance(shape, coal.Box):
        return _of_normals(np.vstack((np.eye(3), -np.eye(3))), np.tile(shape.halfSide, 2))
    if isinstance(shape, coal.Cylinder):
        angle = 2 * np.pi * np.arange(SIDES) / SIDES
        around = np.column_stack((np.cos(angle), np.sin(angle), np.zeros(SIDES)))
        ends = np.array(((0.0, 0.0, 1.0), (0.0, 0.0, -1.0)))
        offsets = np.concatenate((np.full(SIDES, shape.radius), np.full(2, shape.halfLength)))
        return np.vstack((around, ends)), offsets
    if isinstance(shape, coal.Sphere):
        return _of_normals(_directions(), np.full(DIRECTIONS, shape.radius))
    if isinstance(shape, coal.Capsule):
        normals = _directions()
        return normals, shape.radius + shape.halfLength * np.abs(normals[:, 2])
    if isinstance(shape, coal.ConvexBase):
        equations = ConvexHull(np.array(shape.points())).equations
        return equations[:, :3], -equations[:, 3]
    return None


def _of_normals(normals: Array, offsets: Array) -> Faces:
    return normals, np.asarray(offsets, dtype=np.float64)


def _directions() -> Array:
    """Directions that are spread evenly over the sphere, shape (DIRECTIONS, 3)."""
    k = np.arange(DIRECTIONS) + 0.5
    z, turn = 1 - 2 * k / DIRECTIONS, GOLDEN * k
    flat = np.sqrt(1 - z**2)
    return np.column_stack((flat * np.cos(turn), flat * np.sin(turn), z))


def placed(one: Faces, rotation: Array, origin: Array) -> Faces:
    """The same polyhedron at world_T_shape."""
    normals = one[0] @ rotation.T
    return normals, one[1] + normals @ origin


def deepest(one: Faces, other: Faces) -> float:
    """Depth of the deepest point of either polyhedron inside the other [m]; 0 if they are apart."""
    return max(_inside(one, other), _inside(other, one), 0.0)


def _inside(points: Faces, body: Faces) -> float:
    """Largest r over points x of one polyhedron with n·x + r ≤ d for all faces of the other."""
    (own, own_offset), (normals, offset) = points, body
    rows = np.vstack((np.hstack((normals, np.ones((len(normals), 1)))), np.pad(own, ((0, 0), (0, 1)))))
    found = linprog(
        (0.0, 0.0, 0.0, -1.0), A_ub=rows, b_ub=np.concatenate((offset, own_offset)), bounds=(None, None)
    )
    return float(found.x[3]) if found.status == 0 else 0.0
