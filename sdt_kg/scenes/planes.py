"""Planes of MJCF and SDF: boxes as large as the floor's, with what is behind the plane in them."""

import math
from collections.abc import Iterable, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import UrdfError
from sdt_kg.mechanism import Geometry, Pose, ShapeType

Matrix = NDArray[np.float64]

PLANE: Final = (100.0, 100.0, 1.0)
"""[m] Of such a box; its upper face lies about the plane's origin."""

LEVEL: Final = 0.002
"""[m] A floor that is no more below z = 0 is there, where robots stand; [1] and no more aslant."""


UPSIDE_DOWN: Final = -1 + 1e-12
"""[1] z of a normal that looks down."""


def half_space(at: Matrix, normal: Sequence[float] = (0.0, 0.0, 1.0)) -> Geometry:
    """The box behind a plane through the origin of a pose (4, 4), with a normal in its frame.

    Raises:
        UrdfError: The normal has no length.
    """
    length = math.hypot(*normal)
    if length == 0:
        raise UrdfError("a plane with normal 0 0 0", allowed="any other")
    x, y, z = (float(part) / length for part in at[:3, :3] @ normal)
    # From z to the normal: half of the turn about what is across both.
    turn = (-y, x, 0.0, 1 + z) if z > UPSIDE_DOWN else (1.0, 0.0, 0.0, 0.0)
    qx, qy, qz, qw = (part / math.hypot(*turn) for part in turn)
    px, py, pz = (float(a) - PLANE[2] / 2 * b for a, b in zip(at[:3, 3], (x, y, z), strict=True))
    return Geometry(ShapeType.BOX, Pose((px, py, pz), (qx, qy, qz, qw)), PLANE)


def floor_of(shapes: Iterable[tuple[str, Matrix, Geometry]]) -> tuple[float, str]:
    """How high the highest level plane is [m], and whose; 0 and nobody's where there is none.

    Args:
        shapes: Name of a body, world_T_shape, and the shape.
    """
    planes = (each for each in shapes if each[2].size == PLANE)
    floors = [(float(at[2, 3]) + PLANE[2] / 2, name) for name, at, _ in planes if at[2, 2] > 1 - LEVEL]
    return max(floors, default=(0.0, ""))
