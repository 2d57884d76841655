"""A finger as its meshes are: what they leave hollow touches nothing.

The sweep takes convex pieces that contain a robot's meshes, which is right for all that must not touch. A
finger has to touch: a piece that fills a hollow of it, or lies across a bend, would do so in its place.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
from numpy.typing import NDArray

from sdt_kg.mechanism import Mechanism, ShapeType
from services.physics.geometry.shapes import surface
from services.physics.tree import se3

Array = NDArray[np.float64]

TOUCH = 1e-5  # [m] what is nearer touches: a mesh's vertices are single numbers mostly
MOST_STEPS = 256  # inward, each as long as the distance; what grazes for longer does not touch

Posed = tuple[coal.CollisionGeometry, Array, Array]
"""A shape, its rotation (3, 3) and origin (3,) [m] in the world."""


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Triangles of a finger's meshes and its other shapes, and the handle's shapes.

    Attributes:
        finger, handle: Where they are.
    """

    finger: Sequence[Posed]
    handle: Sequence[Posed]

    def way(self, inward: Array, first: float, most: float) -> float:
        """How far the finger moves inward until it touches the handle, no less than `first` [m].

        Infinite if that is farther than `most`.
        """
        way = first
        for _ in range(MOST_STEPS):
            if way > most:
                break
            distance = self.distance(way * inward)
            if distance <= TOUCH:
                return way
            way += distance
        return np.inf

    def distance(self, shift: Array) -> float:
        """Of the finger, moved in the world, from the handle [m]; 0 or less where they touch."""
        return min(_distance(one, other, shift) for one in self.finger for other in self.handle)


def own_shapes(mechanism: Mechanism, body: str) -> Iterable[tuple[coal.CollisionGeometry, Array]]:
    """Shapes of a body with a mesh, as they are declared, and body_T_shape (4, 4); none if it has no mesh."""
    own = next(each.collision for each in mechanism.bodies if each.name == body)
    if any(each.shape is ShapeType.MESH for each in own):
        for geometry in own:
            for shape in surface(geometry):
                yield shape, se3(geometry.pose).homogeneous


def _distance(one: Posed, other: Posed, shift: Array) -> float:
    # A request of its own for each call: a cached guess from another pair gives wrong answers.
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    at, against = coal.Transform3s(one[1], one[2] + shift), coal.Transform3s(other[1], other[2])
    return float(coal.distance(one[0], at, other[0], against, request, result))
