"""URDF or xacro file → Mechanism."""

import io
import logging
import math
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Final
from xml.etree import ElementTree as ET

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import UrdfError
from sdt_kg.mechanism import (
    Body,
    Geometry,
    Inertia,
    Joint,
    JointType,
    Limits,
    Mechanism,
    Mimic,
    Pose,
    ShapeType,
)
from sdt_kg.urdf.degrees import maybe_degrees
from sdt_kg.urdf.document import parse_xml
from sdt_kg.urdf.inertias import with_possible
from sdt_kg.urdf.joints import checked, resolved, turned, with_fixed, within_soft_limits
from sdt_kg.urdf.loader import yourdfpy
from sdt_kg.urdf.meshes import collision_file, mesh_hash
from sdt_kg.urdf.spelling import limits_given_twice
from sdt_kg.urdf.xacro import expanded

XACRO: Final = ".xacro"

# yourdfpy has no types of its own: what it returns enters here and leaves as Mechanism.
Parsed = Any

logging.getLogger("yourdfpy").setLevel(logging.ERROR)


def read_mechanism(path: str | Path, *, name: str | None = None, turn_axes: bool = False) -> Mechanism:
    """The kinematic tree of a URDF or xacro file.

    Args:
        path: `NAME.urdf`, `NAME.xacro` or `NAME.urdf.xacro`.
        name: Name of the model; by default the stem of the file.
        turn_axes: For kitchens: joints with limits like [-π/2, 0] are turned to [0, π/2], and nothing but
            their stops ends them. Robots keep their signs, since their motions come from elsewhere; a
            `safety_controller` of theirs ends a joint at its soft limits, short of the stops, and slows
            it before them.

    Raises:
        UrdfError: Not a valid, tree-shaped URDF, or a collision mesh is missing.
    """
    source = Path(path)
    text = _text(source)
    root = parse_xml(text, source)
    robot = _parsed(root, source)
    joints = [checked(_joint(joint), source) for joint in robot.joints]
    if not turn_axes:
        soft = {str(joint.name): joint.safety_controller for joint in robot.joints}
        joints = [within_soft_limits(joint, _soft_limits(soft[joint.name]), source) for joint in joints]
    joints = with_fixed(resolved(joints, source))
    if turn_axes:
        joints = turned(joints)
    children = {joint.child for joint in joints}
    bodies, notes = with_possible(_body(link, source) for link in robot.links)
    return Mechanism(
        name=name or model_stem(source),
        root=next(body.name for body in bodies if body.name not in children),
        bodies=bodies,
        joints=_ordered(joints),
        notes=(*_visual_only(root), *limits_given_twice(root), *maybe_degrees(root, joints), *notes),
    )


def model_stem(path: Path) -> str:
    """Name of a model after its file: `my.urdf.xacro` is `my`, whatever the locale.

    Raises:
        UrdfError: The file's name is no text.
    """
    try:
        name = os.fsencode(path.name).decode()
    except UnicodeDecodeError:
        raise UrdfError(
            f"the name of {os.fsencode(path)!r} is no text", allowed="UTF-8", remedy="rename the file"
        ) from None
    return name.removesuffix(XACRO).removesuffix(".urdf")


def _text(path: Path) -> bytes:
    if not path.is_file():
        raise UrdfError(f"no file at {path}", allowed="a .urdf or .xacro file")
    return expanded(path) if path.suffix == XACRO else path.read_bytes()


def _parsed(root: ET.Element, source: Path) -> Parsed:
    """What yourdfpy reads; it gets links and joints only, without visuals and materials."""
    bare = ET.Element("robot", {"name": root.get("name", source.stem)})
    for element in (*root.findall("link"), *root.findall("joint")):
        kept = ET.SubElement(bare, element.tag, element.attrib)
        kept.extend(part for part in element if part.tag != "visual")
    try:
        model = yourdfpy().URDF.load(
            io.BytesIO(ET.tostring(bare)),
            build_scene_graph=False,
            build_collision_scene_graph=False,
            load_meshes=False,
            load_collision_meshes=False,
        )
    except (ValueError, KeyError, AttributeError, IndexError, TypeError, RecursionError) as error:
        raise UrdfError(f"{source}: yourdfpy cannot read it: {error}") from None
    return model.robot


def _joint(joint: Parsed) -> Joint:
    kind = JointType(joint.type)
    x, y, z = (float(part) for part in joint.axis)
    movable = kind is not JointType.FIXED
    return Joint(
        name=str(joint.name),
        type=kind,
        parent=str(joint.parent),
        child=str(joint.child),
        origin=_pose(joint.origin),
        axis=(x, y, z) if movable else (1.0, 0.0, 0.0),
        limits=_limits(kind, joint.limit) if movable else Limits(),
        mimic=_mimic(joint.mimic),
        notes=_unwritten(joint.limit) if kind in {JointType.REVOLUTE, JointType.PRISMATIC} else (),
    )


def _unwritten(limit: Parsed) -> tuple[str, ...]:
    """Which ends of a joint are not in the file, if it cannot move for that."""
    ends = {"lower": limit.lower, "upper": limit.upper}
    lacking = [name for name, bound in ends.items() if bound is None]
    if not lacking or any(ends.values()):
        return ()
    return (f"its <limit> has no {' and no '.join(lacking)}, which URDF takes for 0",)


def _limits(kind: JointType, limit: Parsed) -> Limits:
    """URDF's defaults: positions 0 where not written; speed and effort without bound."""
    if limit is None:
        return Limits()
    lower, upper = (0.0 if bound is None else float(bound) for bound in (limit.lower, limit.upper))
    velocity, effort = (
        math.inf if bound is None else float(bound) for bound in (limit.velocity, limit.effort)
    )
    if kind is JointType.CONTINUOUS:
        return Limits(velocity=velocity, effort=effort)
    return Limits(lower=lower, upper=upper, velocity=velocity, effort=effort)


def _soft_limits(safety: Parsed) -> Limits | None:
    """Those of a safety controller, 0 where it gives one of them only; URDF has none to be 0 and 0."""
    if safety is None:
        return None
    lower, upper, gain = (
        0.0 if one is None else float(one)
        for one in (safety.soft_lower_limit, safety.soft_upper_limit, safety.k_position)
    )
    return Limits(lower, upper, gain=gain or math.inf) if (lower, upper) != (0.0, 0.0) else None


def _mimic(mimic: Parsed) -> Mimic | None:
    if mimic is None:
        return None
    return Mimic(str(mimic.joint), float(mimic.multiplier), float(mimic.offset))


def _body(link: Parsed, source: Path) -> Body:
    where = f"{source}: link '{link.name}'"
    return Body(
        name=str(link.name),
        inertia=_inertia(link.inertial),
        collision=tuple(_geometry(collision, source, where) for collision in link.collisions),
    )


def _inertia(inertial: Parsed) -> Inertia | None:
    if inertial is None or inertial.mass is None:
        return None
    moments = np.zeros((3, 3)) if inertial.inertia is None else inertial.inertia
    ixx, ixy, ixz, iyy, iyz, izz = (
        float(moments[row, column]) for row, column in zip(*np.triu_indices(3), strict=True)
    )
    return Inertia(float(inertial.mass), _pose(inertial.origin), (ixx, ixy, ixz, iyy, iyz, izz))


def _geometry(collision: Parsed, source: Path, where: str) -> Geometry:
    pose, shape = _pose(collision.origin), collision.geometry
    if shape.box is not None:
        return Geometry(ShapeType.BOX, pose, tuple(float(length) for length in shape.box.size))
    if shape.cylinder is not None:
        size = (float(shape.cylinder.radius), float(shape.cylinder.length))
        return Geometry(ShapeType.CYLINDER, pose, size)
    if shape.sphere is not None:
        return Geometry(ShapeType.SPHERE, pose, (float(shape.sphere.radius),))
    path = collision_file(str(shape.mesh.filename), source, where)
    return Geometry(ShapeType.MESH, pose, _scale(shape.mesh.scale), str(path), mesh_hash(path))


def _scale(scale: Parsed) -> tuple[float, ...]:
    if scale is None:
        return (1.0, 1.0, 1.0)
    return tuple(float(part) for part in scale)


def _pose(parent_T_child: NDArray[np.float64] | None) -> Pose:
    if parent_T_child is None:
        return Pose()
    x, y, z = (float(part) for part in parent_T_child[:3, 3])
    return Pose((x, y, z), quaternion(parent_T_child[:3, :3]))


def quaternion(rotation: NDArray[np.float64]) -> tuple[float, float, float, float]:
    """Unit quaternion xyzw, w ≥ 0, of a rotation matrix, shape (3, 3): Shepperd's method."""
    (a, b, c), (d, e, f), (g, h, i) = rotation.tolist()
    squares = (1 + a - e - i, 1 - a + e - i, 1 - a - e + i, 1 + a + e + i)
    largest = max(range(4), key=squares.__getitem__)
    rows = (
        (squares[0], b + d, c + g, h - f),
        (b + d, squares[1], f + h, c - g),
        (c + g, f + h, squares[2], d - b),
        (h - f, c - g, d - b, squares[3]),
    )
    row = rows[largest]
    norm = math.copysign(math.sqrt(sum(part * part for part in row)), row[3])
    x, y, z, w = (part / norm + 0.0 for part in row)
    return x, y, z, w


def _ordered(joints: Iterable[Joint]) -> tuple[Joint, ...]:
    """Parents before children, else in file order."""
    waiting: dict[str, list[Joint]] = {}
    for joint in joints:
        waiting.setdefault(joint.parent, []).append(joint)
    children = {joint.child for group in waiting.values() for joint in group}
    done: list[Joint] = []
    stack = [parent for parent in waiting if parent not in children]
    while stack:
        group = waiting.get(stack.pop(), [])
        done += group
        stack += [joint.child for joint in reversed(group)]
    return tuple(done)


def _visual_only(root: ET.Element) -> tuple[str, ...]:
    names = [
        link.get("name", "")
        for link in root.findall("link")
        if link.find("visual") is not None and link.find("collision") is None
    ]
    if not names:
        return ()
    return (
        f"links with a visual but no collision geometry, which nothing can collide with: {', '.join(names)}",
    )
