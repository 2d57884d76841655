"""URDF or xacro file → Mechanism."""

import math
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Final
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
from sdt_kg.urdf.document import parse_xml
from sdt_kg.urdf.joints import checked, resolved, turned, with_fixed
from sdt_kg.urdf.meshes import mesh_hash, mesh_path
from sdt_kg.urdf.xacro import expanded

XACRO: Final = ".xacro"

Three = tuple[float, float, float]

USUAL_MOMENTS: Final = {"ixx": 1.0, "ixy": 0.0, "ixz": 0.0, "iyy": 1.0, "iyz": 0.0, "izz": 1.0}
"""[kg m²] Of a URDF that does not write them."""


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


def _joint(joint: ET.Element) -> Joint:
    kind = JointType(joint.get("type"))
    movable = kind is not JointType.FIXED
    return Joint(
        name=joint.get("name", ""),
        type=kind,
        parent=_link(joint, "parent"),
        child=_link(joint, "child"),
        origin=_pose(joint.find("origin")),
        axis=_three(joint.find("axis"), "xyz", (1.0, 0.0, 0.0)) if movable else (1.0, 0.0, 0.0),
        limits=_limits(kind, joint.find("limit")) if movable else Limits(),
        mimic=_mimic(joint.find("mimic")),
    )


def _link(joint: ET.Element, tag: str) -> str:
    end = joint.find(tag)
    assert end is not None, "parse_xml looked for it"
    return end.get("link", "")


def _limits(kind: JointType, limit: ET.Element | None) -> Limits:
    """URDF's defaults: positions 0 where not written; speed and effort without bound."""
    if limit is None:
        return Limits()
    lower, upper = (float(limit.get(bound, 0.0)) for bound in ("lower", "upper"))
    velocity, effort = (float(limit.get(bound, math.inf)) for bound in ("velocity", "effort"))
    if kind is JointType.CONTINUOUS:
        return Limits(velocity=velocity, effort=effort)
    return Limits(lower=lower, upper=upper, velocity=velocity, effort=effort)


def _mimic(mimic: ET.Element | None) -> Mimic | None:
    if mimic is None:
        return None
    return Mimic(mimic.get("joint", ""), float(mimic.get("multiplier", 1.0)), float(mimic.get("offset", 0.0)))


def _body(link: ET.Element, source: Path) -> Body:
    name = link.get("name", "")
    where = f"{source}: link '{name}'"
    return Body(
        name=name,
        inertia=_inertia(link.find("inertial")),
        collision=tuple(_geometry(each, source, where) for each in link.findall("collision")),
    )


def _inertia(inertial: ET.Element | None) -> Inertia | None:
    mass = None if inertial is None else inertial.find("mass")
    if inertial is None or mass is None:
        return None
    moments = inertial.find("inertia")
    if moments is None:
        six = (0.0,) * 6
    else:
        six = tuple(float(moments.get(name, usual)) for name, usual in USUAL_MOMENTS.items())
    ixx, ixy, ixz, iyy, iyz, izz = six
    pose = _pose(inertial.find("origin"))
    return Inertia(float(mass.get("value", 0.0)), pose, (ixx, ixy, ixz, iyy, iyz, izz))


def _geometry(collision: ET.Element, source: Path, where: str) -> Geometry:
    pose, geometry = _pose(collision.find("origin")), collision.find("geometry")
    assert geometry is not None, "parse_xml looked for it"
    (shape,) = geometry
    if shape.tag == "box":
        return Geometry(ShapeType.BOX, pose, _three(shape, "size", (0.0, 0.0, 0.0)))
    if shape.tag == "cylinder":
        return Geometry(ShapeType.CYLINDER, pose, (_number(shape, "radius"), _number(shape, "length")))
    if shape.tag == "sphere":
        return Geometry(ShapeType.SPHERE, pose, (_number(shape, "radius"),))
    path = mesh_path(shape.get("filename", ""), source, where)
    scale = _three(shape, "scale", (1.0, 1.0, 1.0))
    return Geometry(ShapeType.MESH, pose, scale, str(path), mesh_hash(path))


def _number(element: ET.Element, name: str) -> float:
    return float(element.get(name, ""))  # parse_xml looked whether it is there, and a number


def _three(element: ET.Element | None, name: str, usual: Three) -> Three:
    """Three numbers, the usual ones where nothing is written."""
    text = None if element is None else element.get(name)
    if text is None:
        return usual
    x, y, z = map(float, text.split())
    return x, y, z


def _pose(origin: ET.Element | None) -> Pose:
    if origin is None:
        return Pose()
    none = (0.0, 0.0, 0.0)
    x, y, z = _three(origin, "xyz", none)
    return Pose((x + 0.0, y + 0.0, z + 0.0), _turned(*_three(origin, "rpy", none)))  # -0 is written as 0


def _turned(roll: float, pitch: float, yaw: float) -> tuple[float, float, float, float]:
    """Unit quaternion xyzw of turns about the parent's own x, then y, then z."""
    if roll == pitch == yaw == 0:
        return (0.0, 0.0, 0.0, 1.0)
    angles = np.array((roll, pitch, yaw))
    si, sj, sk = np.sin(angles).tolist()
    ci, cj, ck = np.cos(angles).tolist()
    cc, cs, sc, ss = ci * ck, ci * sk, si * ck, si * sk
    return _quaternion(
        (cj * ck, sj * sc - cs, sj * cc + ss), (cj * sk, sj * ss + cc, sj * cs - sc), (-sj, cj * si, cj * ci)
    )


def quaternion(rotation: NDArray[np.float64]) -> tuple[float, float, float, float]:
    """Unit quaternion xyzw, w ≥ 0, of a rotation matrix, shape (3, 3)."""
    return _quaternion(*rotation.tolist())


def _quaternion(first: Three, second: Three, third: Three) -> tuple[float, float, float, float]:
    """The same of its rows: Shepperd's method."""
    (a, b, c), (d, e, f), (g, h, i) = first, second, third
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
