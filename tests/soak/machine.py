"""A URDF file as other code reads it: joints, limits, placements along a motion, and solids for distances.

Nothing of the project is used. Meshes are their triangles; boxes, cylinders and spheres are themselves,
but for their depth in meshes.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from xml.etree import ElementTree

import coal
import numpy as np
import trimesh
from numpy.typing import NDArray

from tests.robots.shapes import Links, Shape, numbers, transform
from tests.soak.depths import depth, parts

Array = NDArray[np.float64]
SIGNS = np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T


@dataclass(frozen=True)
class Solid:
    """One collision geometry of a link.

    Attributes:
        pose: link_T_shape.
        corners: Of a box about it, in the link's frame, shape (8, 3) [m].
        surface: In the link's frame; of what is round, nearly.
    """

    link: str
    shape: coal.CollisionGeometry
    pose: Array
    corners: Array
    surface: trimesh.Trimesh

    @cached_property
    def parts(self) -> list[Array]:
        """Triangles of each part of its surface, in the link's frame."""
        return parts(self.surface)

    def at(self, world_T_link: Array) -> coal.Transform3s:
        frame = world_T_link @ self.pose
        return coal.Transform3s(frame[:3, :3], frame[:3, 3])


def gap(one: Solid, frame: Array, other: Solid, other_frame: Array) -> float:
    """Distance [m]; of what overlaps minus its depth: of primitives coal's, of meshes that of `depths`."""
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    at = one.at(frame), other.at(other_frame)
    distance = float(coal.distance(one.shape, at[0], other.shape, at[1], request, result))
    if distance > 0 or not any(isinstance(solid.shape, coal.BVHModelBase) for solid in (one, other)):
        return distance
    seen = np.linalg.inv(other_frame) @ frame
    return -depth([part @ seen[:3, :3].T + seen[:3, 3] for part in one.parts], other.parts)


class Machine:
    """A kitchen or a robot.

    Args:
        file: URDF.
        turned: Whether joints with limits like [-1.5, 0] count the other way, as in our kitchens.
    """

    def __init__(self, file: Path, turned: bool = False) -> None:
        self.urdf = Links(file)
        self.parent = {self.urdf.ends(name)[1]: name for name in self.urdf.joints}
        self.root = next(link for link in self.urdf.links if link not in self.parent)
        self.movable = [name for name in self.urdf.joints if self.kind(name) != "fixed"]
        self.sign = {name: -1.0 if turned and self._below(name) else 1.0 for name in self.movable}
        joints = self.urdf.joints.items()
        self.held = {name: self._limits(one)[0] for name, one in joints if name not in self.movable}
        self.solids = [solid for link in self.urdf.links for solid in self._solids(link)]

    def kind(self, name: str) -> str:
        """Type of a joint; one with equal limits is fixed."""
        joint = self.urdf.joints[name]
        lower, upper, _ = self._limits(joint)
        return "fixed" if lower == upper else str(joint.get("type"))

    def limits(self, name: str) -> tuple[float, float, float]:
        """Lower, upper, velocity."""
        lower, upper, velocity = self._limits(self.urdf.joints[name])
        return (lower, upper, velocity) if self.sign[name] > 0 else (-upper, -lower, velocity)

    def rests(self) -> dict[str, float]:
        """Every movable joint at 0, or at the limit that is nearest to it."""
        return {name: float(np.clip(0.0, *self.limits(name)[:2])) for name in self.movable}

    def mimicked(self) -> dict[str, tuple[str, float, float]]:
        """Joint → joint that it follows in the end, multiplier, offset; as positions count here."""
        found: dict[str, tuple[str, float, float]] = {}
        for name in self.movable:
            mimic = self.urdf.joints[name].find("mimic")
            if mimic is not None:
                source = str(mimic.get("joint"))
                ratio = float(mimic.get("multiplier", "1")) * self.sign[name] * self.sign.get(source, 1.0)
                found[name] = source, ratio, float(mimic.get("offset", "0")) * self.sign[name]
        return {name: _in_the_end(name, found) for name in found}

    def rigid(self, link: str) -> str:
        """The first of the links that never move against this one."""
        while link in self.parent and self.kind(self.parent[link]) == "fixed":
            link = self.urdf.ends(self.parent[link])[0]
        return link

    def joined(self, one: str, other: str) -> bool:
        """Whether two links are rigidly attached, or have one joint between them."""
        pair = {one, other}
        return self.rigid(one) == self.rigid(other) or any(
            link in self.parent and {link, self.urdf.ends(self.parent[link])[0]} == pair for link in pair
        )

    def place(self, positions: Mapping[str, Array | float], links: Iterable[str]) -> dict[str, Array]:
        """root_T_link of each, shape (T, 4, 4) or (1, 4, 4); what mimics follows."""
        values = self.held | dict(positions)
        for name, (source, ratio, offset) in self.mimicked().items():
            values[name] = ratio * np.asarray(values[source]) + offset
        known = {self.root: np.eye(4)[None]}

        def at(link: str) -> Array:
            if link not in known:
                name = self.parent[link]
                joint = self.urdf.joints[name]
                before = at(self.urdf.ends(name)[0]) @ transform(joint)
                if joint.get("type") != "fixed":
                    before = before @ _moved(joint, np.atleast_1d(values[name]) * self.sign.get(name, 1.0))
                known[link] = before
            return known[link]

        return {link: at(link) for link in links}

    def _below(self, name: str) -> bool:
        lower, upper, _ = self._limits(self.urdf.joints[name])
        return lower < 0 and upper <= 0

    @staticmethod
    def _limits(joint: ElementTree.Element) -> tuple[float, float, float]:
        limit = joint.find("limit")
        if joint.get("type") == "fixed":
            return 0.0, 0.0, 0.0
        velocity = np.inf if limit is None else float(limit.get("velocity", "inf"))
        if limit is None or joint.get("type") == "continuous":
            return -np.inf, np.inf, velocity
        return float(limit.get("lower", "0")), float(limit.get("upper", "0")), velocity

    def _solids(self, link: str) -> Iterable[Solid]:
        for mesh in self.urdf.meshes(link):
            yield Solid(link, _triangles(mesh), np.eye(4), _corners(mesh.bounds), mesh)
        for shape in self.urdf.shapes(link):
            ends = np.stack((-shape.half, shape.half))
            around = _corners(ends) @ shape.pose[:3, :3].T + shape.pose[:3, 3]
            yield Solid(link, _primitive(shape), shape.pose, around, _surface(shape))


def _in_the_end(joint: str, follows: Mapping[str, tuple[str, float, float]]) -> tuple[str, float, float]:
    """What a joint follows that follows no other, multiplier, offset."""
    source, ratio, offset = follows[joint]
    while source in follows:
        source, further, more = follows[source]
        ratio, offset = ratio * further, ratio * more + offset
    return source, ratio, offset


def _moved(joint: ElementTree.Element, q: Array) -> Array:
    element = joint.find("axis")
    axis = np.array((1.0, 0, 0)) if element is None else numbers(element.get("xyz"))
    x, y, z = axis / np.linalg.norm(axis)
    step = np.tile(np.eye(4), (len(q), 1, 1))
    if joint.get("type") == "prismatic":
        step[:, :3, 3] = q[:, None] * (x, y, z)
        return step
    cross = np.array(((0, -z, y), (z, 0, -x), (-y, x, 0)))
    turn, bend = np.sin(q)[:, None, None], 1 - np.cos(q)[:, None, None]
    step[:, :3, :3] = np.eye(3) + turn * cross + bend * (cross @ cross)
    return step


def _corners(ends: Array) -> Array:
    return ends.mean(axis=0) + SIGNS * np.ptp(ends, axis=0) / 2


def _primitive(shape: Shape) -> coal.CollisionGeometry:
    if shape.kind == "box":
        return coal.Box(*shape.size)
    return coal.Cylinder(*shape.size) if shape.kind == "cylinder" else coal.Sphere(float(shape.size[0]))


def _surface(shape: Shape) -> trimesh.Trimesh:
    if shape.kind == "box":
        return trimesh.creation.box(shape.size, shape.pose)
    if shape.kind == "cylinder":
        return trimesh.creation.cylinder(*shape.size, transform=shape.pose)
    return trimesh.creation.icosphere(radius=float(shape.size[0])).apply_transform(shape.pose)


def _triangles(mesh: trimesh.Trimesh) -> coal.BVHModelOBBRSS:
    model = coal.BVHModelOBBRSS()
    model.beginModel(len(mesh.faces), 3 * len(mesh.faces))
    for face in np.ascontiguousarray(mesh.triangles):
        model.addTriangle(*face)
    model.endModel()
    return model
