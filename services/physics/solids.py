"""Collision shapes on the joints of a model, one by one and as arrays."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # found through a .pth file

from sdt_kg.iri import Iri, body_iri
from sdt_kg.mechanism import Geometry, Pose
from services.physics.geometry.floor import LEVEL
from services.physics.geometry.packed import pack
from services.physics.tree import UNIVERSE, Array, Indices, Part, se3


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """One collision shape of a body.

    Attributes:
        body: IRI of its body.
        joint: Pinocchio's index of the joint that moves it; 0 for the world.
        joint_T_shape: Where it sits.
        centre: Centre of the shape's own axis-aligned box, in the joint's frame [m], shape (3,).
        half: Half extents of that box, in the shape's frame [m], shape (3,).
        radius: Of the sphere about `centre` that contains the shape [m].
    """

    body: Iri
    joint: int
    joint_T_shape: pin.SE3
    shape: coal.CollisionGeometry
    centre: Array
    half: Array
    radius: float

    @property
    def is_ground(self) -> bool:
        """Whether it rests and is no higher than the floor."""
        top = self.centre[2] + np.abs(self.joint_T_shape.rotation[2]) @ self.half
        return self.joint == UNIVERSE and bool(top <= LEVEL)


def solid_at(
    body: Iri, pose: Pose, joint: int, joint_T_body: pin.SE3, shape: coal.CollisionGeometry
) -> Solid:
    joint_T_shape = joint_T_body * se3(pose)
    box = shape.aabb_local
    centre, half = (box.min_ + box.max_) / 2, (box.max_ - box.min_) / 2
    radius = float(np.linalg.norm(half))
    return Solid(body, joint, joint_T_shape, shape, joint_T_shape.act(centre), half, radius)


@dataclass(frozen=True, slots=True, eq=False)
class Outlines:
    """All solids of a scene as arrays.

    Attributes:
        joint: Pinocchio's index of the joint that moves each, shape (S,).
        joint_T_shape: Shape (S, 4, 4).
        middle, half: Middle and half extents of each shape's own box, in its frame [m], shape (S, 3).
        convex: What `geometry.packed` takes.
    """

    joint: Indices
    joint_T_shape: Array
    middle: Array
    half: Array
    convex: tuple


def outlines_of(solids: Sequence[Solid]) -> Outlines:
    boxes = (one.shape.aabb_local for one in solids)
    return Outlines(
        np.array([one.joint for one in solids], dtype=np.intp),
        np.array([one.joint_T_shape.homogeneous for one in solids]).reshape(-1, 4, 4),
        np.array([(box.min_ + box.max_) / 2 for box in boxes]).reshape(-1, 3),
        np.array([one.half for one in solids]).reshape(-1, 3),
        pack([one.shape for one in solids]),
    )


def solids_of(
    part: Part, shapes: Callable[[Iri, Geometry], tuple[coal.CollisionGeometry, ...]]
) -> list[Solid]:
    return [
        solid_at(iri, geometry.pose, *part.attached[body.name], shape)
        for body in part.mechanism.bodies
        for iri in (body_iri(part.mechanism.name, body.name),)
        for geometry in body.collision
        for shape in shapes(iri, geometry)
    ]
