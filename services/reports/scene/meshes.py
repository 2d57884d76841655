"""Collision geometry as triangles and the edges that an engineer would draw."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import trimesh
from numpy.typing import NDArray

from sdt_kg.mechanism import Geometry, Pose, ShapeType
from services.physics.geometry.shapes import surface

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

SECTIONS = 20
"""[1] Corners of a circle."""

MOST_TRIANGLES = 1500
"""[1] Of one mesh; a finer one is drawn by fewer, its corners merged on a grid."""

FINEST, COARSEST = 64, 4
"""[1] Cells of that grid along a mesh's longest side, first and last tried."""

SHARP = np.radians(30.0)
"""[rad] Neighbouring triangles that meet at a larger angle have an edge between them."""


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """Triangles.

    Attributes:
        vertices: Shape (V, 3) [m].
        faces: Corners of each triangle, shape (F, 3).
        edges: Ends of each line that is drawn, shape (E, 2).
    """

    vertices: Array
    faces: Indices
    edges: Indices

    def placed(self, frame: Array) -> "Mesh":
        """The same triangles under a transform, shape (4, 4)."""
        return Mesh(self.vertices @ frame[:3, :3].T + frame[:3, 3], self.faces, self.edges)


def mesh_of(geometry: Geometry) -> Mesh:
    """Triangles of a collision shape, in the frame of its body.

    Raises:
        UrdfError: A mesh file that cannot be read.
    """
    key = (geometry.shape, geometry.size, geometry.mesh_file, geometry.mesh_hash)
    return _mesh(*key).placed(geometry.pose.matrix())


@lru_cache(maxsize=2048)
def _mesh(shape: ShapeType, size: tuple[float, ...], mesh_file: str, mesh_hash: str) -> Mesh:
    if shape is ShapeType.MESH:
        loaded = surface(Geometry(shape, Pose(), size, mesh_file, mesh_hash))[0]
        corners = [loaded.tri_indices(i) for i in range(loaded.num_tris)]
        faces = np.array([[each[0], each[1], each[2]] for each in corners], dtype=np.intp)
        return _drawn(trimesh.Trimesh(*_thinned(np.array(loaded.vertices()), faces), process=False))
    return _drawn(_primitive(shape, size))


def _primitive(shape: ShapeType, size: tuple[float, ...]) -> trimesh.Trimesh:
    if shape is ShapeType.BOX:
        return trimesh.creation.box(extents=size)
    if shape is ShapeType.SPHERE:
        return trimesh.creation.icosphere(subdivisions=2, radius=size[0])
    if shape is ShapeType.CYLINDER:
        return trimesh.creation.cylinder(radius=size[0], height=size[1], sections=SECTIONS)
    made = trimesh.creation.capsule(radius=size[0], height=size[1], count=(SECTIONS, SECTIONS))
    made.apply_translation([0.0, 0.0, -made.bounds.mean(axis=0)[2]])  # trimesh's begins at a cap's centre
    return made


def _drawn(mesh: trimesh.Trimesh) -> Mesh:
    sharp = mesh.face_adjacency_angles > SHARP
    edges = np.asarray(mesh.face_adjacency_edges)[sharp]
    return Mesh(np.asarray(mesh.vertices, dtype=np.float64), np.asarray(mesh.faces), edges)


def _thinned(vertices: Array, faces: Indices) -> tuple[Array, Indices]:
    """At most `MOST_TRIANGLES`, as far as the coarsest grid allows."""
    cells = FINEST
    while len(faces) > MOST_TRIANGLES and cells >= COARSEST:
        vertices, faces = _merged(vertices, faces, float(np.ptp(vertices, axis=0).max()) / cells)
        cells //= 2
    return vertices, faces


def _merged(vertices: Array, faces: Indices, cell: float) -> tuple[Array, Indices]:
    """Corners in one cell of a grid become their mean; triangles without an area go."""
    grid = np.floor((vertices - vertices.min(axis=0)) / max(cell, 1e-9)).astype(np.int64)
    _, group = np.unique(grid, axis=0, return_inverse=True)
    group = group.reshape(-1)
    sums = np.zeros((group.max() + 1, 3))
    np.add.at(sums, group, vertices)
    faces = group[faces]
    apart = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    return sums / np.bincount(group)[:, None], np.unique(faces[apart], axis=0)
