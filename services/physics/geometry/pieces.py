"""Shapes whose depth in each other means something: primitives, and the convex components of meshes."""

from functools import lru_cache

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from sdt_kg.mechanism import Geometry, ShapeType
from services.physics.geometry.shapes import corners, hull_of_solid, surface, with_volume

Array = NDArray[np.float64]

SAME_POINT = 6
"""[1] Decimals of a metre to which vertices are one: files repeat a vertex for each of its faces."""

CONVEX_SHARE = 0.02
"""[1] By how much of its hull a component's volume may fall short to count as convex: chamfers do."""


def pieces(geometry: Geometry) -> tuple[coal.CollisionGeometry, ...]:
    """A primitive as it is; of a mesh each convex component as its hull, the others as triangles.

    Triangles have no inside: how deep something is in them is too little, never too much.
    """
    (shape,) = surface(geometry)
    if geometry.shape is not ShapeType.MESH:
        return (shape,)
    return _components(geometry.mesh_hash, geometry.size, shape)


@lru_cache(maxsize=1024)
def _components(
    mesh_hash: str, scale: tuple[float, ...], mesh: coal.BVHModelBase
) -> tuple[coal.CollisionGeometry, ...]:
    del mesh_hash, scale  # the key; the mesh itself is one object for both
    triangles = corners(mesh)
    _, index = np.unique(np.round(triangles.reshape(-1, 3), SAME_POINT), axis=0, return_inverse=True)
    index = index.reshape(-1, 3)
    rows, columns = index[:, [0, 1]].ravel(), index[:, [1, 2]].ravel()
    size = int(index.max()) + 1
    graph = coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(size, size))
    label = connected_components(graph, directed=False)[1][index[:, 0]]
    return tuple(_shape(triangles[label == each]) for each in np.unique(label))


def _shape(triangles: Array) -> coal.CollisionGeometry:
    """The hull of a component, shape (M, 3, 3), if that is convex or flat; else its triangles."""
    points = triangles.reshape(-1, 3)
    solid = with_volume(points)
    whole = hull_of_solid(solid)
    if len(solid) > len(points):
        return whole
    filled = whole.computeVolume()
    volume = abs(float(np.linalg.det(triangles - triangles.mean(axis=(0, 1))).sum())) / 6
    return whole if abs(volume - filled) <= CONVEX_SHARE * filled else _triangles(triangles)


def _triangles(triangles: Array) -> coal.BVHModelBase:
    mesh = coal.BVHModelOBBRSS()
    mesh.beginModel(len(triangles), 3 * len(triangles))
    for a, b, c in triangles:
        mesh.addTriangle(a, b, c)
    mesh.endModel()
    mesh.computeLocalAABB()
    return mesh
