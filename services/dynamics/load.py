"""The rigid body that a container's joint moves, for one kilogram of it: inertia, weight and lever."""

import math
from collections.abc import Collection, Iterator

import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # found through a .pth file

from sdt_kg.errors import OracleRejectedError
from sdt_kg.iri import Iri, joint_iri, local_name
from sdt_kg.mechanism import Body, Geometry, ShapeType
from sdt_kg.twin import Container, Twin
from services.dynamics.model import Array, Load
from services.physics.geometry.shapes import surface
from services.physics.tree import UNIVERSE, Model, Part, se3


def load_of(
    model: Model,
    twin: Twin,
    joint: Iri,
    container: Container | None = None,
    apart: Collection[Iri] = (),
) -> Load:
    """What hangs on a joint, everything else being where the state has it.

    Where the twin gives the moved bodies inertias, mass is spread as they say; else evenly over their
    collision shapes (a mesh: over its box).

    Args:
        model: Built from the twin's environment.
        twin: The kitchen in its state.
        joint: What moves.
        container: Whose own joint it is; without it nothing holds a handle, and the lever is 1.
        apart: Joints which move with it: what hangs on one of them does not count here.

    Raises:
        OracleRejectedError: Nothing that moves has a shape or an inertia, or the handle has no shape.
    """
    index = model.model.getJointId(joint)
    placed(model, twin)
    body = unit_inertia(model, index, apart)
    prismatic = model.model.joints[index].shortname().startswith("JointModelP")
    parent = model.model.parents[index]
    world_T_joint = model.placements.world_T_joint[parent] * model.model.jointPlacements[index]
    single = pin.Model()
    single.addJoint(UNIVERSE, model.model.joints[index], world_T_joint, joint)
    single.appendBodyToJoint(1, body, pin.SE3.Identity())
    data, still = single.createData(), np.zeros(1)
    weights = [
        float(pin.rnea(single, data, np.array([q]), still, still)[0]) for q in (0.0, math.pi / 2, math.pi)
    ]
    pushed = float(pin.rnea(single, data, still, still, np.ones(1))[0]) - weights[0]
    lever = (
        (1.0, 1.0) if prismatic or container is None else _lever(model.part, axis_of(model, index), container)
    )
    if prismatic:
        return Load(True, pushed, 0.0, 0.0, weights[0], lever)
    constant = (weights[0] + weights[2]) / 2
    return Load(False, pushed, weights[0] - constant, weights[1] - constant, constant, lever)


def placed(model: Model, twin: Twin, zero: Collection[Iri] = ()) -> None:
    """The model's placements are where the state has the kitchen, but for joints that are at 0."""
    joints = [joint_iri(model.part.mechanism.name, each.name) for each in model.part.joints]
    at = [0.0 if each in zero else twin.state.get(each, 0.0) for each in joints]
    model.placements.move(np.array(at))


def unit_inertia(model: Model, index: int, apart: Collection[Iri] = ()) -> pin.Inertia:
    """Of one kilogram of all that hangs on the joint, in its frame; not of what hangs on those apart."""
    part, below = model.part, set(model.model.subtrees[index])
    for other in (model.model.getJointId(each) for each in apart):
        if other in below and other != index:
            below -= set(model.model.subtrees[other])
    bodies = [each for each in part.mechanism.bodies if part.attached[each.name][0] in below]
    given = any(each.inertia is not None and each.inertia.mass > 0 for each in bodies)
    total = pin.Inertia.Zero()
    own = model.placements.world_T_joint[index].inverse()
    for each in bodies:
        joint, joint_T_body = part.attached[each.name]
        body_inertia = _given(each) if given else _uniform(each)
        if body_inertia.mass > 0:
            total += (own * model.placements.world_T_joint[joint] * joint_T_body).act(body_inertia)
    if total.mass <= 0:
        name = local_name(model.model.names[index])
        raise OracleRejectedError(f"nothing that {name} moves has an inertia or a shape with volume")
    return pin.Inertia(1.0, total.lever, total.inertia / total.mass)


def _given(body: Body) -> pin.Inertia:
    if body.inertia is None:
        return pin.Inertia.Zero()
    xx, xy, xz, yy, yz, zz = body.inertia.moments
    moments = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return se3(body.inertia.pose).act(pin.Inertia(body.inertia.mass, np.zeros(3), moments))


def _uniform(body: Body) -> pin.Inertia:
    """Of density 1 over the collision shapes."""
    total = pin.Inertia.Zero()
    for geometry in body.collision:
        if geometry.shape is ShapeType.MESH:
            middle, half = _box(geometry)
            shape = pin.Inertia.FromBox(float(np.prod(2 * half)), *(2 * half).tolist())
            total += (se3(geometry.pose) * pin.SE3(np.eye(3), middle)).act(shape)
        else:
            (one,) = surface(geometry)
            moments = one.computeMomentofInertiaRelatedToCOM()
            total += se3(geometry.pose).act(pin.Inertia(one.computeVolume(), one.computeCOM(), moments))
    return total


def _box(geometry: Geometry) -> tuple[Array, Array]:
    """Middle and half extents of the geometry's own box, in its frame [m]."""
    (shape,) = surface(geometry)
    box = shape.aabb_local
    return (box.min_ + box.max_) / 2, (box.max_ - box.min_) / 2


def axis_of(model: Model, index: int) -> Array:
    """Unit vector of the hinge in its frame."""
    joint = next(
        each
        for each in model.part.joints
        if joint_iri(model.part.mechanism.name, each.name) == model.model.names[index]
    )
    axis = np.array(joint.axis)
    return axis / np.linalg.norm(axis)


def _lever(part: Part, axis: Array, container: Container) -> tuple[float, float]:
    """Least and largest distance of its handles' shapes from the hinge's axis, by their boxes [m].

    A box lies within the largest of its corners' distances from its middle, seen along the axis.
    """
    across = np.eye(3) - np.outer(axis, axis)
    found: list[tuple[float, float]] = []
    for joint_T_shape, geometry in _handles(part, container):
        middle, half = _box(geometry)
        spread = float(np.linalg.norm(_corners(half) @ joint_T_shape.rotation.T @ across, axis=1).max())
        at = float(np.linalg.norm(across @ joint_T_shape.act(middle)))
        found.append((max(at - spread, 0.0), at + spread))
    return min(low for low, _ in found), max(high for _, high in found)


def handle_corners(part: Part, container: Container) -> Array:
    """Corners of its handles' boxes in the frame of the joint that moves them, shape (8 K, 3)."""
    found = list[Array]()
    for joint_T_shape, geometry in _handles(part, container):
        middle, half = _box(geometry)
        found.append((_corners(half) + middle) @ joint_T_shape.rotation.T + joint_T_shape.translation)
    return np.concatenate(found)


def _handles(part: Part, container: Container) -> Iterator[tuple[pin.SE3, Geometry]]:
    """Where each shape of each handle is on what moves it: any of them may be held."""
    bodies = {each.name: each for each in part.mechanism.bodies}
    for handle in (container.handle, *container.more_handles):
        name = local_name(handle)
        if not bodies[name].collision:
            raise OracleRejectedError(
                f"the handle {name} has no shape, so its distance from the hinge is unknown"
            )
        joint_T_body = part.attached[name][1]
        yield from ((joint_T_body * se3(each.pose), each) for each in bodies[name].collision)


def _corners(half: Array) -> Array:
    """Of a box about 0, shape (8, 3)."""
    return np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T * half
