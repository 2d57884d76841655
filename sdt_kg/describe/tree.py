"""A mechanism as a tree that can be asked for positions: just enough kinematics to guess a gripper."""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotating.panels import corners
from sdt_kg.mechanism import Geometry, Joint, JointType, Mechanism, Pose, ShapeType

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class Tree:
    """A mechanism with its kinematics."""

    mechanism: Mechanism

    @cached_property
    def by_child(self) -> dict[str, Joint]:
        """The joint that moves each body."""
        return {joint.child: joint for joint in self.mechanism.joints}

    @cached_property
    def children(self) -> dict[str, list[Joint]]:
        """The joints below each body."""
        found: dict[str, list[Joint]] = {body.name: [] for body in self.mechanism.bodies}
        for joint in self.mechanism.joints:
            found[joint.parent].append(joint)
        return found

    def rigid_root(self, body: str) -> str:
        """The topmost body to which this one is rigidly attached."""
        return self._carriers[body]

    @cached_property
    def _carriers(self) -> dict[str, str]:
        return self.mechanism.carriers()

    def below(self, body: str) -> Iterator[str]:
        """The body and all bodies below it."""
        yield body
        for joint in self.children[body]:
            yield from self.below(joint.child)

    def movable_below(self, body: str) -> int:
        """How many joints below the body can move."""
        return sum(
            joint.type is not JointType.FIXED for each in self.below(body) for joint in self.children[each]
        )

    def movable_above(self, body: str) -> int:
        """How many joints move the body."""
        return sum(joint.type is not JointType.FIXED for joint in self.ancestors(body))

    def ancestors(self, body: str) -> Iterator[Joint]:
        """The joints from the body up to the root."""
        joint = self.by_child.get(body)
        while joint is not None:
            yield joint
            joint = self.by_child.get(joint.parent)

    def frame(self, body: str, base: str, positions: Mapping[str, float]) -> Matrix:
        """base_T_body with joints at these positions (others at 0), shape (4, 4); base is above body."""
        base_T_body = np.eye(4)
        while body != base:
            joint = self.by_child[body]
            base_T_body = joint.origin.matrix() @ motion(joint, positions) @ base_T_body
            body = joint.parent
        return base_T_body

    def axis(self, joint: Joint) -> Matrix:
        """Axis of a joint in the root frame with all joints at 0, shape (3,)."""
        root_T_child = self.frame(joint.child, self.mechanism.root, {})
        return root_T_child[:3, :3] @ np.array(joint.axis)

    def lowest(self, bodies: Iterable[str]) -> float:
        """Least height of their shapes in the root frame, all joints at 0 [m]; infinite without shapes."""
        shapes = {body.name: body.collision for body in self.mechanism.bodies}
        return min(
            (
                _lowest(self.frame(body, self.mechanism.root, {}) @ shape.pose.matrix(), shape)
                for body in bodies
                for shape in shapes[body]
            ),
            default=math.inf,
        )

    def points(self, bodies: Iterable[str], base: str, positions: Mapping[str, float]) -> Matrix:
        """Corners of the collision shapes of these bodies in the frame of base, shape (n, 3) [m]."""
        shapes = {body.name: body.collision for body in self.mechanism.bodies}
        parts = [np.zeros((0, 3))]
        for body in bodies:
            base_T_body = self.frame(body, base, positions)
            parts.append(corners(shapes[body]) @ base_T_body[:3, :3].T + base_T_body[:3, 3])
        return np.concatenate(parts)


def _lowest(root_T_shape: Matrix, shape: Geometry) -> float:
    """Least height of a shape at its pose [m]: a wheel's rim is round, a box about it is not."""
    if shape.shape in (ShapeType.SPHERE, ShapeType.CYLINDER, ShapeType.CAPSULE):
        radius, length = (*shape.size, 0.0)[:2]
        upright = abs(float(root_T_shape[2, 2]))
        level = math.sqrt(max(0.0, 1 - upright**2)) if shape.shape is ShapeType.CYLINDER else 1.0
        return float(root_T_shape[2, 3]) - upright * length / 2 - radius * level
    points = corners([replace(shape, pose=Pose())])
    return float((points @ root_T_shape[2, :3]).min() + root_T_shape[2, 3])


def motion(joint: Joint, positions: Mapping[str, float]) -> Matrix:
    """Transform of the joint at its position, shape (4, 4); a mimicking joint follows."""
    position = positions.get(joint.name, 0.0)
    if joint.mimic is not None:
        position = joint.mimic.multiplier * positions.get(joint.mimic.joint, 0.0) + joint.mimic.offset
    moved = np.eye(4)
    if joint.type is JointType.PRISMATIC:
        moved[:3, 3] = np.array(joint.axis) * position
    elif joint.type is not JointType.FIXED:
        x, y, z = joint.axis
        cross = np.array(((0, -z, y), (z, 0, -x), (-y, x, 0)))
        moved[:3, :3] += math.sin(position) * cross + (1 - math.cos(position)) * cross @ cross
    return moved


def listed(names: Iterable[str]) -> str:
    """Names as notes tell them."""
    return ", ".join(f"'{name}'" for name in names)
