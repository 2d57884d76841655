"""Where the joints of a model are, at any coordinates, in memory that grows as the number of joints.

Pinocchio's `Data` of a whole model also holds what only dynamics asks for, four tensors of nv x nv x nv
among it: 6.9 GB for a kitchen of 600 drawers. Joints that hang on different joints of the world do not move
one another. Each of these trees is a model of its own, small ones some together, with the same joints,
computed in the same way: the same numbers.
"""

from collections.abc import Iterator, Sequence

import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # found through a .pth file
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

UNIVERSE = 0  # Pinocchio's joint index of the world

TOGETHER = 32
"""[1] Joints up to which trees share a model: 1 MB of tensors."""


class Placements:
    """Where the joints of a model are; every joint has one coordinate.

    Attributes:
        world_T_joint: Of each joint by Pinocchio's index, that of the world too, since `move`.
    """

    def __init__(self, model: pin.Model) -> None:
        self.world_T_joint: list[pin.SE3] = [pin.SE3.Identity() for _ in range(model.njoints)]
        self._parts: list[tuple[pin.Model, pin.Data, Indices]] = []
        for joints in _gathered(model):
            part = part_of(model, joints)
            data = pin.Data(part)  # `createData` gives a copy, which takes five times as long
            self._parts.append((part, data, np.array([model.idx_qs[joint] for joint in joints])))
            for own, joint in enumerate(joints, 1):
                self.world_T_joint[joint] = data.oMi[own]  # no copy: Pinocchio's, which `move` writes

    def move(self, q: Array) -> list[pin.SE3]:
        """`world_T_joint` at these coordinates, shape (nq,): the same list, valid until the next call."""
        for part, data, coordinates in self._parts:
            pin.forwardKinematics(part, data, q[coordinates])
        return self.world_T_joint


def part_of(model: pin.Model, joints: Sequence[int]) -> pin.Model:
    """Some joints of a model with what hangs on them, in their order, without frames.

    Args:
        model: Whose joints they are.
        joints: Pinocchio's indices; with a joint its parents, before it.
    """
    part, new = pin.Model(), {UNIVERSE: UNIVERSE}
    for joint in joints:
        parent, placement = new[model.parents[joint]], model.jointPlacements[joint]
        new[joint] = part.addJoint(parent, model.joints[joint], placement, model.names[joint])
        part.inertias[new[joint]] = model.inertias[joint]
    return part


def _gathered(model: pin.Model) -> Iterator[list[int]]:
    """Joints of trees that share a model."""
    together = list[int]()
    for joint in range(1, model.njoints):
        if model.parents[joint] != UNIVERSE:
            continue
        tree = sorted(model.subtrees[joint])
        if together and len(together) + len(tree) > TOGETHER:
            yield together
            together = []
        together += tree
    if together:
        yield together
