"""What is read of a URDF is what yourdfpy reads of it."""

import math
from pathlib import Path

import numpy as np
import pytest

import kitchens
import robots
from sdt_kg.mechanism import Body, Joint, JointType, Pose
from sdt_kg.urdf import read_mechanism

MODELS = sorted((*kitchens.path("").glob("*/*.urdf"), *robots.path("").glob("*/*.urdf")))


@pytest.mark.parametrize("path", MODELS, ids=lambda path: path.stem)
def test_bodies_and_joints_are_those_of_yourdfpy(path: Path) -> None:
    from yourdfpy import URDF  # noqa: PLC0415 - it imports for a second

    theirs = URDF.load(str(path), build_scene_graph=False, load_meshes=False).robot
    ours = read_mechanism(path)
    assert [each.name for each in ours.bodies] == [each.name for each in theirs.links]
    for body, link in zip(ours.bodies, theirs.links, strict=True):
        check_body(body, link)
    joints = {each.name: each for each in theirs.joints}
    assert joints.keys() == {each.name for each in ours.joints}
    for joint in ours.joints:
        check_joint(joint, joints[joint.name])


def check_body(body: Body, link) -> None:
    assert len(body.collision) == len(link.collisions)
    for shape, other in zip(body.collision, link.collisions, strict=True):
        check_pose(shape.pose, other.origin)
        assert shape.size == pytest.approx(size_of(other.geometry), abs=0), body.name
    if body.inertia is None:
        assert link.inertial is None or link.inertial.mass is None
        return
    assert body.inertia.mass == link.inertial.mass
    check_pose(body.inertia.pose, link.inertial.origin)
    assert body.inertia.moments == tuple(link.inertial.inertia[np.triu_indices(3)])


def size_of(geometry) -> tuple[float, ...]:
    if geometry.box is not None:
        return tuple(geometry.box.size)
    if geometry.cylinder is not None:
        return geometry.cylinder.radius, geometry.cylinder.length
    if geometry.sphere is not None:
        return (geometry.sphere.radius,)
    return (1.0, 1.0, 1.0) if geometry.mesh.scale is None else tuple(geometry.mesh.scale)


def check_joint(joint: Joint, other) -> None:
    assert (joint.parent, joint.child) == (other.parent, other.child)
    if any("fixed" in note for note in joint.notes):
        return  # moved to where it stands
    assert joint.type.value == other.type
    check_pose(joint.origin, other.origin)
    if joint.type is not JointType.FIXED:
        assert joint.axis == pytest.approx(other.axis / np.linalg.norm(other.axis), abs=1e-15)
        assert joint.limits.velocity == (math.inf if other.limit is None else other.limit.velocity)
    if joint.type in {JointType.PRISMATIC, JointType.REVOLUTE}:
        assert (joint.limits.lower, joint.limits.upper) == (other.limit.lower, other.limit.upper)


def check_pose(pose: Pose, matrix) -> None:
    assert pose.matrix() == pytest.approx(np.eye(4) if matrix is None else matrix, abs=1e-15)
