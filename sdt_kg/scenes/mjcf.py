"""MJCF → Mechanism, by MuJoCo's own compiler: defaults, includes, angles and frames are its business."""

import importlib
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final
from xml.etree import ElementTree as ET

import numpy as np

from sdt_kg.errors import UrdfError
from sdt_kg.mechanism import Geometry, Inertia, JointType, Limits, Mechanism, ShapeType
from sdt_kg.scenes.attached import check_files
from sdt_kg.scenes.build import (
    HANDLE,
    Link,
    Matrix,
    Part,
    between,
    built,
    listed,
    matrix_of,
    pose_of,
    shift,
    turn,
)
from sdt_kg.scenes.constraints import BALL, FREE, HINGE, SLIDE, Constraints, name_of, reference_of
from sdt_kg.scenes.planes import half_space
from sdt_kg.urdf.degrees import WHOLE_TURN
from sdt_kg.urdf.folder import folder_of
from sdt_kg.urdf.meshes import collision_file, mesh_hash

# MuJoCo's stubs name no attribute of a compiled model: what it gives enters here.
Model = Any

SHAPES: Final = {
    2: ShapeType.SPHERE,
    3: ShapeType.CAPSULE,
    5: ShapeType.CYLINDER,
    6: ShapeType.BOX,
    7: ShapeType.MESH,
}
"""mjtGeom → our shape."""
PLANE: Final = 0
OTHER_SHAPES: Final = {1: "a height field", 4: "an ellipsoid", 8: "a signed distance field"}
NO_SPEEDS: Final = (
    "MJCF has no velocity limits: requests are out of scope until an annotation gives sdt:velocityLimit"
)
COUNTS: Final = {
    "nu": "actuators",
    "ntendon": "tendons",
    "nsensor": "sensors",
    "nsite": "sites",
    "nflex": "flexible bodies",
    "npair": "contact pairs",
    "nexclude": "contact exclusions",
    "nkey": "keyframes",
}


def read_mjcf(root: ET.Element, path: Path, name: str) -> Mechanism:
    """The scene; bodies that move freely are taken to be fixed where they stand, and noted.

    Raises:
        UrdfError: MuJoCo is not installed or does not read it, or a file lies outside the scene's folder.
    """
    check_files(root, path, folder_of(path))
    try:
        library: Model = importlib.import_module("mujoco")
    except ModuleNotFoundError:
        raise UrdfError(
            f"{path} is MJCF, which needs MuJoCo", remedy="pip install 'sdt-kg[scenes]'"
        ) from None
    try:
        model: Model = library.MjModel.from_xml_path(str(path.absolute()))
    except ValueError as error:
        said = " ".join(str(error).split())
        raise UrdfError(f"{path}: MuJoCo says: {said}") from None
    _check_meshes(library, model, path)
    return _Reader(library, model, path).mechanism(name)


def _check_meshes(library: Model, model: Model, path: Path) -> None:
    """That vertices are where mesh files have them: the compiled model does not say what moves them."""
    for mesh in library.MjSpec.from_file(str(path.absolute())).meshes if model.nmesh else ():
        if any(mesh.refpos) or any(mesh.refquat[1:]):
            raise UrdfError(
                f"{path}: mesh '{mesh.name}' has a frame of its own",
                allowed="meshes without refpos and refquat",
                remedy="shift and turn the vertices in the file, or the geom instead",
            )


@dataclass(frozen=True, slots=True)
class _Frame:
    """Where a MuJoCo body is: the part that carries it, and world_T_body with all joints at 0."""

    part: str
    world_T_body: Matrix


class _Reader:
    """One compiled model."""

    def __init__(self, library: Model, model: Model, path: Path) -> None:
        self.library, self.model, self.path = library, model, path
        self.parts: list[Part] = []
        self.links: list[Link] = []
        self.frozen: list[str] = []

    def mechanism(self, name: str) -> Mechanism:
        """The mechanism of all bodies."""
        self._check_solid()
        model = self.model
        frames = {0: _Frame("world", np.eye(4))}
        self.parts.append(Part("world", np.eye(4), None, tuple(self._shapes(0, np.eye(4)).values())))
        for body in range(1, model.nbody):
            frames[body] = self._body(body, frames[int(model.body_parentid[body])])
        links, other = Constraints(self.library, model, self.path).applied(self.links)
        return built(
            name, self.parts, links, [*self._notes(), *listed("equality constraints", other)], self.path
        )

    def _check_solid(self) -> None:
        """No shape that something may collide with is left out."""
        for geom, kind in enumerate(self.model.geom_type.tolist()):
            if kind in OTHER_SHAPES and self._collides(geom):
                raise UrdfError(
                    f"{self.path}: geom '{self._name('geom', geom)}' is {OTHER_SHAPES[kind]}",
                    allowed="box, sphere, cylinder, capsule, mesh, plane",
                    remedy="write it as a mesh, or with contype and conaffinity 0 if nothing is to meet it",
                )
        for flex in range(self.model.nflex):
            if self.model.flex_contype[flex] or self.model.flex_conaffinity[flex]:
                raise UrdfError(
                    f"{self.path}: '{self._name('flex', flex)}' is flexible",
                    allowed="rigid geoms",
                    remedy="write it as a mesh, or with contype and conaffinity 0 if nothing is to meet it",
                )

    def _name(self, kind: str, index: int) -> str:
        return name_of(self.library, self.model, kind, index)

    def _body(self, body: int, parent: _Frame) -> _Frame:
        """Add the body, and one part more for each joint beyond its first."""
        model, name = self.model, self._name("body", body)
        at = parent.world_T_body @ matrix_of(model.body_pos[body], _xyzw(model.body_quat[body]))
        first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
        joints = [joint for joint in range(first, first + count) if self._moves(joint)]
        carrier, frame = parent.part, at
        for joint in joints:
            last = joint == joints[-1]
            frame = at @ self._turned_back(joint) @ shift(self._anchor(joint))
            at = frame @ shift(self._anchor(joint), -1.0)
            part = name if last else f"{name}__{self._name('joint', joint)}"
            self._add(part, frame, at, body if last else None)
            self.links.append(self._link(joint, carrier, part))
            carrier = part
        if not joints:
            self._add(name, at, at, body)
            self.links.append(Link(f"{name}_fixed", JointType.FIXED, parent.part, name))
        return _Frame(name, at)

    def _add(self, part: str, frame: Matrix, world_T_body: Matrix, body: int | None) -> None:
        if body is None:
            self.parts.append(Part(part, frame))
            return
        frame_T_body = between(frame, world_T_body)
        shapes = self._shapes(body, frame_T_body)
        handle = tuple(one for geom, one in shapes.items() if HANDLE in self._name("geom", geom).lower())
        self.parts.append(
            Part(part, frame, self._inertia(body, frame_T_body), tuple(shapes.values()), handle)
        )

    def _moves(self, joint: int) -> bool:
        kind = int(self.model.jnt_type[joint])
        if kind in (FREE, BALL):
            word = "free" if kind == FREE else "ball"
            body = self._name("body", int(self.model.jnt_bodyid[joint]))
            self.frozen.append(f"'{self._name('joint', joint)}' ({word}) of body '{body}'")
        return kind in (SLIDE, HINGE)

    def _anchor(self, joint: int) -> list[float]:
        """Where the axis of a hinge passes, in the body's frame [m]."""
        return self.model.jnt_pos[joint].tolist() if self.model.jnt_type[joint] == HINGE else [0.0, 0.0, 0.0]

    def _turned_back(self, joint: int) -> Matrix:
        """The joint's motion from the position in which the file shows it to 0."""
        axis, reference = self.model.jnt_axis[joint], self._reference(joint)
        if self.model.jnt_type[joint] == SLIDE:
            return shift(axis, -reference)
        anchor = self._anchor(joint)
        return shift(anchor) @ turn(axis, -reference) @ shift(anchor, -1.0)

    def _reference(self, joint: int) -> float:
        return reference_of(self.model, joint)

    def _link(self, joint: int, parent: str, child: str) -> Link:
        model = self.model
        bounded, slides = bool(model.jnt_limited[joint]), model.jnt_type[joint] == SLIDE
        lower, upper = model.jnt_range[joint].tolist() if bounded else (-np.inf, np.inf)
        forced = bool(model.jnt_actfrclimited[joint])
        effort = float(np.abs(model.jnt_actfrcrange[joint]).max()) if forced else np.inf
        x, y, z = (float(part) for part in model.jnt_axis[joint])
        turns = JointType.REVOLUTE if bounded else JointType.CONTINUOUS
        kind = JointType.PRISMATIC if slides else turns
        limits = Limits(lower=lower, upper=upper, effort=effort)
        return Link(self._name("joint", joint), kind, parent, child, (x, y, z), limits)

    def _inertia(self, body: int, frame_T_body: Matrix) -> Inertia | None:
        model, mass = self.model, float(self.model.body_mass[body])
        if mass == 0:
            return None
        at = frame_T_body @ matrix_of(model.body_ipos[body], _xyzw(model.body_iquat[body]))
        x, y, z = (float(part) for part in model.body_inertia[body])
        return Inertia(mass, pose_of(at), (x, 0.0, 0.0, y, 0.0, z))

    def _shapes(self, body: int, frame_T_body: Matrix) -> dict[int, Geometry]:
        """Geom → shape, of those that can collide."""
        model, first = self.model, int(self.model.body_geomadr[body])
        found: dict[int, Geometry] = {}
        for geom in range(first, first + int(model.body_geomnum[body])):
            kind = int(model.geom_type[geom])
            if self._collides(geom) and (kind in SHAPES or kind == PLANE):
                at = frame_T_body @ matrix_of(model.geom_pos[geom], _xyzw(model.geom_quat[geom]))
                found[geom] = half_space(at) if kind == PLANE else self._shape(geom, SHAPES[kind], at)
        return found

    def _collides(self, geom: int) -> bool:
        model = self.model
        paired = geom in model.pair_geom1 or geom in model.pair_geom2
        return bool(model.geom_contype[geom] or model.geom_conaffinity[geom] or paired)

    def _shape(self, geom: int, shape: ShapeType, at: Matrix) -> Geometry:
        """One shape; MuJoCo gives half sizes, and meshes in the frame of their own inertia."""
        x, y, z = (float(part) for part in self.model.geom_size[geom])
        if shape is ShapeType.MESH:
            return self._mesh(geom, at)
        sizes = {ShapeType.BOX: (2 * x, 2 * y, 2 * z), ShapeType.SPHERE: (x,)}
        return Geometry(shape, pose_of(at), sizes.get(shape, (x, 2 * y)))

    def _mesh(self, geom: int, at: Matrix) -> Geometry:
        model, mesh = self.model, int(self.model.geom_dataid[geom])
        start = int(model.mesh_pathadr[mesh])
        where = f"{self.path}: geom '{self._name('geom', geom)}'"
        if start < 0:
            raise UrdfError(
                f"{where} is a mesh without file", allowed="a mesh file", remedy="write it to one"
            )
        reference = model.paths[start:].split(b"\0", 1)[0].decode()
        file = collision_file(reference, self.path, where)
        file_T_geom = matrix_of(model.mesh_pos[mesh], _xyzw(model.mesh_quat[mesh]))
        scale = tuple(float(part) for part in model.mesh_scale[mesh])
        pose = pose_of(at @ between(file_T_geom, np.eye(4)))
        return Geometry(ShapeType.MESH, pose, scale, str(file), mesh_hash(file))

    def _notes(self) -> list[str]:
        model = self.model
        notes = [NO_SPEEDS] if any(link.type is not JointType.FIXED for link in self.links) else []
        notes += ["masses are MuJoCo's, which takes a body's from its shapes where the file gives none"]
        notes += [f"imported as fixed where it stands: joint {each}" for each in self.frozen]
        notes += self._hardly_turning()
        visual = [g for g in range(model.ngeom) if not self._collides(g)]
        notes += listed("geoms that collide with nothing", [self._name("geom", g) for g in visual])
        for field, word in COUNTS.items():
            count = int(getattr(model, field, 0))
            notes += [f"not carried over: {count} {word}"] if count else []
        return notes

    def _hardly_turning(self) -> list[str]:
        """That ranges were read in degrees, if all of them would be plausible in radians alone."""
        hinges = [link.limits for link in self.links if link.type is JointType.REVOLUTE]
        farthest = max((max(abs(each.lower), abs(each.upper)) for each in hinges), default=math.inf)
        if farthest > math.radians(WHOLE_TURN):
            return []
        return [
            f"hinges turn by {farthest:.3g} rad at most: ranges are read in degrees, as MJCF has them where "
            'no <compiler angle="radian"/> says otherwise, and these may be in radians'
        ]


def _xyzw(quaternion: Matrix) -> list[float]:
    """MuJoCo writes w first."""
    w, x, y, z = quaternion.tolist()
    return [x, y, z, w]
