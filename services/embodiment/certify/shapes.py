"""The scene's collision shapes, placed by the certifier's own kinematics."""

from collections.abc import Sequence

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
from numpy.typing import NDArray

from services.embodiment.certify.kinematics import Kinematics, Placed
from services.physics.model import Scene

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


class Shapes:
    """All collision shapes of a scene.

    Attributes:
        carrier: Carrier of each shape, shape (S,).
        radius: Of the sphere about each shape's centre that contains it, shape (S,) [m].
    """

    def __init__(self, scene: Scene, kinematics: Kinematics) -> None:
        self._shapes = [one.shape for one in scene.solids]
        joints = np.array([one.joint for one in scene.solids], dtype=np.intp)
        own = np.array([one.joint_T_shape.homogeneous for one in scene.solids]).reshape(-1, 4, 4)
        boxes = [one.shape.aabb_local for one in scene.solids]
        middle = np.array([(box.min_ + box.max_) / 2 for box in boxes]).reshape(-1, 3)
        self._half = np.array([(box.max_ - box.min_) / 2 for box in boxes]).reshape(-1, 3)
        carrier_T_shape = kinematics.fixed[joints] @ own
        self._rotation, self._origin = carrier_T_shape[:, :3, :3], carrier_T_shape[:, :3, 3]
        self._centre = self._origin + (self._rotation @ middle[:, :, None])[:, :, 0]
        self.carrier = kinematics.carrier[joints]
        self.radius = np.linalg.norm(self._half, axis=1)
        # One request for all would do no harm as long as nothing is cached in it (FACTS: GJK's
        # cached guess makes answers depend on history); the result is cleared at each call.
        self._request, self._result = coal.DistanceRequest(), coal.DistanceResult()

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
        rotations, origins = [], []
        for side in (0, 1):
            shape = pairs[:, side]
            rotation = placed.rotation[span, self.carrier[shape]]
            origin = placed.origin[span, self.carrier[shape]]
            rotations.append(rotation @ self._rotation[shape])
            origins.append(origin + (rotation @ self._origin[shape][:, :, None])[:, :, 0])
        return np.array([self._distance(*item) for item in zip(pairs, *rotations, *origins, strict=True)])

    def _distance(self, pair: Sequence[int], *frames: Array) -> float:
        one_R, other_R, one_p, other_p = frames
        self._result.clear()
        return coal.distance(
            self._shapes[pair[0]],
            coal.Transform3s(one_R, one_p),
            self._shapes[pair[1]],
            coal.Transform3s(other_R, other_p),
            self._request,
            self._result,
        )

    def nearest_points(self, placed: Placed, pair: tuple[int, int]) -> tuple[float, Array, Array]:
        """Signed distance of two shapes at the first configuration, and the points that have it."""
        span = np.zeros(1, dtype=np.intp)
        distance = self.distances(placed, span, np.array([pair]))[0]
        one, other = self._result.getNearestPoint1(), self._result.getNearestPoint2()
        return float(distance), np.array(one), np.array(other)
