"""Pairs of a robot's bodies whose shapes overlap wherever the robot moves, found by sampling."""

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # found through a .pth file

from sdt_kg.mechanism import Joint, JointType, Mechanism
from services.physics.geometry.shapes import solids
from services.physics.tree import Array, Model, build, se3

SAMPLES = 200
"""Configurations tried. A pair that is apart in one is not listed: more can only shorten the list."""

SEED = 0


def sampled_contacts(mechanism: Mechanism) -> list[tuple[str, str]]:
    """Pairs of bodies that touch in every sampled configuration: a first guess, to be checked.

    Such shapes overlap by construction. Bodies joined by one joint are left out, since their contact
    is allowed anyhow.
    """
    model = build(mechanism)
    rng = np.random.default_rng(SEED)
    shapes = {
        body.name: [(se3(geometry.pose), shape) for geometry in body.collision for shape in solids(geometry)]
        for body in mechanism.bodies
        if body.collision
    }
    joined = {frozenset((joint.parent, joint.child)) for joint in mechanism.joints}
    names = list(shapes)
    pairs = [(one, other) for i, one in enumerate(names) for other in names[i + 1 :]]
    pairs = [pair for pair in pairs if frozenset(pair) not in joined]
    for _ in range(SAMPLES):
        q = model.coupling.positions(_random(model, rng))
        pin.forwardKinematics(model.model, model.data, q)
        world_T_body = {name: _placement(model, name) for name in names}
        pairs = [pair for pair in pairs if _touch(pair, shapes, world_T_body)]
    return pairs


def _random(model: Model, rng: np.random.Generator) -> Array:
    return np.array([rng.uniform(*_range(joint)) for joint in model.part.joints])


def _range(joint: Joint) -> tuple[float, float]:
    if joint.type is JointType.CONTINUOUS:
        return -np.pi, np.pi
    return joint.limits.lower, joint.limits.upper


def _placement(model: Model, body: str) -> pin.SE3:
    joint, joint_T_body = model.part.attached[body]
    return model.data.oMi[joint] * joint_T_body


def _touch(
    pair: tuple[str, str],
    shapes: dict[str, list[tuple[pin.SE3, coal.CollisionGeometry]]],
    world_T_body: dict[str, pin.SE3],
) -> bool:
    return any(
        _overlap(world_T_body[pair[0]] * one_pose, one, world_T_body[pair[1]] * other_pose, other)
        for one_pose, one in shapes[pair[0]]
        for other_pose, other in shapes[pair[1]]
    )


def _overlap(
    one_pose: pin.SE3, one: coal.CollisionGeometry, other_pose: pin.SE3, other: coal.CollisionGeometry
) -> bool:
    # A request of its own for each call: a cached guess from another pair gives wrong answers.
    request, result = coal.CollisionRequest(), coal.CollisionResult()
    return coal.collide(one, _transform(one_pose), other, _transform(other_pose), request, result) > 0


def _transform(pose: pin.SE3) -> coal.Transform3s:
    return coal.Transform3s(pose.rotation, pose.translation)
