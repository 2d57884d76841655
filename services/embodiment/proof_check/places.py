r"""One hold at all values of the container: where the wrist is, seen from the handle, in cells.

From the moment of the grasp on the tool keeps its pose on the handle to within `tool_position` and
`tool_angle`. So the origin of the arm's last joint, a point p of the tool's frame, keeps its place in the
handle's frame to within

.. math:: tool\_position + 2 \sin(tool\_angle / 2) |p|

at every value that the container passes. That place is within the arm's last reach of the handle. The box of
all such places is halved until each cell is refuted by a tree of joint positions at any *one* of several
values: with the wrist in the cell there, no posture has the handle in hand and touches nothing.

Nodes are read in preorder: below 3 is the axis of the handle's frame along which a cell is halved, lower
half first; from `LEAF` on the cell is refuted, at the value of that number, by the tree that follows;
`NO_HOLD` says that the whole cell is too far from the handle.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import InputError
from services.embodiment.proof_check.arm import ROUNDING, Arm, make_arm
from services.embodiment.proof_check.geometry.mechanics import HERE, Chain
from services.embodiment.proof_check.proof.content import LEAF, NO_HOLD, Places
from services.embodiment.proof_check.statement import Statement
from services.embodiment.proof_check.tree import Goal, halves, refuted_boxes

Array = NDArray[np.float64]


def at_value(statement: Statement, arm: Arm, value: float) -> Goal:
    """What is to be refuted with the container at a value.

    Raises:
        InputError: The handle has no shape.
    """
    target = statement.target(value)
    if not len(target.boxes):
        raise InputError("the handle has no shape", allowed="a handle with collision geometry")
    return Goal(arm, target, statement.around(arm, value), statement.level)


def wrist_of(arm: Arm) -> Arm:
    """The same arm up to the origin of its last joint."""
    ends = make_arm(arm.gripper, Chain(arm.chain.links, HERE), np.zeros((8, 3)), arm.upright)
    return replace(ends, cores=arm.cores)


def region(statement: Statement, arm: Arm) -> tuple[Array, Array]:
    """A box of all places of the wrist in the handle's frame [m], lower and upper ends, shape (3,)."""
    reach = float(arm.reach[-1]) + ROUNDING
    ends = [(centre - half - reach, centre + half + reach) for centre, half in _boxes(statement)]
    return np.min([low for low, _ in ends], axis=0), np.max([high for _, high in ends], axis=0)


def too_far(statement: Statement, arm: Arm, low: Array, high: Array) -> bool:
    """Whether the wrist is nowhere in a cell: no box about the handle is within the arm's last reach."""
    middle, half = (low + high) / 2, (high - low) / 2
    gaps = (np.maximum(np.abs(middle - at) - half - own, 0.0) for at, own in _boxes(statement))
    return all(float(np.linalg.norm(gap)) * (1 - 1e-12) > arm.reach[-1] + ROUNDING for gap in gaps)


def _boxes(statement: Statement) -> Iterator[tuple[Array, Array]]:
    """Middles and half extents of boxes, along the axes of the handle's frame, about its shapes [m]."""
    for at, half in statement.handle_boxes():
        turned = at.rotation.magnitude().hi @ half + statement.about
        middle = at.translation.middle
        yield middle, turned + (at.translation.hi - at.translation.lo) + ROUNDING


def refuted_places(
    statement: Statement, arm: Arm, given: Places, nodes: Iterator[int], box: tuple[Array, Array]
) -> int:
    """Number of leaves of all trees, each of which is refuted; the cells are all places of the wrist.

    Args:
        statement: What is to be refuted.
        arm: One gripper's.
        given: Values of the container, and the box that is divided.
        nodes: Of the tree of cells, and of those in it.
        box: Lower and upper ends of the joints' positions, shape (n,).

    Raises:
        InputError: One is not, or the cells are not all places.
    """
    if statement.level:
        raise InputError("a proof from places of the wrist, with a free base", allowed="a fixed base")
    first, last = (np.array([end[k] for end in given.box]) for k in (0, 1))
    low, high = region(statement, arm)
    if first.shape != (3,) or (first > low).any() or (last < high).any():
        raise InputError("places of the wrist are left out", allowed=f"all of {low} to {high}")
    goals = [at_value(statement, arm, value) for value in given.values]
    wrist, stack, count = wrist_of(arm), [(first, last)], 0
    while stack:
        low, high = stack.pop()
        node = next(nodes, None)
        if node is not None and node < len(low):
            stack += halves(low, high, node)
        elif node == NO_HOLD:
            if not too_far(statement, arm, low, high):
                raise InputError("a cell that is left out can be had", allowed="cells far from the handle")
        elif node is not None and LEAF <= node < LEAF + len(goals):
            value = given.values[node - LEAF]
            cell = statement.cell(arm, value, low, high)
            count += refuted_boxes(replace(goals[node - LEAF], wrist=(wrist, cell)), nodes, *box)
        else:
            raise InputError("the proof's tree is damaged", allowed="a whole tree over places of the wrist")
    return count
