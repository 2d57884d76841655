"""Mechanisms as Pinocchio models, never from URDF files (ARCHITECTURE, decision 4).

Every movable joint is one real coordinate (nq = nv): continuous joints are revolute joints without
limits, mimic joints are coordinates of their own that follow their source, fixed joints vanish
into placements.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # found through a .pth file
from numpy.typing import NDArray

from sdt_kg.annotation import RobotAnnotation
from sdt_kg.errors import AnnotationError, UrdfError
from sdt_kg.iri import Iri, body_iri, joint_iri
from sdt_kg.mechanism import Inertia, Joint, JointType, Mechanism, Pose
from services.physics.placements import UNIVERSE, Placements

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


def se3(pose: Pose) -> pin.SE3:
    """The pose as Pinocchio's transform parent_T_child."""
    return pin.SE3(pose.matrix())


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """A mechanism's place in a model.

    Attributes:
        joints: Movable joints, in the order of their coordinates.
        first: Coordinate of the first of them.
        attached: Body → the model's joint that moves it, and joint_T_body.
    """

    mechanism: Mechanism
    joints: tuple[Joint, ...]
    first: int
    attached: dict[str, tuple[int, pin.SE3]]


@dataclass(frozen=True, slots=True, eq=False)
class Coupling:
    """q[k] = multiplier[k] · q[source[k]] + offset[k]; independent coordinates are their own source."""

    source: Indices
    multiplier: Array
    offset: Array

    def positions(self, q: Array) -> Array:
        """Positions, shape (…, nq), with mimicking coordinates set from their sources."""
        return q[..., self.source] * self.multiplier + self.offset

    def rates(self, v: Array) -> Array:
        """Velocities or accelerations, shape (…, nq), with mimicking coordinates set."""
        return v[..., self.source] * self.multiplier

    @property
    def independent(self) -> Indices:
        """The coordinates that may be chosen."""
        own = np.arange(len(self.source))
        return np.flatnonzero((self.source == own) & (self.multiplier == 1) & (self.offset == 0))


@dataclass(frozen=True, slots=True, eq=False)
class Bounds:
    """Limits of each coordinate, shape (nq,), in rad or m and seconds; `inf` where there is none.

    Attributes:
        gain: See `sdt_kg.mechanism.Limits` [1/s].
    """

    lower: Array
    upper: Array
    velocity: Array
    acceleration: Array
    gain: Array


def add(model: pin.Model, mechanism: Mechanism, parent: int, joint_T_root: pin.SE3) -> Part:
    """The mechanism hangs on a joint of the model, its bodies as frames that are named by their IRI."""
    attached = {mechanism.root: (parent, joint_T_root)}
    first, movable = model.nq, []
    for joint in mechanism.joints:
        carrier, carrier_T_parent = attached[joint.parent]
        carrier_T_joint = carrier_T_parent * se3(joint.origin)
        if joint.type is JointType.FIXED:
            attached[joint.child] = (carrier, carrier_T_joint)
            continue
        index = model.addJoint(
            carrier, _pin_joint(joint), carrier_T_joint, joint_iri(mechanism.name, joint.name)
        )
        attached[joint.child] = (index, pin.SE3.Identity())
        movable.append(joint)
    for body in mechanism.bodies:
        index, joint_T_body = attached[body.name]
        frame = pin.Frame(body_iri(mechanism.name, body.name), index, joint_T_body, pin.BODY)
        model.addFrame(frame)
        if body.inertia is not None:
            model.appendBodyToJoint(index, _inertia(body.inertia), joint_T_body)
    return Part(mechanism, tuple(movable), first, attached)


def _pin_joint(joint: Joint) -> pin.JointModel:
    axis = np.array(joint.axis)
    if joint.type is JointType.PRISMATIC:
        return pin.JointModelPrismaticUnaligned(axis)
    return pin.JointModelRevoluteUnaligned(axis)


def _inertia(inertia: Inertia) -> pin.Inertia:
    xx, xy, xz, yy, yz, zz = inertia.moments
    moments = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    centre = se3(inertia.pose)
    # Put in one by one: all at once, a moment that rounding leaves below 0 is an error to Pinocchio.
    whole = pin.Inertia.Zero()
    whole.mass, whole.lever = inertia.mass, centre.translation
    whole.inertia = centre.rotation @ moments @ centre.rotation.T
    return whole


def coupling(nq: int, parts: Sequence[Part]) -> Coupling:
    """Which coordinate follows which, with chains of mimic joints resolved to their first source."""
    source, multiplier, offset = np.arange(nq), np.ones(nq), np.zeros(nq)
    for part in parts:
        coordinate = {joint.name: part.first + i for i, joint in enumerate(part.joints)}
        for joint in part.joints:
            k = coordinate[joint.name]
            source[k], multiplier[k], offset[k] = _source(part, joint, coordinate)
    return Coupling(source, multiplier, offset)


def _source(part: Part, joint: Joint, coordinate: Mapping[str, int]) -> tuple[int, float, float]:
    by_name = {other.name: other for other in part.joints}
    multiplier, offset, seen = 1.0, 0.0, {joint.name}
    while joint.mimic is not None:
        offset += multiplier * joint.mimic.offset
        multiplier *= joint.mimic.multiplier
        if joint.mimic.joint not in by_name:  # a fixed joint: it stays at 0
            return coordinate[joint.name], 0.0, offset
        joint = by_name[joint.mimic.joint]
        if joint.name in seen:
            raise UrdfError(f"joint {joint.name} mimics itself", allowed="mimic joints without a loop")
        seen.add(joint.name)
    return coordinate[joint.name], multiplier, offset


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """One mechanism alone, its root in the world frame.

    Attributes:
        model: Pinocchio's. Joints and body frames are named by their IRI.
        placements: Where its joints are.
        coordinate: Joint IRI → coordinate.
    """

    model: pin.Model
    placements: Placements
    part: Part
    coupling: Coupling
    coordinate: dict[str, int]


def build(mechanism: Mechanism) -> Model:
    """The mechanism as a model of its own."""
    model = pin.Model()
    part = add(model, mechanism, UNIVERSE, pin.SE3.Identity())
    coordinate = {
        joint_iri(mechanism.name, joint.name): part.first + i for i, joint in enumerate(part.joints)
    }
    return Model(model, Placements(model), part, coupling(model.nq, [part]), coordinate)


def base_T_root(mechanism: Mechanism, annotation: RobotAnnotation) -> pin.SE3:
    """Where the root of a robot is in the frame of its base body.

    Raises:
        AnnotationError: The base body moves against the root.
    """
    root_T_body = {mechanism.root: pin.SE3.Identity()}
    for joint in mechanism.joints:
        if joint.type is JointType.FIXED and joint.parent in root_T_body:
            root_T_body[joint.child] = root_T_body[joint.parent] * se3(joint.origin)
    if annotation.base_body not in root_T_body:
        raise AnnotationError(
            f"base body {annotation.base_body} of {mechanism.name} moves against the root {mechanism.root}",
            allowed="a body that is rigidly attached to the root",
        )
    return root_T_body[annotation.base_body].inverse()


def exempt_pairs(mechanism: Mechanism, annotation: RobotAnnotation) -> set[frozenset[Iri]]:
    """Bodies (IRIs) whose contact is no self-collision; a set of one body means the body with itself.

    Two bodies are exempt if one joint joins them, if only fixed joints lie between them, or if the
    annotation says so.
    """
    rigid = {mechanism.root: mechanism.root}
    pairs = set(annotation.allowed_contacts)
    for joint in mechanism.joints:
        rigid[joint.child] = rigid[joint.parent] if joint.type is JointType.FIXED else joint.child
        pairs.add(frozenset((joint.parent, joint.child)))
    groups: dict[str, list[str]] = {}
    for body, group in rigid.items():
        groups.setdefault(group, []).append(body)
    for group in groups.values():
        pairs.update(frozenset((one, other)) for one in group for other in group)
    iri = {body: body_iri(mechanism.name, body) for body in frozenset[str]().union(*pairs)}
    return {frozenset(iri[body] for body in pair) for pair in pairs}
