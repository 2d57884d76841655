"""Small writers of MJCF and SDF, and forward kinematics, to check the readers against."""

import math
from xml.etree import ElementTree as ET

import numpy as np
from numpy.typing import NDArray

from sdt_kg.mechanism import Geometry, Joint, JointType, Mechanism, Pose, ShapeType

Matrix = NDArray[np.float64]


def forward(mechanism: Mechanism, positions: dict[str, float]) -> dict[str, Matrix]:
    """Body name → world_T_body, mimicking joints following; fixed ones stay."""
    frames = {mechanism.root: np.eye(4)}
    for joint in mechanism.joints:
        at = positions.get(joint.name, 0.0)
        if joint.mimic is not None:
            at = joint.mimic.multiplier * positions.get(joint.mimic.joint, 0.0) + joint.mimic.offset
        frames[joint.child] = frames[joint.parent] @ joint.origin.matrix() @ _moved(joint, at)
    return frames


def _moved(joint: Joint, at: float) -> Matrix:
    x, y, z = joint.axis
    if joint.type is JointType.FIXED:
        return np.eye(4)
    if joint.type is JointType.PRISMATIC:
        return Pose((x * at, y * at, z * at)).matrix()
    half = at / 2
    return Pose((0, 0, 0), (*(part * math.sin(half) for part in joint.axis), math.cos(half))).matrix()


def shapes_in_world(
    mechanism: Mechanism, positions: dict[str, float]
) -> list[tuple[str, Matrix, tuple[float, ...]]]:
    """Kind, world_T_shape and size of every collision shape, in the order of their bodies' names."""
    frames = forward(mechanism, positions)
    return [
        (f"{body.name} {number} {shape.shape.value}", frames[body.name] @ shape.pose.matrix(), shape.size)
        for body in sorted(mechanism.bodies, key=lambda body: body.name)
        for number, shape in enumerate(body.collision)
    ]


def text(values: object) -> str:
    return " ".join(repr(float(value)) for value in values)  # type: ignore[attr-defined]


def mjcf(mechanism: Mechanism) -> str:
    """The mechanism as MJCF, its root the world body."""
    top = ET.Element("mujoco")
    ET.SubElement(top, "compiler", {"angle": "radian", "boundmass": "1e-9", "boundinertia": "1e-9"})
    world = ET.SubElement(top, "worldbody")
    equality = ET.SubElement(top, "equality")
    elements = {mechanism.root: world}
    bodies = {body.name: body for body in mechanism.bodies}
    _mjcf_geoms(world, bodies[mechanism.root].collision)
    for joint in mechanism.joints:
        element = ET.SubElement(
            elements[joint.parent], "body", {"name": joint.child, **_mjcf_pose(joint.origin)}
        )
        elements[joint.child] = element
        if joint.type is not JointType.FIXED:
            _mjcf_joint(element, joint)
        _mjcf_geoms(element, bodies[joint.child].collision)
        inertia = bodies[joint.child].inertia
        if inertia is not None:
            ixx, ixy, ixz, iyy, iyz, izz = inertia.moments
            moments = {"fullinertia": text((ixx, iyy, izz, ixy, ixz, iyz)), "mass": text([inertia.mass])}
            ET.SubElement(element, "inertial", {**_mjcf_pose(inertia.pose), **moments})
        if joint.mimic is not None:
            coefficients = text((joint.mimic.offset, joint.mimic.multiplier, 0, 0, 0))
            names = {"joint1": joint.name, "joint2": joint.mimic.joint}
            ET.SubElement(equality, "joint", {**names, "polycoef": coefficients})
    return ET.tostring(top, encoding="unicode")


def _mjcf_joint(element: ET.Element, joint: Joint) -> None:
    kind = "slide" if joint.type is JointType.PRISMATIC else "hinge"
    bounded = joint.type is not JointType.CONTINUOUS
    ranged = {"range": text((joint.limits.lower, joint.limits.upper))} if bounded else {}
    forced = (
        {}
        if math.isinf(joint.limits.effort)
        else {"actuatorfrcrange": text((-joint.limits.effort, joint.limits.effort))}
    )
    ET.SubElement(
        element, "joint", {"name": joint.name, "type": kind, "axis": text(joint.axis), **ranged, **forced}
    )


def _mjcf_pose(pose: Pose) -> dict[str, str]:
    x, y, z, w = pose.orientation
    return {"pos": text(pose.position), "quat": text((w, x, y, z))}


def _mjcf_geoms(element: ET.Element, shapes: tuple[Geometry, ...]) -> None:
    for shape in shapes:
        halves = {ShapeType.BOX: (0.5, 0.5, 0.5), ShapeType.SPHERE: (1.0,)}.get(shape.shape, (1.0, 0.5))
        size = [part * half for part, half in zip(shape.size, halves, strict=True)]
        ET.SubElement(
            element, "geom", {"type": shape.shape.value, "size": text(size), **_mjcf_pose(shape.pose)}
        )


def sdf(mechanism: Mechanism) -> str:
    """The mechanism as SDF: links posed in the model, joints in the links that they carry."""
    top = ET.Element("sdf", {"version": "1.11"})
    model = ET.SubElement(top, "model", {"name": mechanism.name})
    ET.SubElement(model, "static").text = "true"
    frames = forward(mechanism, {})
    for body in mechanism.bodies:
        if body.name == "world":  # SDF's own name for what models stand in
            continue
        link = ET.SubElement(model, "link", {"name": body.name})
        _sdf_pose(link, frames[body.name])
        for number, shape in enumerate(body.collision):
            collision = ET.SubElement(link, "collision", {"name": f"c{number}"})
            _sdf_pose(collision, shape.pose.matrix())
            form = ET.SubElement(ET.SubElement(collision, "geometry"), shape.shape.value)
            tags = {ShapeType.BOX: ("size",), ShapeType.SPHERE: ("radius",)}.get(
                shape.shape, ("radius", "length")
            )
            for tag, value in zip(tags, [shape.size] if tags == ("size",) else shape.size, strict=True):
                ET.SubElement(form, tag).text = text(value if isinstance(value, tuple) else [value])
        if body.inertia is not None:
            inertial = ET.SubElement(link, "inertial")
            _sdf_pose(inertial, body.inertia.pose.matrix())
            ET.SubElement(inertial, "mass").text = text([body.inertia.mass])
            inertia = ET.SubElement(inertial, "inertia")
            for tag, value in zip(
                ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), body.inertia.moments, strict=True
            ):
                ET.SubElement(inertia, tag).text = text([value])
    for joint in mechanism.joints:
        _sdf_joint(model, joint)
    return ET.tostring(top, encoding="unicode")


def _sdf_pose(element: ET.Element, transform: Matrix) -> None:
    from sdt_kg.urdf import quaternion  # noqa: PLC0415 - test-side only

    pose = ET.SubElement(element, "pose", {"rotation_format": "quat_xyzw"})
    pose.text = text((*transform[:3, 3], *quaternion(transform[:3, :3])))


def _sdf_joint(model: ET.Element, joint: Joint) -> None:
    element = ET.SubElement(model, "joint", {"name": joint.name, "type": joint.type.value})
    ET.SubElement(element, "parent").text = joint.parent
    ET.SubElement(element, "child").text = joint.child
    if joint.type is JointType.FIXED:
        return
    axis = ET.SubElement(element, "axis")
    ET.SubElement(axis, "xyz").text = text(joint.axis)
    limit = ET.SubElement(axis, "limit")
    for tag in ("lower", "upper", "velocity", "effort"):
        value = getattr(joint.limits, tag)
        if math.isfinite(value):
            ET.SubElement(limit, tag).text = text([value])
    if joint.mimic is not None:
        mimic = ET.SubElement(axis, "mimic", {"joint": joint.mimic.joint})
        ET.SubElement(mimic, "multiplier").text = text([joint.mimic.multiplier])
        ET.SubElement(mimic, "offset").text = text([joint.mimic.offset])
