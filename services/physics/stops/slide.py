"""How far a mesh slides before it comes near another one, told by what their edges sweep."""

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
from numpy.typing import NDArray

from services.physics.geometry.gap import gap
from services.physics.geometry.pieces import same_points
from services.physics.geometry.shapes import Triangles, faces_of

Array = NDArray[np.float64]
Meshes = tuple[coal.BVHModelBase, coal.BVHModelBase]
Placed = tuple[coal.Transform3s, coal.Transform3s]

ALONG = 1e-9
"""[1] Sine to the way below which an edge sweeps no surface; that of its ends is swept by other edges."""


def free_way(meshes: Meshes, placed: Placed, way: Array, near: float) -> float:
    """How far a mesh goes on a straight way before it comes too near another [m]; without end if nowhere.

    They first meet with a corner of one in a face of the other, or with two edges: what the edges of the one
    sweep meets the other, or what those of the other sweep on the way back meets the one.

    Args:
        meshes: The one that moves, and the other, which rests.
        placed: Where each is as the way begins; there they are not too near.
        way: In the world, shape (3,) [m].
        near: What is too near, and what may be missing in the answer [m].
    """
    (one, other), (one_at, other_at) = meshes, placed
    there, back = one_at.getRotation().T @ way, -other_at.getRotation().T @ way

    def meet(share: float) -> bool:
        ahead, behind = _swept(one, share * there), _swept(other, share * back)
        return min(gap(ahead, one_at, other, other_at)[0], gap(one, one_at, behind, other_at)[0]) < near

    if not meet(1.0):
        return np.inf
    free, length = 0.0, float(np.linalg.norm(way))
    for half in length * 0.5 ** np.arange(1, np.log2(max(length / near, 1.0)) + 1):
        if not meet((free + half) / length):
            free += half
    return free


def _swept(mesh: coal.BVHModelBase, way: Array) -> coal.BVHModelBase:
    """What a mesh's edges sweep on a straight way of its own frame, shape (3,) [m]."""
    points, faces = faces_of(mesh)
    points, index = same_points(points)
    edges = np.unique(np.sort(index[faces][:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
    along = points[edges[:, 1]] - points[edges[:, 0]]
    least = ALONG * np.linalg.norm(along, axis=1) * np.linalg.norm(way)
    a, b = edges[np.linalg.norm(np.cross(along, way), axis=1) > least].T
    c, d = a + len(points), b + len(points)
    return Triangles(np.vstack((points, points + way)), np.stack((a, b, d, a, d, c), axis=1).reshape(-1, 3))
