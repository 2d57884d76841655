"""Shapes of a kitchen's bodies, and what bears which."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # found through a .pth file

from sdt_kg.iri import Iri, body_iri, model_iri
from sdt_kg.mechanism import JointType, Mechanism
from services.physics.geometry.floor import BELOW, SIZE, floor_box, floor_iri
from services.physics.geometry.pieces import Piece, pieces
from services.physics.tree import UNIVERSE, Array, Model, se3


@dataclass(frozen=True, slots=True, eq=False)
class BodyShape:
    """A shape of a kitchen's body.

    Attributes:
        parent: The body against which its joint moves it; None where none does.
        mount: What a single fixed joint joins to that.
        joint: Pinocchio's index of the joint that moves it.
        pose: joint_T_shape.
        rotation: Of that.
        centre, half: Middle of its own box in the joint's frame, half extents in its own, shape (3,) [m].
        radius: Of the sphere about `centre` that contains it [m].
    """

    body: Iri
    parent: Iri | None
    mount: frozenset[Iri]
    joint: int
    pose: pin.SE3
    piece: Piece
    rotation: Array
    centre: Array
    half: Array
    radius: float


def shapes_of(model: Model) -> Iterator[BodyShape]:
    """The pieces of all shapes of a mechanism's bodies, and the floor that kitchens rarely model."""
    part = model.part
    name, carried, mounts = part.mechanism.name, _carriers(part.mechanism), _mounts(part.mechanism)
    for body in part.mechanism.bodies:
        index, joint_T_body = part.attached[body.name]
        parent = carried[body.name]
        for geometry in body.collision:
            pose = joint_T_body * se3(geometry.pose)
            of = (
                body_iri(name, body.name),
                body_iri(name, parent) if parent else None,
                frozenset(body_iri(name, each) for each in mounts.get(parent, ())),
            )
            for piece in pieces(geometry):
                yield _shape(of, index, pose, piece)
    floor, half = floor_box(), np.array(SIZE) / 2
    of = floor_iri(model_iri(name)), None, frozenset[Iri]()
    yield _shape(of, UNIVERSE, se3(BELOW), Piece(-half, half, lambda: floor))


def _shape(of: tuple[Iri, Iri | None, frozenset[Iri]], joint: int, pose: pin.SE3, piece: Piece) -> BodyShape:
    """A piece at joint_T_piece, `of` a body with its parent and mount."""
    size = piece.high - piece.low
    return BodyShape(
        *of,
        joint=joint,
        pose=pose,
        piece=piece,
        rotation=pose.rotation.copy(),
        half=size / 2,
        centre=pose.act((piece.low + piece.high) / 2),
        radius=float(np.linalg.norm(size)) / 2,
    )


def with_piece(one: BodyShape, piece: Piece) -> BodyShape:
    """The shape with another piece in its place, a part of it."""
    return _shape((one.body, one.parent, one.mount), one.joint, one.pose, piece)


def _carriers(mechanism: Mechanism) -> dict[str, str]:
    """Body → parent of the joint that moves it, empty where none does."""
    parents = {joint.child: joint.parent for joint in mechanism.joints}
    return {body: parents.get(carrier, "") for body, carrier in mechanism.carriers().items()}


def _mounts(mechanism: Mechanism) -> dict[str, set[str]]:
    """Body → the bodies which a single fixed joint joins to it."""
    mounts: dict[str, set[str]] = {}
    for joint in mechanism.joints:
        if joint.type is JointType.FIXED:
            mounts.setdefault(joint.parent, set()).add(joint.child)
            mounts.setdefault(joint.child, set()).add(joint.parent)
    return mounts
