"""Shapes as triangles: the collision geometry that is judged, and what a URDF says that bodies look like."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, Final
from xml.etree import ElementTree as ET

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from sdt_kg.errors import UrdfError
from sdt_kg.mechanism import Geometry, Mechanism, Pose, ShapeType
from sdt_kg.urdf.document import parse_xml
from sdt_kg.urdf.meshes import mesh_hash, mesh_path

Array = NDArray[np.float64]
Indices = NDArray[np.uint32]
Coal = Any  # it has no types of its own

ROUND: Final = 24
"""Corners of a circle in the picture; the judge's cylinders are round."""


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Triangles in a body's frame.

    Attributes:
        vertices: Shape (V, 3) [m].
        faces: Shape (F, 3).
    """

    vertices: Array
    faces: Indices

    @property
    def centre(self) -> Array:
        """Middle of its box, shape (3,) [m]."""
        return (self.vertices.min(axis=0) + self.vertices.max(axis=0)) / 2


def collision_surfaces(mechanism: Mechanism, *, hulls: bool) -> dict[str, Surface]:
    """What is judged: body name → its shapes, for the bodies that have any.

    Args:
        mechanism: Whose bodies.
        hulls: Whether meshes are judged as convex pieces that contain them (robots) or by their
            triangles (kitchens).
    """
    return {
        body.name: joined(_pieces(geometry, hulls) for geometry in body.collision)
        for body in mechanism.bodies
        if body.collision
    }


def visual_surfaces(urdf: Path) -> dict[str, Surface]:
    """What bodies look like, where the URDF says so: body name → its visuals.

    Raises:
        UrdfError: A mesh is missing, lies outside of the model's folder or cannot be read.
    """
    if urdf.suffix != ".urdf":
        return {}
    root = parse_xml(urdf.read_bytes(), urdf)
    found: dict[str, Surface] = {}
    for link in root.findall("link"):
        where = f"{urdf}: link '{link.get('name', '')}'"
        visuals = [_visual(each, urdf, where) for each in link.findall("visual")]
        surfaces = [_pieces(each, hulls=False) for each in visuals if each is not None]
        if surfaces:
            found[link.get("name", "")] = joined(surfaces)
    return found


def _visual(visual: ET.Element, urdf: Path, where: str) -> Geometry | None:
    origin, geometry = visual.find("origin"), visual.find("geometry")
    shape = None if geometry is None else next(iter(geometry), None)
    if shape is None:
        return None
    pose = Pose() if origin is None else _pose(origin)
    numbers = {
        "box": (ShapeType.BOX, ("size",)),
        "sphere": (ShapeType.SPHERE, ("radius",)),
        "cylinder": (ShapeType.CYLINDER, ("radius", "length")),
        "capsule": (ShapeType.CAPSULE, ("radius", "length")),
    }
    if shape.tag in numbers:
        kind, names = numbers[shape.tag]
        return Geometry(kind, pose, tuple(value for name in names for value in _numbers(shape, name)))
    if shape.tag != "mesh":
        return None
    path = mesh_path(shape.get("filename", ""), urdf, where)
    scale = tuple(_numbers(shape, "scale", "1 1 1"))
    return Geometry(ShapeType.MESH, pose, scale, str(path), mesh_hash(path))


def _numbers(element: ET.Element, name: str, default: str = "") -> list[float]:
    text = element.get(name, default)
    try:
        return [float(part) for part in text.split()]
    except ValueError:
        raise UrdfError(f"a visual's {name} is '{text}'", allowed="numbers") from None


def _pose(origin: ET.Element) -> Pose:
    x, y, z = _numbers(origin, "xyz", "0 0 0")
    a, b, c, w = Rotation.from_euler("xyz", _numbers(origin, "rpy", "0 0 0")).as_quat()
    return Pose((x, y, z), (float(a), float(b), float(c), float(w)))


def _pieces(geometry: Geometry, hulls: bool) -> Surface:
    if geometry.shape is ShapeType.MESH:
        local = _mesh(geometry, hulls)
    else:
        local = _primitive(geometry.shape, geometry.size)
    body_T_shape = geometry.pose.matrix()
    return Surface(local.vertices @ body_T_shape[:3, :3].T + body_T_shape[:3, 3], local.faces)


@lru_cache(maxsize=4096)
def _primitive(shape: ShapeType, size: tuple[float, ...]) -> Surface:
    made: Any = None  # trimesh has no types of its own
    if shape is ShapeType.BOX:
        made = trimesh.creation.box(extents=size)
    elif shape is ShapeType.SPHERE:
        made = trimesh.creation.icosphere(subdivisions=2, radius=size[0])
    elif shape is ShapeType.CYLINDER:
        made = trimesh.creation.cylinder(radius=size[0], height=size[1], sections=ROUND)
    else:
        made = trimesh.creation.capsule(radius=size[0], height=size[1], count=(ROUND, ROUND))
    return Surface(np.array(made.vertices, dtype=np.float64), np.array(made.faces, dtype=np.uint32))


def _mesh(geometry: Geometry, hulls: bool) -> Surface:
    """A mesh as the judge reads it."""
    from services.physics.geometry.shapes import solids, surface  # noqa: PLC0415 - loads coal, for meshes alone

    shapes = solids(geometry) if hulls else surface(geometry)
    return joined(_triangles(shape) for shape in shapes)


def _triangles(shape: Coal) -> Surface:
    if hasattr(shape, "num_tris"):
        faces = [shape.tri_indices(k) for k in range(shape.num_tris)]
        vertices = np.array(shape.vertices(), dtype=np.float64).reshape(-1, 3)
        indices = [[int(face[0]), int(face[1]), int(face[2])] for face in faces]
        return Surface(vertices, np.array(indices, dtype=np.uint32).reshape(-1, 3))
    points = np.array([shape.point(k) for k in range(shape.num_points)], dtype=np.float64)
    hull = ConvexHull(points)
    return Surface(points, _outward(points, hull.simplices, hull.equations[:, :3]))


def _outward(points: Array, faces: NDArray[np.int32], normals: Array) -> Indices:
    """The faces, each with its corners in the order in which its outer side is seen."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), normals) < 0
    return np.where(inward[:, None], faces[:, ::-1], faces).astype(np.uint32)


def joined(surfaces: Iterable[Surface]) -> Surface:
    """All of them as one."""
    parts = list(surfaces)
    first = np.cumsum([0, *(len(each.vertices) for each in parts)])
    return Surface(
        np.concatenate([each.vertices for each in parts]),
        np.concatenate([each.faces + np.uint32(k) for each, k in zip(parts, first, strict=False)]),
    )
