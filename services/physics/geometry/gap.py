"""How far two shapes are apart, or how deep in each other, where what coal tells of that is not right."""

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
from numpy.typing import NDArray

from services.physics.geometry.depth import surface_depth

Array = NDArray[np.float64]


def gap(
    one: coal.CollisionGeometry,
    one_at: coal.Transform3s,
    other: coal.CollisionGeometry,
    other_at: coal.Transform3s,
) -> tuple[float, Array]:
    """Distance of two shapes [m], negative where they penetrate, and from one to the other its direction.

    Of two meshes that touch it says no more than that.
    """
    # Request and result of its own for each call: a cached guess gives wrong answers.
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    distance = float(coal.distance(one, one_at, other, other_at, request, result))
    if distance <= 0:
        if isinstance(other, coal.BVHModelBase) or isinstance(one, coal.Sphere):
            one, one_at, other, other_at = other, other_at, one, one_at
        distance = min(0.0, _within(one, other, one_at.inverse() * other_at, distance))
    return distance, result.normal


def _within(
    one: coal.CollisionGeometry, other: coal.CollisionGeometry, at: coal.Transform3s, told: float
) -> float:
    """What is told of shapes that touch, or what is right in its place; `other` is at one_T_other."""
    if isinstance(one, coal.BVHModelBase) and not isinstance(other, coal.BVHModelBase):
        # Coal tells how deep that of the triangles is which it finds first.
        return -surface_depth(one, other, at.getRotation(), at.getTranslation())
    if isinstance(one, coal.Cylinder) and isinstance(other, coal.Sphere):
        return beyond_cylinder(one, at.getTranslation()) - other.radius
    return told


def beyond_cylinder(cylinder: coal.Cylinder, point: Array) -> float:
    """How far a point of its frame is from a cylinder's surface [m], negative inside.

    Of a ball whose middle is in a cylinder coal tells as much too deep.
    """
    off = np.array((np.hypot(point[0], point[1]) - cylinder.radius, abs(point[2]) - cylinder.halfLength))
    return float(np.linalg.norm(np.maximum(off, 0.0))) + min(0.0, float(off.max()))
