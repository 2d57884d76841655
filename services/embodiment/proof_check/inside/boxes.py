"""Boxes inside the robot's bodies, and inside shapes as they are declared."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import RobotAnnotation
from sdt_kg.mechanism import Body, Geometry, JointType, ShapeType
from services.embodiment.proof_check.geometry.interval import exact, turning
from services.embodiment.proof_check.geometry.mechanics import HERE, Chain, Placement, Swing, Tree, placement
from services.embodiment.proof_check.inside.covered import is_covered, sticks_out

Array = NDArray[np.float64]
Inside = tuple[Placement, Array]
"""Where a box sits, and its half extents [m], shape (3,)."""

GAP = 0.001  # [m] between the face of a box and the cylinder that it is inside, at most
THIN = 0.005  # [m] half an extent of a box below which nothing stays inside it that moves
LESS = 1 - 1e-9  # [1] for what rounding may add


@dataclass(frozen=True, slots=True, eq=False)
class Core:
    """A box inside a body of a chain.

    Attributes:
        link: Index of the chain's link that carries the body.
        middle: Where the box sits in that link's frame.
        half: Its half extents [m], shape (3,).
    """

    body: str
    link: int
    middle: Placement
    half: Array

    def seen_from(self, carrier: int, chain: Chain, boxes: tuple[Array, Array]) -> tuple[Placement, Swing]:
        """Where it is in a frame in the middles of L boxes of positions, and how the joints between carry it.

        Args:
            carrier: Index of the chain's link whose frame it is; −1 is the world.
            chain: That carries the body.
            boxes: Middles and half widths of the positions of its joints, shapes (L, n).
        """
        between = slice(carrier + 1, self.link + 1)
        middle, half = (each[:, between] for each in boxes)
        return Chain(chain.links[between], self.middle).swing(middle, half)


def boxes_in(
    tree: Tree, annotation: RobotAnnotation, declared: bool = False
) -> tuple[tuple[str, Inside], ...]:
    """Boxes inside bodies, each with its body's name; those of fingers, which touch, are left out.

    Args:
        tree: The robot's.
        annotation: The robot's.
        declared: Whether a body is taken as its collision shapes are declared, and not by what is annotated.
    """
    fingers = {finger for gripper in annotation.grippers for finger in gripper.fingers}
    boxes = _annotated(tree, annotation)
    if declared:
        told = {one.name: [*boxes_within(one)] for one in tree.mechanism.bodies}
        boxes = [one for one in boxes if not told[one[0]]]
        boxes += [(name, one) for name, each in told.items() for one in each]
    return tuple(one for one in boxes if one[0] not in fingers)


def cores_on(
    tree: Tree, boxes: tuple[tuple[str, Inside], ...], joints: list[str], root: Placement, base: int
) -> tuple[Core, ...]:
    """Those boxes inside bodies that a chain carries.

    Args:
        tree: The robot's.
        boxes: Those of the robot, see `boxes_in`.
        joints: The chain's movable joints, from the base on.
        root: Where the robot's root sits in the base's frame.
        base: Index of the link that is the base.
    """
    carried = {body: _carried(tree, body, joints, root) for body in dict(boxes)}
    found: list[Core] = []
    for body, (where, half) in boxes:
        if (on := carried[body]) is not None:
            at, passed = on
            found.append(Core(body, base + passed, at @ where, half))
    return tuple(found)


def _carried(tree: Tree, body: str, joints: list[str], root: Placement) -> tuple[Placement, int] | None:
    """Where a body sits behind the joints of a chain, and behind how many; None if not on the chain."""
    at, passed = root, 0
    for joint in tree.path(body):
        at = at @ placement(joint.origin)
        if joint.type is JointType.FIXED:
            continue
        if passed >= len(joints) or joints[passed] != joint.name:
            return None
        at, passed = HERE, passed + 1
    return at, passed


def _annotated(tree: Tree, annotation: RobotAnnotation) -> list[tuple[str, Inside]]:
    """Name of the body, and each box that it is said to contain.

    One that sticks out of the body's collision shapes, which contain the body, is not inside it: what it
    meets, certification would let pass. By rounding one may stick out all the same: it is taken smaller by as
    much, less what certification keeps between shapes anyway, `overhang`, which two of the robot's share.
    """
    shapes = {body.name: body.collision for body in tree.mechanism.bodies}
    boxes = [(body, one) for body, one in annotation.cores if one.shape is ShapeType.BOX]
    inside = [(body, one) for body, one in boxes if is_covered(one, shapes[body])]
    less = [max(sticks_out(one, shapes[body]) - annotation.overhang / 2, 0.0) for body, one in inside]
    return [
        (body, (placement(one.pose), np.array(one.size) / 2 - much))
        for (body, one), much in zip(inside, less, strict=True)
    ]


def boxes_within(body: Body) -> Iterator[Inside]:
    """Boxes inside the shapes of a body that are no meshes; none so thin that they refute nothing."""
    for geometry in body.collision:
        at = placement(geometry.pose)
        for turn, half in _filling(geometry):
            if half.min() >= THIN:
                yield at @ turn, half


def _filling(geometry: Geometry) -> Iterator[Inside]:
    """Boxes about the middle of a shape, inside it, that leave little of it out."""
    if geometry.shape not in {ShapeType.CYLINDER, ShapeType.CAPSULE}:
        if geometry.shape is not ShapeType.MESH:
            yield HERE, within(geometry)
        return
    radius, upright = geometry.size[0], np.array([0.0, 0.0, 1.0])
    count = int(np.ceil(np.pi / 2 / np.arccos(max(1 - GAP / radius, 0.0))))
    half_angle = np.pi / 2 / count
    sides = np.array([np.cos(half_angle), np.sin(half_angle)]) * radius * LESS
    for k in range(count):
        turn = Placement(turning(upright, np.array(2 * half_angle * k)), exact(np.zeros(3)))
        yield turn, np.array([*sides, geometry.size[1] / 2])


def within(geometry: Geometry) -> Array:
    """Half extents of a box inside a shape that is no mesh, about its middle [m], shape (3,)."""
    size = geometry.size
    if geometry.shape is ShapeType.BOX:
        return np.array(size) / 2
    if geometry.shape is ShapeType.SPHERE:
        return np.full(3, size[0] / np.sqrt(3)) * LESS
    across = size[0] / np.sqrt(2) * LESS  # of a cylinder, and of a capsule without its ends
    return np.array([across, across, size[1] / 2])
