"""SDF (1.5 and later) → Mechanism: models of a world or file, each fixed where it stands."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Final
from xml.etree import ElementTree as ET

import numpy as np

from sdt_kg.errors import UrdfError
from sdt_kg.mechanism import Geometry, Inertia, JointType, Limits, Mechanism, Mimic, ShapeType
from sdt_kg.scenes.build import HANDLE, Link, Matrix, Part, between, built, listed, pose_of
from sdt_kg.scenes.planes import half_space
from sdt_kg.scenes.solid import WORLD, check_solid
from sdt_kg.scenes.spelling import check_spelling
from sdt_kg.scenes.values import by_name, is_true, label, number_of, numbers_of, own_pose, turned_far
from sdt_kg.urdf.degrees import in_words
from sdt_kg.urdf.meshes import PACKAGE, collision_file, mesh_hash

MODEL: Final = "__model__"
OLDEST: Final = (1, 5)
"""Before it, axes were written in another frame."""

UNBOUNDED: Final = 1e15
"""[rad, m] A limit this large means that there is none; SDF's default is 1e16."""

JOINT_TYPES: Final = {kind.value: kind for kind in JointType}
SIZES: Final = {
    "box": (ShapeType.BOX, ("size",)),
    "sphere": (ShapeType.SPHERE, ("radius",)),
    "cylinder": (ShapeType.CYLINDER, ("radius", "length")),
    "capsule": (ShapeType.CAPSULE, ("radius", "length")),
}
LEFT_OUT: Final = ("include", "light", "actor", "plugin", "road", "population")
LEFT_OUT_OF_MODEL: Final = ("model", "include", "plugin", "gripper")
LEFT_OUT_OF_LINK: Final = ("sensor", "light", "projector", "particle_emitter", "battery", "plugin")


def read_sdf(root: ET.Element, path: Path, name: str) -> Mechanism:
    """The scene; SDF's models stand free in the world, here each is fixed where it stands.

    Raises:
        UrdfError: An older version, a frame or link that does not exist, or a number or element that is none.
    """
    version = root.get("version", "")
    if not version.replace(".", "", 1).isdecimal() or tuple(map(int, version.split("."))) < OLDEST:
        raise UrdfError(f"{path}: SDF version '{version}'", allowed="1.5 or later")
    check_spelling(root, path)
    worlds = root.findall("world")
    if len(worlds) > 1:
        raise UrdfError(f"{path}: {len(worlds)} worlds", allowed="one")
    holder = worlds[0] if worlds else root
    check_solid(holder, (*SIZES, "mesh", "plane", "empty"), path)
    models = holder.findall("model")
    if not models:
        raise UrdfError(f"{path}: has no model", allowed="at least one <model>")
    parts, links, notes = [Part(WORLD, np.eye(4))], list[Link](), list[str]()
    for model in models:
        reader = _Model(model, path, f"{model.get('name')}::" if len(models) > 1 else "")
        parts += reader.parts()
        links += reader.links()
        notes += reader.notes()
    if worlds:
        notes += listed("<model> beside the world", [label(each) for each in root.findall("model")])
        for tag in LEFT_OUT:
            notes += listed(f"<{tag}> of the world", [label(each) for each in holder.findall(tag)])
    notes += in_words([("pose of", turned_far(holder))])
    return built(name, parts, links, notes, path)


class _Model:
    """One <model>: its frames, then its links at the joints that carry them."""

    def __init__(self, model: ET.Element, path: Path, prefix: str) -> None:
        self.path, self.prefix, self.model = path, prefix, model
        self.where = f"{path}: model '{model.get('name')}'"
        self._check_placed()
        self.world_T_model = own_pose(model, self.where)
        named = (each for tag in ("link", "joint", "frame") for each in model.findall(tag))
        self.elements = by_name(named, self.where)
        self.link_names = [each.get("name", "") for each in model.findall("link")]
        self.carried_by = {self._end(joint, "child"): joint for joint in model.findall("joint")}
        self.odd: list[str] = []

    def _check_placed(self) -> None:
        """That the model stands where its pose says, in the world, and poses name frames as since 1.7."""
        pose = self.model.find("pose")
        base = "" if pose is None else pose.get("relative_to", "")
        if base not in ("", WORLD) or self.model.get("placement_frame"):
            raise UrdfError(
                f"{self.where} is placed by a frame: relative_to='{base}', "
                f"placement_frame='{self.model.get('placement_frame', '')}'",
                allowed="a pose of the model in the world",
                remedy="gz sdf -p FILE writes the poses out",
            )
        for pose in self.model.iter("pose"):
            if pose.get("frame"):
                raise UrdfError(
                    f"{self.where} has a pose with frame='{pose.get('frame')}'", allowed="relative_to='…'"
                )

    def parts(self) -> Iterator[Part]:
        """Every link, its frame at its joint."""
        for link in self.model.findall("link"):
            name = link.get("name", "")
            frame = self._frame(name)
            frame_T_link = between(frame, self._at(name))
            named = list(self._shapes(link, frame_T_link))
            handle = tuple(shape for called, shape in named if HANDLE in called.lower())
            inertia, shapes = self._inertia(link, frame_T_link), tuple(shape for _, shape in named)
            yield Part(self.prefix + name, frame, inertia, shapes, handle)

    def links(self) -> Iterator[Link]:
        """Every joint, and a fixed one from the world to each link that no joint carries."""
        for joint in self.model.findall("joint"):
            yield self._link(joint)
        for name in self.link_names:
            if name not in self.carried_by:
                at = self.prefix + name
                yield Link(f"{at}_fixed", JointType.FIXED, WORLD, at)

    def notes(self) -> list[str]:
        """What was not carried over."""
        static, name = is_true(self.model.findtext("static", ""), self.where), self.model.get("name")
        stands = not static and any(each not in self.carried_by for each in self.link_names)
        notes = [f"imported as fixed where it stands: model {name}"] if stands else []
        if static and any(joint.get("type") != "fixed" for joint in self.carried_by.values()):
            notes.append(f"model {name} is static, which is taken of its base: its joints move")
        notes += self.odd
        for tag in LEFT_OUT_OF_MODEL:
            notes += listed(
                f"<{tag}> of {self.model.get('name')}", [label(each) for each in self.model.findall(tag)]
            )
        for link in self.model.findall("link"):
            for tag in LEFT_OUT_OF_LINK:
                notes += listed(f"<{tag}> of {link.get('name')}", [label(each) for each in link.findall(tag)])
        visual = [
            self.prefix + link.get("name", "")
            for link in self.model.findall("link")
            if link.find("visual") is not None and link.find("collision") is None
        ]
        return notes + listed("visuals of links without collision geometry", visual)

    def _frame(self, link: str) -> Matrix:
        """world_T_frame of a link: that of the joint which carries it, else its own."""
        joint = self.carried_by.get(link)
        return self._at(link) if joint is None else self._at(joint.get("name", ""))

    def _at(self, name: str, above: tuple[str, ...] = ()) -> Matrix:
        """world_T_frame of a link, joint or frame of the model."""
        if name in (MODEL, ""):
            return self.world_T_model
        if name == WORLD:
            return np.eye(4)
        if name not in self.elements or name in above:
            problem = "is relative to itself" if name in above else "does not exist"
            raise UrdfError(
                f"{self.where}: frame '{name}' {problem}", allowed="links, joints and frames of the model"
            )
        element = self.elements[name]
        pose = element.find("pose")
        given = "" if pose is None else pose.get("relative_to", "")
        attached = {"joint": element.findtext("child", ""), "frame": element.get("attached_to", "")}
        base = given or attached.get(element.tag, "").strip()
        return self._at(base, (*above, name)) @ own_pose(element, self.where)

    def _end(self, joint: ET.Element, tag: str) -> str:
        """Link that a joint names; a frame stands for the link which it is attached to."""
        name = joint.findtext(tag, "").strip()
        seen: set[str] = set()
        while name in self.elements and self.elements[name].tag == "frame" and name not in seen:
            seen.add(name)
            name = self.elements[name].get("attached_to", "").strip()
        if name not in self.link_names and not (tag == "parent" and name == WORLD):
            raise UrdfError(
                f"{self.where}: joint '{joint.get('name')}' has {tag} '{name}'", allowed="a link of the model"
            )
        return name

    def _link(self, joint: ET.Element) -> Link:
        name, word = joint.get("name", ""), joint.get("type", "")
        parent, child = self._end(joint, "parent"), self._end(joint, "child")
        whole = parent if parent == WORLD else self.prefix + parent
        kind = JOINT_TYPES.get(word)
        if kind is None:
            note = f"{word} joint, which D_artic does not know: imported as fixed"
            return Link(self.prefix + name, JointType.FIXED, whole, self.prefix + child, notes=(note,))
        axis = joint.find("axis")
        if kind is JointType.FIXED:
            return Link(self.prefix + name, kind, whole, self.prefix + child)
        limits = self._limits(axis)
        endless = math.isinf(limits.lower) and math.isinf(limits.upper)
        if kind is JointType.CONTINUOUS or (kind is JointType.REVOLUTE and endless):
            kind, limits = JointType.CONTINUOUS, Limits(velocity=limits.velocity, effort=limits.effort)
        return Link(
            name=self.prefix + name,
            type=kind,
            parent=whole,
            child=self.prefix + child,
            axis=self._axis(joint, axis),
            limits=limits,
            mimic=self._mimic(axis),
        )

    def _limits(self, axis: ET.Element | None) -> Limits:
        limit = None if axis is None else axis.find("limit")
        lower, upper = (
            number_of(limit, tag, math.inf * sign, self.where) for tag, sign in (("lower", -1), ("upper", 1))
        )
        velocity, effort = (number_of(limit, tag, -1.0, self.where) for tag in ("velocity", "effort"))
        return Limits(
            lower=lower if abs(lower) < UNBOUNDED else -math.inf,
            upper=upper if abs(upper) < UNBOUNDED else math.inf,
            velocity=velocity if velocity >= 0 else math.inf,
            effort=effort if effort >= 0 else math.inf,
        )

    def _axis(self, joint: ET.Element, axis: ET.Element | None) -> tuple[float, float, float]:
        """The axis in the joint's frame."""
        written = None if axis is None else axis.find("xyz")
        if axis is None or written is None:
            return (0.0, 0.0, 1.0)
        direction = np.array(numbers_of(written, 3, self.where))
        in_model = is_true(axis.findtext("use_parent_model_frame", ""), self.where)
        frame = MODEL if in_model else written.get("expressed_in", "")
        if frame:
            joint_T_frame = between(self._at(joint.get("name", "")), self._at(frame))
            direction = joint_T_frame[:3, :3] @ direction
        x, y, z = (float(part) for part in direction)
        return (x, y, z)

    def _mimic(self, axis: ET.Element | None) -> Mimic | None:
        mimic = None if axis is None else axis.find("mimic")
        if mimic is None:
            return None
        multiplier = number_of(mimic, "multiplier", 1.0, self.where)
        reference = number_of(mimic, "reference", 0.0, self.where)
        offset = number_of(mimic, "offset", 0.0, self.where) - multiplier * reference
        return Mimic(self.prefix + mimic.get("joint", ""), multiplier, offset)

    def _inertia(self, link: ET.Element, frame_T_link: Matrix) -> Inertia | None:
        inertial = link.find("inertial")
        if inertial is None:
            return None
        inertia = inertial.find("inertia")
        ixx, iyy, izz = (number_of(inertia, tag, 1.0, self.where) for tag in ("ixx", "iyy", "izz"))
        ixy, ixz, iyz = (number_of(inertia, tag, 0.0, self.where) for tag in ("ixy", "ixz", "iyz"))
        at = pose_of(frame_T_link @ own_pose(inertial, self.where))
        return Inertia(number_of(inertial, "mass", 1.0, self.where), at, (ixx, ixy, ixz, iyy, iyz, izz))

    def _shapes(self, link: ET.Element, frame_T_link: Matrix) -> Iterator[tuple[str, Geometry]]:
        """Name and shape of each that something can collide with."""
        for collision in link.findall("collision"):
            pose = collision.find("pose")
            base = None if pose is None else pose.get("relative_to")
            start = frame_T_link if not base else between(self._frame(link.get("name", "")), self._at(base))
            geometry = collision.find("geometry")
            shapes = [] if geometry is None else list(geometry)
            where = f"collision '{collision.get('name')}' of '{self.prefix}{link.get('name')}'"
            found = self._shape(shapes[0], start @ own_pose(collision, self.where), where) if shapes else None
            if found is not None:
                yield collision.get("name", ""), found
            else:
                word = shapes[0].tag if shapes else "nothing"
                self.odd.append(f"not carried over: {word}, which nothing can collide with: {where}")

    def _shape(self, shape: ET.Element, at: Matrix, where: str) -> Geometry | None:
        if shape.tag == "mesh":
            return self._mesh(shape, at, where)
        if shape.tag == "plane":
            normal = shape.find("normal")
            return half_space(at) if normal is None else half_space(at, numbers_of(normal, 3, self.where))
        if shape.tag not in SIZES:
            return None
        kind, tags = SIZES[shape.tag]
        sizes = [number for tag in tags for number in self._sizes(shape, tag, where)]
        if min(sizes) <= 0:
            raise UrdfError(f"{self.path}: {where}: {shape.tag} of {sizes}", allowed="above 0 m")
        return Geometry(kind, pose_of(at), tuple(sizes))

    def _sizes(self, shape: ET.Element, tag: str, where: str) -> list[float]:
        element = shape.find(tag)
        if element is None:
            raise UrdfError(f"{self.path}: {where}: {shape.tag} has no <{tag}>", allowed=f"<{tag}> [m]")
        return numbers_of(element, 3 if tag == "size" else 1, self.where)

    def _mesh(self, shape: ET.Element, at: Matrix, where: str) -> Geometry:
        reference = shape.findtext("uri", "").strip().replace("model://", PACKAGE, 1)
        if shape.find("submesh") is not None:
            raise UrdfError(f"{self.path}: {where} is a part of a mesh", allowed="whole mesh files")
        file = collision_file(reference, self.path, f"{self.path}: {where}")
        scale = shape.find("scale")
        sizes = (1.0, 1.0, 1.0) if scale is None else tuple(numbers_of(scale, 3, self.where))
        return Geometry(ShapeType.MESH, pose_of(at), sizes, str(file), mesh_hash(file))
