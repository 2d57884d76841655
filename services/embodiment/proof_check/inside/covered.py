"""Whether a box lies in several convex shapes together: what one leaves over has to lie in the others.

What a face of a shape cuts off is a polytope again, known by its corners and by the faces on which each of
them lies: two corners that share two faces are the ends of an edge. In floats; what sticks out by less than
`STICKS_OUT` counts as inside, which is far more than rounding.

Certification takes a robot's mesh in few pieces, or in more where those of two links would touch when it is
parked (`services.physics.model`). Few fill hollows that more leave open, so a box has to lie in both.
"""

from functools import lru_cache

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
from numpy.typing import NDArray

from sdt_kg.mechanism import Geometry, ShapeType
from services.embodiment.proof_check.geometry.shapes import SIGNS
from services.physics.geometry.hulls import COARSE, FINE, Fineness
from services.physics.geometry.shapes import solids

Array = NDArray[np.float64]
Faces = tuple[Array, Array]
"""Of a convex shape: outward normals (F, 3) of length 1, and how far each face is along its own (F,) [m]."""

STICKS_OUT = 1e-4  # [m] of a box out of the shapes that contain its body: rounding of an annotation
ROUNDING = 1e-9  # [m]
SIDES = 48  # of the prism inside a cylinder that stands for it where a box is not in it alone
BOTH_WAYS = np.vstack((np.eye(3), -np.eye(3)))


@lru_cache(maxsize=1024)
def is_covered(box: Geometry, shapes: tuple[Geometry, ...]) -> bool:
    """Whether a box lies in the shapes, or hulls of parts of a mesh: in one of them, or in all together."""
    return all(_is_in_pieces(box, shapes, fineness) for fineness in (COARSE, FINE))


def sticks_out(box: Geometry, shapes: tuple[Geometry, ...]) -> float:
    """How far a box that is covered may stick out of the shapes [m]: hardly where one box has all of it."""
    corners = corners_of(box)
    for one in shapes:
        if one.shape is ShapeType.BOX:
            matrix = one.pose.matrix()
            seen = (corners - matrix[:3, 3]) @ matrix[:3, :3]
            if (np.abs(seen) <= np.array(one.size) / 2 + ROUNDING).all():
                return ROUNDING
    return STICKS_OUT


def corners_of(box: Geometry) -> Array:
    """Corners in the frame of the body, shape (8, 3) [m]."""
    matrix = box.pose.matrix()
    return (SIGNS * np.array(box.size) / 2) @ matrix[:3, :3].T + matrix[:3, 3]


def _is_in_pieces(box: Geometry, shapes: tuple[Geometry, ...], fineness: Fineness) -> bool:
    """The same, of meshes that are cut into pieces so finely."""
    corners = corners_of(box)
    parts = [(_at(one), part) for one in shapes for part in solids(one, fineness)]
    if any(all(_meets(at, part, corner) for corner in corners) for at, part in parts):
        return True
    faces = [_faces(at, part) for at, part in parts]
    return _is_left_to(corners, np.hstack((SIGNS > 0, SIGNS < 0)), [one for one in faces if one is not None])


def _is_left_to(corners: Array, on: NDArray[np.bool_], parts: list[Faces]) -> bool:
    """Whether a polytope lies in these parts.

    Args:
        corners: Shape (K, 3) [m].
        on: Which of them lies on which of its faces, shape (K, F).
        parts: What is left to hold it.
    """
    for n, (normals, offsets) in enumerate(parts):
        out = corners @ normals.T - offsets
        if (out > -ROUNDING).all(axis=0).any():  # beyond a face
            continue
        for k in np.flatnonzero((out > ROUNDING).any(axis=0)):
            out = corners @ normals[k] - offsets[k]
            if not (out > ROUNDING).any():
                continue
            if not _is_left_to(*_cut(corners, on, out), parts[n + 1 :]):
                return False
            corners, on = _cut(corners, on, -out)
        return True
    return False


def _cut(corners: Array, on: NDArray[np.bool_], out: Array) -> tuple[Array, NDArray[np.bool_]]:
    """The part of a polytope where what its corners have in `out`, shape (K,), is above 0."""
    kept, left = np.flatnonzero(out > ROUNDING), np.flatnonzero(out <= ROUNDING)
    one, other = np.nonzero((on[kept][:, None] & on[left]).sum(axis=2) >= 2)
    one, other = kept[one], left[other]
    share = (out[one] / (out[one] - np.minimum(out[other], 0.0)))[:, None]
    cut = corners[one] + share * (corners[other] - corners[one])
    faces = np.vstack((on[kept], on[one] & on[other]))
    return np.vstack((corners[kept], cut)), np.column_stack((faces, np.arange(len(faces)) >= len(kept)))


def _faces(at: coal.Transform3s, part: coal.CollisionGeometry) -> Faces | None:
    """Those of a part, moved out by `STICKS_OUT`; of a cylinder those of a prism in it, None of a ball."""
    if isinstance(part, coal.Box):
        normals, offsets = BOTH_WAYS, np.tile(part.halfSide, 2) + STICKS_OUT
    elif isinstance(part, coal.ConvexBase):
        points = np.array(part.points())
        normals = _normals(points, part)
        offsets = (points @ normals.T).max(axis=0) + STICKS_OUT
    elif isinstance(part, coal.Cylinder | coal.Capsule):
        turn = 2 * np.pi * np.arange(SIDES) / SIDES
        normals = np.vstack((np.stack((np.cos(turn), np.sin(turn), 0 * turn), axis=1), BOTH_WAYS[[2, 5]]))
        across = (part.radius + STICKS_OUT) * np.cos(np.pi / SIDES)
        offsets = np.append(np.full(SIDES, across), np.full(2, part.halfLength + STICKS_OUT))
    else:
        return None
    normals = normals @ at.getRotation().T
    return normals, offsets + normals @ at.getTranslation()


def _normals(points: Array, part: coal.ConvexBase) -> Array:
    """Outward ones of a hull's faces, shape (F, 3)."""
    faces = [part.polygons(k) for k in range(part.num_polygons)]
    a, b, c = (points[[face[k] for face in faces]] for k in range(3))
    crossed = np.cross(b - a, c - a)
    size = np.linalg.norm(crossed, axis=1)
    some = size > 0  # what has no area bounds nothing that its neighbours do not
    side = np.sign(((a - points.mean(axis=0)) * crossed).sum(axis=1))
    outward: Array = crossed[some] * (side / np.where(some, size, 1.0))[some, None]
    return outward


def _meets(at: coal.Transform3s, part: coal.CollisionGeometry, point: Array) -> bool:
    ball, here = coal.Sphere(STICKS_OUT), coal.Transform3s(np.eye(3), point)
    return bool(coal.collide(ball, here, part, at, coal.CollisionRequest(), coal.CollisionResult()))


def _at(geometry: Geometry) -> coal.Transform3s:
    matrix = geometry.pose.matrix()
    return coal.Transform3s(matrix[:3, :3], matrix[:3, 3])
