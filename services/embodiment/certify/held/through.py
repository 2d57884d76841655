"""How deep a finger may be in its handle: never as deep as halfway through.

Where finger and handle are thin, they are nowhere as deep in each other as is tolerated: the finger would
pass wholly through a part of the handle, and hold it by what is behind.
"""

from functools import lru_cache

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np

from services.embodiment.certify.sweep.depth import deepest
from services.physics.geometry.depth import faces
from services.physics.geometry.pieces import components

SURE = 2e-4  # [m] less than halfway: depths are more precise than that


def most_depth(finger: coal.CollisionGeometry, handle: coal.CollisionGeometry, tolerated: float) -> float:
    """How deep a convex shape of a finger may be in a shape of the handle [m].

    It is halfway through where it is as deep as the largest balls in both have radii together.
    """
    return max(0.0, min(tolerated, ball(finger, tolerated) + ball(handle, tolerated) - SURE))


@lru_cache(maxsize=512)
def ball(shape: coal.CollisionGeometry, enough: float) -> float:
    """Radius of the largest ball in a shape [m], or one that is `enough`; in the thinnest part of a mesh.

    0 in a part that is not convex: what is halfway through that is as deep in it as in its surface alone.
    """
    if isinstance(shape, coal.BVHModelBase):
        parts = [part.shape for part in components(shape)]
        return min(0.0 if isinstance(one, coal.BVHModelBase) else ball(one, enough) for one in parts)
    if isinstance(shape, coal.Box):
        return float(shape.halfSide.min())
    if isinstance(shape, coal.Sphere | coal.Capsule):
        return float(shape.radius)
    if isinstance(shape, coal.Cylinder):
        return float(min(shape.radius, shape.halfLength))
    around, middle = faces(shape), np.array(shape.points()).mean(axis=0)
    amid = float((around.offsets - around.normals @ middle).min())
    return amid if amid >= enough else deepest(around, around)
