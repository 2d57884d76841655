"""URDF or xacro file → Mechanism."""

import importlib
import math
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
from sdt_kg.urdf.document import parse_xml, refuse_unsafe
from sdt_kg.urdf.joints import checked, resolved, turned, with_fixed
from sdt_kg.urdf.meshes import mesh_hash, mesh_path

XACRO: Final = ".xacro"

Xacro = Any  # xacro has no types of its own: what it returns enters here and leaves as text


def read_mechanism(path: str | Path, *, name: str | None = None, turn_axes: bool = False) -> Mechanism:
    """The kinematic tree of a URDF or xacro file.

    Args:
        path: `NAME.urdf`, `NAME.xacro` or `NAME.urdf.xacro`.
        name: Name of the model; by default the stem of the file.
        turn_axes: For kitchens: joints with limits like [-π/2, 0] are turned to [0, π/2].
            Robots keep their signs, since their motions come from elsewhere.

    Raises:
        UrdfError: Not a valid, tree-shaped URDF, or a collision mesh is missing.
    """
    source = Path(path)
    text = _text(source)
    root = parse_xml(text, source)
    joints = [checked(_joint(joint), source) for joint in root.findall("joint")]
    joints = with_fixed(resolved(joints, source))
    if turn_axes:
        joints = turned(joints)
    children = {joint.child for joint in joints}
    bodies = tuple(_body(link, source) for link in root.findall("link"))
    return Mechanism(
        name=name or model_stem(source),
        root=next(body.name for body in bodies if body.name not in children),
        bodies=bodies,
        joints=_ordered(joints),
        notes=_visual_only(root),
    )


def model_stem(path: Path) -> str:
    """Name of a model after its file: `my.urdf.xacro` is `my`."""
    return path.name.removesuffix(XACRO).removesuffix(".urdf")


def _text(path: Path) -> bytes:
    if not path.is_file():
        raise UrdfError(f"no file at {path}", allowed="a .urdf or .xacro file")
    if path.suffix != XACRO:
        return path.read_bytes()
    xacro: Xacro = importlib.import_module("xacro")

    refuse_unsafe(path.read_bytes(), path)
    try:
        document = xacro.process_file(str(path))
    except RecursionError:
        raise UrdfError(f"{path}: a xacro macro calls itself without end") from None
    except (xacro.XacroException, ET.ParseError, SyntaxError, OSError, ValueError, KeyError) as error:
        said = " ".join(str(error).split())
        raise UrdfError(f"{path}: xacro says: {said}", remedy="run xacro on it by hand") from None
    return str(document.toxml()).encode()


def _joint(joint: ET.Element) -> Joint:
    kind = JointType(joint.get("type"))
    x, y, z = _numbers(joint.find("axis"), "xyz", "1 0 0")
    movable = kind is not JointType.FIXED
    return Joint(
        name=joint.get("name", ""),
        type=kind,
        parent=_end(joint, "parent"),
        child=_end(joint, "child"),
        origin=pose_of(joint),
        axis=(x, y, z) if movable else (1.0, 0.0, 0.0),
        limits=_limits(kind, joint.find("limit")) if movable else Limits(),
        mimic=_mimic(joint.find("mimic")),
    )


def _end(joint: ET.Element, tag: str) -> str:
    end = joint.find(tag)
    return "" if end is None else end.get("link", "")


def _limits(kind: JointType, limit: ET.Element | None) -> Limits:
    """URDF's defaults: positions 0 where not written; speed and effort without bound."""
    if limit is None:
        return Limits()
    lower, upper = _number(limit, "lower", 0.0), _number(limit, "upper", 0.0)
    velocity, effort = _number(limit, "velocity", math.inf), _number(limit, "effort", math.inf)
    if kind is JointType.CONTINUOUS:
        return Limits(velocity=velocity, effort=effort)
    return Limits(lower=lower, upper=upper, velocity=velocity, effort=effort)


def _mimic(mimic: ET.Element | None) -> Mimic | None:
    if mimic is None:
        return None
    return Mimic(mimic.get("joint", ""), _number(mimic, "multiplier", 1.0), _number(mimic, "offset", 0.0))


def _body(link: ET.Element, source: Path) -> Body:
    name = link.get("name", "")
    where = f"{source}: link '{name}'"
    return Body(
        name=name,
        inertia=_inertia(link.find("inertial")),
        collision=tuple(_geometry(collision, source, where) for collision in link.findall("collision")),
    )


def _inertia(inertial: ET.Element | None) -> Inertia | None:
    mass = None if inertial is None else inertial.find("mass")
    if inertial is None or mass is None:
        return None
    return Inertia(_number(mass, "value", 0.0), pose_of(inertial), _moments(inertial.find("inertia")))


def _moments(inertia: ET.Element | None) -> tuple[float, float, float, float, float, float]:
    """ixx, ixy, ixz, iyy, iyz, izz; where the element is there, its diagonal is 1 where not written."""
    if inertia is None:
        return (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    xx, yy, zz = (_number(inertia, name, 1.0) for name in ("ixx", "iyy", "izz"))
    xy, xz, yz = (_number(inertia, name, 0.0) for name in ("ixy", "ixz", "iyz"))
    return xx, xy, xz, yy, yz, zz


def _geometry(collision: ET.Element, source: Path, where: str) -> Geometry:
    (shape,) = collision.iterfind("geometry/*")
    pose = pose_of(collision)
    match shape.tag:
        case "box":
            return Geometry(ShapeType.BOX, pose, _numbers(shape, "size", ""))
        case "cylinder":
            size = (*_numbers(shape, "radius", ""), *_numbers(shape, "length", ""))
            return Geometry(ShapeType.CYLINDER, pose, size)
        case "sphere":
            return Geometry(ShapeType.SPHERE, pose, _numbers(shape, "radius", ""))
        case _:
            path = mesh_path(shape.get("filename", ""), source, where)
            scale = _numbers(shape, "scale", "1 1 1")
            return Geometry(ShapeType.MESH, pose, scale, str(path), mesh_hash(path))


def _number(element: ET.Element, attribute: str, default: float) -> float:
    return float(element.get(attribute, default))


def _numbers(element: ET.Element | None, attribute: str, default: str) -> tuple[float, ...]:
    text = default if element is None else element.get(attribute, default)
    return tuple(map(float, text.split()))


def pose_of(owner: ET.Element) -> Pose:
    """The `origin` of a joint, a collision or an inertial; roll, pitch, yaw turn about fixed axes."""
    origin = owner.find("origin")
    if origin is None:
        return Pose()
    x, y, z = (part + 0.0 for part in _numbers(origin, "xyz", "0 0 0"))
    angles = _numbers(origin, "rpy", "0 0 0")
    (si, sj, sk), (ci, cj, ck) = map(math.sin, angles), map(math.cos, angles)
    rotation = (
        (cj * ck, sj * (si * ck) - ci * sk, sj * (ci * ck) + si * sk),
        (cj * sk, sj * (si * sk) + ci * ck, sj * (ci * sk) - si * ck),
        (-sj, cj * si, cj * ci),
    )
    return Pose((x, y, z), quaternion(np.array(rotation)))


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
