"""The two kitchens as trees of links with their shapes, ours and the reference's."""

from dataclasses import dataclass
from itertools import product
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import kitchens

Array = NDArray[np.float64]
REFERENCE = {"a": "kitchen_a_apartment/apartment_local.urdf", "b": "kitchen_b_iai_kitchen/kitchen.urdf"}
DOORS = {
    "a": [
        "cabinet1_door_top_left",
        "cabinet2_door_left",
        "cabinet3_door_bottom_left",
        "cabinet3_door_top_left",
        "cabinet4_door_bottom",
        "cabinet7_door_bottom_left",
        "wardrobe_door_left",
        "wardrobe_door_right",
    ],
    "b": ["iai_fridge_door", "oven_area_oven_door", "sink_area_dish_washer_door"],
}
DRAWERS = {
    "a": [
        *(f"cabinet{n}_drawer_{p}" for n, p in product((5, 6, 9, 10, 11), ("top", "middle", "bottom"))),
        "cabinet1_drawer_middle",
        "cabinet1_drawer_bottom",
        "cabinet8_drawer_bottom",
        "dishwasher_drawer_middle",
    ],
    "b": [
        *(
            f"kitchen_island_{c}_{r}_drawer_main"
            for c, r in product(("left", "middle", "right"), ("upper", "lower"))
        ),
        *(f"sink_area_left_{r}_drawer_main" for r in ("upper", "middle", "bottom")),
        *(f"oven_area_area_{p}_drawer_main" for p in ("left", "middle_upper", "middle_lower")),
        "sink_area_trash_drawer_main",
        "fridge_area_lower_drawer_main",
    ],
}


def numbers(text: str | None) -> Array:
    return np.array([float(word) for word in (text or "0 0 0").split()])


def transform(origin: ElementTree.Element | None) -> Array:
    matrix = np.eye(4)
    if origin is not None:
        matrix[:3, :3] = Rotation.from_euler("xyz", numbers(origin.get("rpy"))).as_matrix()
        matrix[:3, 3] = numbers(origin.get("xyz"))
    return matrix


@dataclass(frozen=True)
class Shape:
    """Box or cylinder, with its pose in the link's frame."""

    kind: str
    size: Array
    pose: Array

    def mesh(self) -> trimesh.Trimesh:
        if self.kind == "box":
            return trimesh.creation.box(self.size, self.pose)
        return trimesh.creation.cylinder(self.size[0], self.size[1], transform=self.pose)

    def distance(self, points: Array) -> Array:
        """Distance of points outside, 0 inside."""
        local = (points - self.pose[:3, 3]) @ self.pose[:3, :3]
        if self.kind == "cylinder":
            radial = np.hypot(local[:, 0], local[:, 1]) - self.size[0]
            axial = np.abs(local[:, 2]) - self.size[1] / 2
            return np.linalg.norm(np.maximum(np.stack([radial, axial]), 0), axis=0)
        return np.linalg.norm(np.maximum(np.abs(local) - self.size / 2, 0), axis=1)


class Kitchen:
    """A URDF file, read by nothing of ours."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.root = ElementTree.parse(file).getroot()  # noqa: S314 our own and reference files
        self.links = {str(link.get("name")): link for link in self.root.findall("link")}
        self.joints = {str(joint.get("name")): joint for joint in self.root.findall("joint")}
        self.above = {self.end(joint, "child"): joint for joint in self.joints.values()}

    @staticmethod
    def end(joint: ElementTree.Element, which: str) -> str:
        return str(joint.find(which).get("link"))  # type: ignore[union-attr]

    def children(self, link: str) -> list[str]:
        return [child for child, joint in self.above.items() if self.end(joint, "parent") == link]

    def handles(self, link: str) -> list[str]:
        return [child for child in self.children(link) if "handle" in child]

    def limits(self, joint: str) -> tuple[float, float, float, float]:
        limit = self.joints[joint].find("limit")
        assert limit is not None
        lower, upper, velocity, effort = (
            float(limit.get(key, "nan")) for key in ("lower", "upper", "velocity", "effort")
        )
        return lower, upper, velocity, effort

    def movable(self) -> list[str]:
        return [name for name, joint in self.joints.items() if joint.get("type") != "fixed"]

    def frames(self, state: dict[str, float]) -> dict[str, Array]:
        """World pose of every link."""
        known: dict[str, Array] = {}

        def pose(link: str) -> Array:
            if link not in known:
                joint = self.above.get(link)
                known[link] = (
                    np.eye(4) if joint is None else pose(self.end(joint, "parent")) @ self.step(joint, state)
                )
            return known[link]

        return {link: pose(link) for link in self.links}

    def step(self, joint: ElementTree.Element, state: dict[str, float]) -> Array:
        moved = np.eye(4)
        if joint.get("type") != "fixed":
            axis = numbers(joint.find("axis").get("xyz"))  # type: ignore[union-attr]
            axis = axis / np.linalg.norm(axis)
            mimic, position = joint.find("mimic"), state.get(str(joint.get("name")), 0.0)
            if mimic is not None:
                position = float(mimic.get("multiplier", "1")) * state.get(str(mimic.get("joint")), 0.0)
            if joint.get("type") == "prismatic":
                moved[:3, 3] = axis * position
            else:
                moved[:3, :3] = Rotation.from_rotvec(axis * position).as_matrix()
        return transform(joint.find("origin")) @ moved

    def shapes(self, link: str) -> list[Shape]:
        """Boxes and cylinders of a link; meshes are left out."""
        found = []
        for collision in self.links[link].findall("collision"):
            pose, box, rod = (
                transform(collision.find("origin")),
                *map(collision.find, ("geometry/box", "geometry/cylinder")),
            )
            if box is not None:
                found.append(Shape("box", numbers(box.get("size")), pose))
            if rod is not None:
                found.append(
                    Shape(
                        "cylinder",
                        np.array([float(rod.get("radius", "")), float(rod.get("length", ""))]),
                        pose,
                    )
                )
        return found

    def mesh(self, link: str) -> trimesh.Trimesh | None:
        """All collision geometry of a link in its frame, or None."""
        pieces = [shape.mesh() for shape in self.shapes(link)]
        for collision in self.links[link].findall("collision"):
            mesh = collision.find("geometry/mesh")
            if mesh is not None:
                piece = trimesh.load(
                    self.file.parent / mesh.get("filename", "").replace("package://", ""), force="mesh"
                )
                piece.apply_transform(transform(collision.find("origin")))
                pieces.append(piece)
        return trimesh.util.concatenate(pieces) if pieces else None


@pytest.fixture(scope="session", params=["a", "b"])
def name(request: pytest.FixtureRequest) -> str:
    return request.param


@pytest.fixture(scope="session")
def kitchen(name: str) -> Kitchen:
    return Kitchen(kitchens.path(f"{name}/{name}.urdf"))


@pytest.fixture(scope="session")
def theirs(name: str, reference: Path) -> Kitchen:
    return Kitchen(reference / REFERENCE[name])


@pytest.fixture(scope="session")
def doors(name: str) -> list[str]:
    return DOORS[name]


@pytest.fixture(scope="session")
def drawers(name: str) -> list[str]:
    return DRAWERS[name]
