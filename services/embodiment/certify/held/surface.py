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
FINE = 1e-5  # [m] precision of how far a finger reaches over a handle, where that is less than asked
HERE = np.zeros(3)

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

    def way(self, inward: Array, first: float, most: float, aside: Array = HERE) -> float:
        """How far the finger, moved aside before, moves inward until it touches the handle [m].

        No less than `first`; infinite if that is farther than `most`.
        """
        way = first
        for _ in range(MOST_STEPS):
            if way > most:
                break
            distance = self.distance(aside + way * inward)
            if distance <= TOUCH:
                return way
            way += distance
        return np.inf

    def touches(self, inward: Array, first: float, most: float, sides: Array, much: float) -> bool:
        """Whether, moved so far to each side before, it touches on its way inward between the two [m]."""
        return all(
            self.distance(much * side + most * inward) <= TOUCH  # which is quicker, where fingers are thick
            or np.isfinite(self.way(inward, first, most, much * side))
            for side in sides
        )

    def over(self, inward: Array, way: float, sides: Array, engaged: float, slope: float) -> float:
        """How far the finger reaches over the handle to the least of some sides [m], at most `engaged`.

        Args:
            inward: World direction.
            way: Of the finger until it touches [m].
            sides: World directions, shape (S, 3).
            engaged: What is asked for.
            slope: By which its way may grow for each step aside [1].
        """

        def holds(much: float) -> bool:
            return self.touches(inward, way, way + slope * much, sides, much)

        if holds(engaged):
            return engaged
        least, most = 0.0, engaged
        while most - least > FINE:
            middle = (least + most) / 2
            least, most = (middle, most) if holds(middle) else (least, middle)
        return least

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
