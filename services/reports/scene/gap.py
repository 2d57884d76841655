"""The distance between two bodies of a scene, and where it is."""

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
from numpy.typing import NDArray

from sdt_kg.iri import Iri
from services.physics.model import Scene
from services.physics.solids import Solid

Array = NDArray[np.float64]


def gap(scene: Scene, q: Array, bodies: tuple[Iri, Iri]) -> tuple[float, Array] | None:
    """Signed distance [m] of the nearest shapes of two bodies, and its ends, shape (2, 3) [m].

    For a picture: certificates are about bounds, between the samples too. A depth is that of single shapes.

    Args:
        scene: Kitchen and robot.
        q: Shape (nq,).
        bodies: IRIs.

    Returns:
        None where one of them has no shape.
    """
    scene.placements.move(q)
    found = [_distance(scene, a, b) for a in _solids(scene, bodies[0]) for b in _solids(scene, bodies[1])]
    return min(found, key=lambda each: each[0]) if found else None


def _solids(scene: Scene, body: Iri) -> list[Solid]:
    return [each for each in scene.solids if each.body == body]


def _distance(scene: Scene, a: Solid, b: Solid) -> tuple[float, Array]:
    frames = [scene.placements.world_T_joint[each.joint] * each.joint_T_shape for each in (a, b)]
    places = [coal.Transform3s(frame.rotation, frame.translation) for frame in frames]
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    coal.distance(a.shape, places[0], b.shape, places[1], request, result)
    return result.min_distance, np.array((result.getNearestPoint1(), result.getNearestPoint2()))
