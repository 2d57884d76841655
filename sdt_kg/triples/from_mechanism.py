"""Mechanism → triples, exactly: `to_mechanism` reads back an equal value. No blank nodes."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import pyoxigraph as ox

from sdt_kg.iri import RDFS, SDT, Iri, body_iri, joint_iri, model_iri
from sdt_kg.mechanism import Body, Geometry, Inertia, Joint, JointType, Mechanism, Pose, ShapeType
from sdt_kg.store import Triple, double
from sdt_kg.triples.facts import TYPE

JOINT_CLASSES: Final = {
    JointType.FIXED: "FixedJoint",
    JointType.PRISMATIC: "PrismaticJoint",
    JointType.REVOLUTE: "RevoluteJoint",
    JointType.CONTINUOUS: "ContinuousJoint",
}
SHAPE_CLASSES: Final = {
    ShapeType.BOX: "Box",
    ShapeType.SPHERE: "Sphere",
    ShapeType.CYLINDER: "Cylinder",
    ShapeType.CAPSULE: "Capsule",
    ShapeType.MESH: "Mesh",
}
SIZES: Final = {
    ShapeType.BOX: ("sizeX", "sizeY", "sizeZ"),
    ShapeType.SPHERE: ("radius",),
    ShapeType.CYLINDER: ("radius", "length"),
    ShapeType.CAPSULE: ("radius", "length"),
    ShapeType.MESH: ("scaleX", "scaleY", "scaleZ"),
}
POSE: Final = ("x", "y", "z", "qx", "qy", "qz", "qw")
MOMENTS: Final = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
LIMITS: Final = {
    "lower": "lowerLimit",
    "upper": "upperLimit",
    "velocity": "velocityLimit",
    "acceleration": "accelerationLimit",
    "effort": "effortLimit",
    "gain": "softLimitGain",
}


def mechanism_triples(mechanism: Mechanism, kind: str) -> Iterator[Triple]:
    """All that the mechanism says; `kind` is `Environment` or `Robot`."""
    model = model_iri(mechanism.name)
    yield model, TYPE, _sdt(kind)
    yield model, SDT + "rootBody", ox.NamedNode(body_iri(mechanism.name, mechanism.root))
    for order, note in enumerate(mechanism.notes):
        yield from _note(model, order, note)
    for order, body in enumerate(mechanism.bodies):
        yield from _body(mechanism.name, body, order)
    for order, joint in enumerate(mechanism.joints):
        yield from _joint(mechanism.name, joint, order)


def _sdt(name: str) -> ox.NamedNode:
    return ox.NamedNode(SDT + name)


def _head(iri: Iri, model: str, kind: str, name: str, order: int) -> Iterator[Triple]:
    yield iri, TYPE, _sdt(kind)
    yield iri, RDFS + "label", ox.Literal(name)
    yield iri, SDT + "name", ox.Literal(name)
    yield iri, SDT + "partOf", ox.NamedNode(model_iri(model))
    yield iri, SDT + "index", ox.Literal(order)


def _note(subject: Iri, order: int, text: str) -> Iterator[Triple]:
    note = f"{subject}/note/{order}"
    yield subject, SDT + "hasNote", ox.NamedNode(note)
    yield note, TYPE, _sdt("Note")
    yield note, RDFS + "comment", ox.Literal(text)
    yield note, SDT + "index", ox.Literal(order)


def pose_triples(iri: Iri, pose: Pose) -> Iterator[Triple]:
    """An individual for the pose."""
    yield iri, TYPE, _sdt("Pose")
    for name, value in zip(POSE, (*pose.position, *pose.orientation), strict=True):
        yield iri, SDT + name, double(value)


def _body(model: str, body: Body, order: int) -> Iterator[Triple]:
    iri = body_iri(model, body.name)
    yield from _head(iri, model, "Body", body.name, order)
    if body.inertia is not None:
        yield iri, SDT + "hasInertia", ox.NamedNode(f"{iri}/inertia")
        yield from _inertia(f"{iri}/inertia", body.inertia)
    for number, geometry in enumerate(body.collision):
        shape = f"{iri}/collision/{number}"
        yield iri, SDT + "hasCollisionGeometry", ox.NamedNode(shape)
        yield shape, SDT + "index", ox.Literal(number)
        yield from _geometry(shape, geometry)


def _inertia(iri: Iri, inertia: Inertia) -> Iterator[Triple]:
    yield iri, TYPE, _sdt("Inertia")
    yield iri, SDT + "mass", double(inertia.mass)
    yield iri, SDT + "hasPose", ox.NamedNode(f"{iri}/pose")
    yield from pose_triples(f"{iri}/pose", inertia.pose)
    for name, value in zip(MOMENTS, inertia.moments, strict=True):
        yield iri, SDT + name, double(value)


def _geometry(iri: Iri, geometry: Geometry) -> Iterator[Triple]:
    yield iri, TYPE, _sdt(SHAPE_CLASSES[geometry.shape])
    yield iri, SDT + "hasPose", ox.NamedNode(f"{iri}/pose")
    yield from pose_triples(f"{iri}/pose", geometry.pose)
    for name, value in zip(SIZES[geometry.shape], geometry.size, strict=True):
        yield iri, SDT + name, double(value)
    if geometry.mesh_file:
        yield iri, SDT + "meshFile", ox.NamedNode(Path(geometry.mesh_file).as_uri())
        yield iri, SDT + "meshHash", ox.Literal(geometry.mesh_hash)


def _joint(model: str, joint: Joint, order: int) -> Iterator[Triple]:
    iri = joint_iri(model, joint.name)
    yield from _head(iri, model, JOINT_CLASSES[joint.type], joint.name, order)
    yield iri, SDT + "parent", ox.NamedNode(body_iri(model, joint.parent))
    yield iri, SDT + "child", ox.NamedNode(body_iri(model, joint.child))
    yield iri, SDT + "hasOrigin", ox.NamedNode(f"{iri}/origin")
    yield from pose_triples(f"{iri}/origin", joint.origin)
    for name, value in zip(("axisX", "axisY", "axisZ"), joint.axis, strict=True):
        yield iri, SDT + name, double(value)
    for attribute, name in LIMITS.items():
        value: float = getattr(joint.limits, attribute)
        if math.isfinite(value):
            yield iri, SDT + name, double(value)
    if joint.mimic is not None:
        yield iri, SDT + "mimics", ox.NamedNode(joint_iri(model, joint.mimic.joint))
        yield iri, SDT + "mimicMultiplier", double(joint.mimic.multiplier)
        yield iri, SDT + "mimicOffset", double(joint.mimic.offset)
    for number, note in enumerate(joint.notes):
        yield from _note(iri, number, note)
