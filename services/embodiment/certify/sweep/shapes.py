"""The scene's collision shapes, placed by the certifier's own kinematics."""

from collections.abc import Callable, Sequence

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
from numpy.typing import NDArray

from services.embodiment.certify.sweep.depth import deepest
from services.embodiment.certify.sweep.kinematics import Kinematics, Placed
from services.physics.geometry.depth import faces, skin_depth, surface_depth
from services.physics.geometry.depth import placed as placed_faces
from services.physics.geometry.gap import beyond_cylinder, gap
from services.physics.geometry.pieces import Piece, components, skin
from services.physics.model import Scene

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

_First = tuple["Placed | None", dict[int, tuple[Array, Array]]]

Depth = Callable[[Piece, coal.CollisionGeometry, Array, Array], float]
"""Of a body in a part of a mesh, in whose frame the body's rotation (3, 3) and origin (3,) [m] are."""

STILL = np.zeros(3)
SPHERE, CYLINDER = 1, 2
_KINDS = {coal.Sphere: SPHERE, coal.Cylinder: CYLINDER}


class Shapes:
    """All collision shapes of a scene.

    Attributes:
        carrier: Carrier of each shape, shape (S,).
        radius: Of the sphere about each shape's centre that contains it, shape (S,) [m].
        placing, convex: What compiled loops take.
    """

    def __init__(self, scene: Scene, kinematics: Kinematics) -> None:
        self._shapes, outlines = [one.shape for one in scene.solids], scene.outlines
        joints, middle, self._half = outlines.joint, outlines.middle, outlines.half
        self.convex = outlines.convex
        carrier_T_shape = kinematics.fixed[joints] @ outlines.joint_T_shape
        self._rotation = np.ascontiguousarray(carrier_T_shape[:, :3, :3])
        self._origin = np.ascontiguousarray(carrier_T_shape[:, :3, 3])
        self._centre = self._origin + (self._rotation @ middle[:, :, None])[:, :, 0]
        self._joint, self._parents = joints, scene.model.parents
        self.carrier = kinematics.carrier[joints]
        self.radius = np.linalg.norm(self._half, axis=1)
        self.placing = (self.carrier, self._rotation, self._centre, self._half, self.radius)
        self._is_mesh = [isinstance(one.shape, coal.BVHModelBase) for one in scene.solids]
        self._kind = [_KINDS.get(type(one.shape), 0) for one in scene.solids]
        # One request for all would do no harm as long as nothing is cached in it (FACTS: GJK's
        # cached guess makes answers depend on history); the result is cleared at each call.
        self._request, self._result = coal.DistanceRequest(), coal.DistanceResult()
        self._first: _First = (None, {})

    def path(self, shape: int) -> list[int]:
        """The joints that move a shape, from the root on, also those that stand still all along."""
        joint, path = int(self._joint[shape]), list[int]()
        while joint > 0:
            path.append(joint)
            joint = int(self._parents[joint])
        return path[::-1]

    def centres(self, placed: Placed, span: Indices, shape: Indices) -> Array:
        """Centres in the world of one shape at one configuration for each item, shape (M, 3) [m]."""
        carrier = self.carrier[shape]
        turned = placed.rotation[span, carrier] @ self._centre[shape][:, :, None]
        return turned[:, :, 0] + placed.origin[span, carrier]

    def extents(self, placed: Placed, span: Indices, shape: Indices) -> Array:
        """Half extents of their boxes along the world's axes, shape (M, 3) [m]."""
        rotation = placed.rotation[span, self.carrier[shape]] @ self._rotation[shape]
        return (np.abs(rotation) @ self._half[shape][:, :, None])[:, :, 0]

    def distances(self, placed: Placed, span: Indices, pairs: Indices) -> Array:
        """Signed distances of pairs of shapes, shape (M, 2): negative is depth, shape (M,) [m]."""
        one, other = self.frames(placed, span, pairs[:, 0]), self.frames(placed, span, pairs[:, 1])
        return np.array([self._distance(*item) for item in zip(pairs.tolist(), *one, *other, strict=True)])

    def depth(self, placed: Placed, span: int, pair: tuple[int, int]) -> float:
        """Depth of the deepest point of either shape inside the other [m]; of meshes see `_in_mesh`."""
        at, frames = np.array([span]), list[Array]()
        for shape in pair:
            rotation, origin = self.frames(placed, at, np.array([shape]))
            frames += (rotation[0], origin[0])
        if any(self._is_mesh[shape] for shape in pair):
            return self._in_mesh(pair, _deepest, *frames)
        one, other = (faces(self._shapes[shape]) for shape in pair)
        return deepest(placed_faces(one, frames[0], frames[1]), placed_faces(other, frames[2], frames[3]))

    def nearest_points(
        self, placed: Placed, pair: tuple[int, int], shift: Array = STILL
    ) -> tuple[float, Array, Array]:
        """Signed distance of two shapes at the first configuration, and the points that have it.

        The first shape is moved by `shift` in the world.
        """
        distance = self._coal(pair, *self._pair(placed, pair, shift))
        return distance, np.array(self._result.getNearestPoint1()), np.array(self._result.getNearestPoint2())

    def _pair(self, placed: Placed, pair: tuple[int, int], shift: Array) -> tuple[Array, ...]:
        """Rotation and origin of both shapes at the first configuration, the first one moved."""
        (one_R, one_p), (other_R, other_p) = (self._at_first(placed, shape) for shape in pair)
        return one_R, one_p + shift, other_R, other_p

    def _at_first(self, placed: Placed, shape: int) -> tuple[Array, Array]:
        """Rotation and origin of a shape at the first configuration; kept until others are asked about."""
        if self._first[0] is not placed:
            self._first = placed, {}
        known = self._first[1]
        if shape not in known:
            rotation, origin = self.frames(placed, np.zeros(1, dtype=np.intp), np.array([shape]))
            known[shape] = rotation[0], origin[0]
        return known[shape]

    def middles(self, placed: Placed, shape: Indices) -> tuple[Array, Array]:
        """Rotations and middles of shapes' boxes at the first configuration, shapes (M, 3, 3) and (M, 3)."""
        first = np.zeros_like(shape)
        return self.frames(placed, first, shape)[0], self.centres(placed, first, shape)

    def frames(self, placed: Placed, span: Indices, shape: Indices) -> tuple[Array, Array]:
        """Rotations and origins of shapes in the world, shapes (M, 3, 3) and (M, 3)."""
        rotation = placed.rotation[span, self.carrier[shape]]
        origin = placed.origin[span, self.carrier[shape]]
        shifted = origin + (rotation @ self._origin[shape][:, :, None])[:, :, 0]
        return rotation @ self._rotation[shape], shifted

    def _distance(self, pair: Sequence[int], *frames: Array) -> float:
        if {self._kind[pair[0]], self._kind[pair[1]]} == {SPHERE, CYLINDER}:
            return self._ball_and_cylinder(pair, *frames)
        distance = self._coal(pair, *frames)
        if distance > 0 or not (self._is_mesh[pair[0]] or self._is_mesh[pair[1]]):
            return distance
        # Coal tells of a mesh how deep that of its triangles is which it finds first.
        return -self._in_mesh(pair, _way, *frames)

    def _in_mesh(self, pair: Sequence[int], deep: Depth, *frames: Array) -> float:
        """How deep a convex shape is in a mesh, or the mesh in it [m]; 0 or less where they are apart.

        It is as deep as in the deepest of the mesh's parts: in a convex one as in any solid, in another as
        its surface is in the shape, or the shape's in it.
        """
        first = self._is_mesh[pair[0]]
        mesh, convex = pair if first else pair[::-1]
        turn, at, own_R, own_p = frames if first else (*frames[2:], *frames[:2])
        body, box = self._shapes[convex], self._shapes[convex].aabb_local
        mesh_R, mesh_p = turn.T @ own_R, turn.T @ (own_p - at)
        middle = mesh_p + mesh_R @ (box.min_ + box.max_) / 2
        half, found = np.abs(mesh_R) @ (box.max_ - box.min_) / 2, 0.0
        for part in components(self._shapes[mesh]):
            if (part.low < middle + half).all() and (part.high > middle - half).all():
                found = max(found, deep(part, body, mesh_R, mesh_p))
        return found

    def _coal(self, pair: Sequence[int], *frames: Array) -> float:
        one_R, one_p, other_R, other_p = frames
        self._result.clear()
        one_T, other_T = coal.Transform3s(one_R, one_p), coal.Transform3s(other_R, other_p)
        one, other = self._shapes[pair[0]], self._shapes[pair[1]]
        return float(coal.distance(one, one_T, other, other_T, self._request, self._result))

    def _ball_and_cylinder(self, pair: Sequence[int], *frames: Array) -> float:
        one_R, one_p, other_R, other_p = frames
        first = self._kind[pair[0]] == SPHERE
        ball, cylinder = (self._shapes[i] for i in (pair if first else pair[::-1]))
        middle = (other_R if first else one_R).T @ (other_p - one_p)
        return beyond_cylinder(cylinder, middle) - ball.radius


def _way(part: Piece, body: coal.CollisionGeometry, rotation: Array, origin: Array) -> float:
    """The way that would part them [m]."""
    if isinstance(part.shape, coal.BVHModelBase):
        return _in_bent(part.shape, body, rotation, origin)
    distance, _ = gap(part.shape, coal.Transform3s(), body, coal.Transform3s(rotation, origin))
    return -distance


def _deepest(part: Piece, body: coal.CollisionGeometry, rotation: Array, origin: Array) -> float:
    """Depth of the deepest point of either inside the other [m]."""
    if isinstance(part.shape, coal.BVHModelBase):
        return _in_bent(part.shape, body, rotation, origin)
    return deepest(faces(part.shape), placed_faces(faces(body), rotation, origin))


def _in_bent(part: coal.BVHModelBase, body: coal.CollisionGeometry, rotation: Array, origin: Array) -> float:
    """The same of a part that is not convex, for points of both surfaces."""
    in_part = skin_depth(part, skin(body) @ rotation.T + origin)
    return max(surface_depth(part, body, rotation, origin), in_part)
