"""Frames of a mechanism, and the mechanism with one joint replaced and all else where it was."""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from predicates.learn.track import Array
from sdt_kg.entities import Replacement
from sdt_kg.iri import Iri, joint_iri
from sdt_kg.mechanism import Body, Joint, JointType, Mechanism, Pose
from sdt_kg.triples.from_mechanism import mechanism_triples
from sdt_kg.twin import Twin

SAME = 1e-12
"""[m, 1] Entries of a transform that differ by less from the identity's are the identity's."""


def world_T_of(mechanism: Mechanism, body: str, state: Mapping[Iri, float]) -> Array:
    """Pose of a body in the root frame, shape (4, 4), its joints where the state has them."""
    above = {joint.child: joint for joint in mechanism.joints}
    pose: Array = np.eye(4)
    while body in above:
        joint = above[body]
        position = state.get(joint_iri(mechanism.name, joint.name), 0.0)
        pose = joint.origin.matrix() @ motion_of(joint, position) @ pose
        body = joint.parent
    return pose


def motion_of(joint: Joint, position: float) -> Array:
    """What a joint does to its child's frame at a position [rad or m], shape (4, 4)."""
    moved: Array = np.eye(4)
    if joint.type is JointType.PRISMATIC:
        moved[:3, 3] = position * np.array(joint.axis)
    elif joint.type is not JointType.FIXED:
        x, y, z = joint.axis
        half = position / 2
        sine = math.sin(half)
        moved = Pose(orientation=(x * sine, y * sine, z * sine, math.cos(half))).matrix()
    return moved


def pose_of(transform: Array) -> Pose:
    """A transform, shape (4, 4), as position and quaternion."""
    x, y, z = (float(value) for value in transform[:3, 3])
    return Pose((x, y, z), _quaternion(transform[:3, :3]))


def _quaternion(rotation: Array) -> tuple[float, float, float, float]:
    """Unit quaternion xyzw: the eigenvector of Davenport's matrix, exact also at half a turn."""
    r = rotation
    trace = float(np.trace(r))
    davenport = np.zeros((4, 4))
    davenport[:3, :3] = r + r.T - trace * np.eye(3)
    davenport[:3, 3] = davenport[3, :3] = (r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1])
    davenport[3, 3] = trace
    vectors = np.asarray(np.linalg.eigh(davenport)[1], dtype=np.float64)
    x, y, z, w = (float(value) for value in vectors[:, 3])
    sign = -1.0 if w < 0 else 1.0
    return sign * x, sign * y, sign * z, sign * w


def with_joint(mechanism: Mechanism, joint: Joint, child_T_old: Array) -> Mechanism:
    """The mechanism with the joint of that name replaced.

    Args:
        mechanism: The mechanism.
        joint: The new joint.
        child_T_old: The child's old frame in its new one, shape (4, 4): what hangs on it stays.
    """
    same = bool(np.abs(child_T_old - np.eye(4)).max() < SAME)
    joints = (
        joint
        if each.name == joint.name
        else replace(each, origin=_shifted(each.origin, child_T_old))
        if each.parent == joint.child and not same
        else each
        for each in mechanism.joints
    )
    bodies = (
        _moved(each, child_T_old) if each.name == joint.child and not same else each
        for each in mechanism.bodies
    )
    return replace(mechanism, joints=tuple(joints), bodies=tuple(bodies))


def rejoined(twin: Twin, joint: Joint, child_T_old: Array, words: str) -> Twin:
    """The twin with that joint of its kitchen replaced as by `with_joint`; the edit, in words."""
    kitchen = twin.mechanism(twin.environment)
    edited = with_joint(kitchen, joint, child_T_old)
    old, new = (frozenset(mechanism_triples(each, "Environment")) for each in (kitchen, edited))
    return twin.rewritten(Replacement(twin.environment, old - new, new - old, words))


def _moved(body: Body, child_T_old: Array) -> Body:
    """The body, its frame elsewhere and its shapes where they were."""
    inertia = body.inertia
    if inertia is not None:
        inertia = replace(inertia, pose=_shifted(inertia.pose, child_T_old))
    collision = (replace(each, pose=_shifted(each.pose, child_T_old)) for each in body.collision)
    return replace(body, inertia=inertia, collision=tuple(collision))


def _shifted(pose: Pose, child_T_old: Array) -> Pose:
    return pose_of(child_T_old @ pose.matrix())
