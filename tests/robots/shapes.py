"""URDF links with their collision shapes, read by nothing of ours."""

from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]


def numbers(text: str | None) -> Array:
    return np.array([float(word) for word in (text or "0 0 0").split()])


def transform(element: ElementTree.Element) -> Array:
    matrix, origin = np.eye(4), element.find("origin")
    if origin is not None:
        matrix[:3, :3] = Rotation.from_euler("xyz", numbers(origin.get("rpy"))).as_matrix()
        matrix[:3, 3] = numbers(origin.get("xyz"))
    return matrix


@dataclass(frozen=True)
class Shape:
    """Box (x, y, z), cylinder (radius, length) or sphere (radius) [m] with its pose in the link."""

    kind: str
    size: Array
    pose: Array

    @property
    def half(self) -> Array:
        if self.kind == "box":
            return self.size / 2
        return np.array([self.size[0], self.size[0], self.size[-1] / (2 if self.kind == "cylinder" else 1)])

    def outside(self, points: Array) -> Array:
        """Distance of each point to the shape, 0 within."""
        local = (points - self.pose[:3, 3]) @ self.pose[:3, :3]
        if self.kind == "sphere":
            return np.maximum(np.linalg.norm(local, axis=1) - self.size[0], 0)
        if self.kind == "cylinder":
            over = np.stack(
                [np.hypot(local[:, 0], local[:, 1]) - self.size[0], np.abs(local[:, 2]) - self.size[1] / 2]
            )
            return np.linalg.norm(np.maximum(over, 0), axis=0)
        return np.linalg.norm(np.maximum(np.abs(local) - self.size / 2, 0), axis=1)

    def bounds(self) -> Array:
        reach = self.half if self.kind == "sphere" else np.abs(self.pose[:3, :3]) @ self.half
        return np.stack([self.pose[:3, 3] - reach, self.pose[:3, 3] + reach])


def outside(shapes: list[Shape], points: Array) -> Array:
    """Distance of each point to the union of the shapes."""
    return np.min([shape.outside(points) for shape in shapes], axis=0)


def volume(shapes: list[Shape], count: int = 20_000) -> float:
    """Volume of the union [m³], by counting points in its bounding box."""
    bounds = np.stack([shape.bounds() for shape in shapes])
    low, high = bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)
    points = np.random.default_rng(0).uniform(low, high, (count, 3))
    return float(np.prod(high - low) * np.mean(outside(shapes, points) == 0))


class Links:
    """Links of a URDF file."""

    def __init__(self, file: Path) -> None:
        self.file = file
        root = ElementTree.parse(file).getroot()  # noqa: S314 our own and reference files
        self.links = {str(link.get("name")): link for link in root.findall("link")}
        self.joints = {str(joint.get("name")): joint for joint in root.findall("joint")}

    def ends(self, joint: str) -> tuple[str, str]:
        parent, child = (self.joints[joint].find(end) for end in ("parent", "child"))
        assert parent is not None
        assert child is not None
        return str(parent.get("link")), str(child.get("link"))

    def shapes(self, link: str) -> list[Shape]:
        found = []
        for collision in self.links[link].findall("collision"):
            for kind, keys in (("box", ["size"]), ("cylinder", ["radius", "length"]), ("sphere", ["radius"])):
                solid = collision.find(f"geometry/{kind}")
                if solid is not None:
                    size = np.concatenate([numbers(solid.get(key)) for key in keys])
                    found.append(Shape(kind, size, transform(collision)))
        return found

    def meshes(self, link: str) -> list[trimesh.Trimesh]:
        """Collision meshes in the link's frame."""
        found = []
        for collision in self.links[link].findall("collision"):
            mesh = collision.find("geometry/mesh")
            if mesh is not None:
                name = mesh.get("filename", "").replace("package://", "")
                file = next(each for folder in self.file.parents if (each := folder / name).is_file())
                piece = trimesh.load(file, force="mesh", process=False)
                piece.vertices = piece.vertices * numbers(mesh.get("scale", "1 1 1"))
                piece.apply_transform(transform(collision))
                found.append(piece)
        return found
