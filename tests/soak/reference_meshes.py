"""Reference models placed by their own URDFs: no kinematics, shapes or poses of ours."""

from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

import coal
import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from tests.robots.shapes import Links, numbers, transform

Array = NDArray[np.float64]


@dataclass
class Placed:
    """A URDF file whose links can be placed.

    Attributes:
        root: world_T_root, shape (4, 4); changed from configuration to configuration.
    """

    file: Path
    root: Array = field(default_factory=lambda: np.eye(4))

    def __post_init__(self) -> None:
        self.links = Links(self.file)
        self._parent = {self.links.ends(name)[1]: name for name in self.links.joints}
        self._meshes: dict[str, list[tuple[trimesh.Trimesh, coal.BVHModelOBBRSS]]] = {}

    def placement(self, link: str, positions: dict[str, float]) -> Array:
        """world_T_link; joints that are not listed are at 0."""
        if link not in self._parent:
            return self.root
        name = self._parent[link]
        joint = self.links.joints[name]
        return (
            self.placement(self.links.ends(name)[0], positions) @ transform(joint) @ _moved(joint, positions)
        )

    def meshes(self, link: str) -> list[tuple[trimesh.Trimesh, coal.BVHModelOBBRSS]]:
        """Triangles of a link's collision geometry, primitives included, in its frame."""
        if link not in self._meshes:
            solids = [*self.links.meshes(link), *map(_primitive, self.links.shapes(link))]
            self._meshes[link] = [(solid, _triangles(solid)) for solid in solids]
        return self._meshes[link]


def overlap(  # noqa: PLR0917
    one: Placed, link: str, q: dict[str, float], other: Placed, other_link: str, other_q: dict[str, float]
) -> bool:
    """Whether surfaces of two links cross, or a vertex of one lies in a watertight mesh of the other."""
    frame, other_frame = one.placement(link, q), other.placement(other_link, other_q)
    for mesh, triangles in one.meshes(link):
        for other_mesh, other_triangles in other.meshes(other_link):
            request, result = coal.CollisionRequest(), coal.CollisionResult()
            if coal.collide(
                triangles, _placed(frame), other_triangles, _placed(other_frame), request, result
            ):
                return True
            if _within(mesh, frame, other_mesh, other_frame) or _within(other_mesh, other_frame, mesh, frame):
                return True
    return False


def boxes_apart(  # noqa: PLR0917
    one: Placed,
    links: list[str],
    q: dict[str, float],
    other: Placed,
    other_link: str,
    other_q: dict[str, float],
) -> float:
    """Least gap of the links' world-aligned boxes to another link's: no distance of theirs is less [m]."""
    low, high = _bounds(other, other_link, other_q)
    gaps = []
    for link in links:
        if one.meshes(link):
            lower, upper = _bounds(one, link, q)
            gaps.append(float(np.linalg.norm(np.maximum(np.maximum(lower - high, low - upper), 0))))
    return min(gaps)


def _bounds(part: Placed, link: str, q: dict[str, float]) -> Array:
    frame = part.placement(link, q)
    points = np.vstack([mesh.vertices for mesh, _ in part.meshes(link)]) @ frame[:3, :3].T + frame[:3, 3]
    return np.stack((points.min(axis=0), points.max(axis=0)))


def _moved(joint: ElementTree.Element, positions: dict[str, float]) -> Array:
    kind, matrix, mimic = joint.get("type"), np.eye(4), joint.find("mimic")
    if kind == "fixed":
        return matrix
    q = positions.get(str(joint.get("name")), 0.0)
    if mimic is not None:
        source = positions.get(str(mimic.get("joint")), 0.0)
        q = float(mimic.get("multiplier", "1")) * source + float(mimic.get("offset", "0"))
    element = joint.find("axis")
    axis = np.array((1.0, 0, 0)) if element is None else numbers(element.get("xyz"))
    if kind == "prismatic":
        matrix[:3, 3] = q * axis / np.linalg.norm(axis)
    else:
        matrix[:3, :3] = Rotation.from_rotvec(q * axis / np.linalg.norm(axis)).as_matrix()
    return matrix


def _primitive(shape: object) -> trimesh.Trimesh:
    kind, size, pose = shape.kind, shape.size, shape.pose  # type: ignore[attr-defined]
    made = {
        "box": lambda: trimesh.creation.box(size),
        "cylinder": lambda: trimesh.creation.cylinder(size[0], size[1]),
        "sphere": lambda: trimesh.creation.icosphere(radius=size[0]),
    }[kind]()
    made.apply_transform(pose)
    return made


def _triangles(mesh: trimesh.Trimesh) -> coal.BVHModelOBBRSS:
    model = coal.BVHModelOBBRSS()
    model.beginModel(len(mesh.faces), len(mesh.vertices))
    for face in mesh.triangles:
        model.addTriangle(*np.ascontiguousarray(face))
    model.endModel()
    return model


def _placed(frame: Array) -> coal.Transform3s:
    return coal.Transform3s(frame[:3, :3], frame[:3, 3])


def _within(mesh: trimesh.Trimesh, frame: Array, other: trimesh.Trimesh, other_frame: Array) -> bool:
    """Whether a vertex of one mesh lies inside another, closed one: by the solid angle it is seen under."""
    if not other.is_watertight:
        return False
    point = np.linalg.inv(other_frame) @ frame @ np.append(mesh.vertices[0], 1.0)
    if np.any(point[:3] < other.bounds[0]) or np.any(point[:3] > other.bounds[1]):
        return False
    a, b, c = np.moveaxis(other.triangles - point[:3], 1, 0)
    la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
    top = np.einsum("ij,ij->i", a, np.cross(b, c))
    dots = [np.einsum("ij,ij->i", x, y) for x, y in ((a, b), (b, c), (c, a))]
    below = la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb
    return abs(2 * np.arctan2(top, below).sum()) > 2 * np.pi
