"""The tree of an arm's joint positions that is to refute a goal."""

import numpy as np
from numpy.typing import NDArray

from services.embodiment.proof_check.tree import Goal
from services.embodiment.prove.arrays import aim, inner, joints
from services.embodiment.prove.tree.boxes import FOUND, divide
from services.embodiment.prove.tree.inner import SLACK

Array = NDArray[np.float64]


def divided(goal: Goal, low: Array, high: Array, nodes: int) -> bytes | None:
    """The tree over a box of positions, lower and upper ends of shape (n,), if so many nodes are enough."""
    arm, tree, wanted = goal.arm, np.zeros(nodes, dtype=np.uint8), aim(goal.arm, goal.target)
    about = joints(arm.chain), arm.upright, (wanted, wanted), False, goal.level, SLACK
    outcome, count = divide(low, high, *about, inner(arm, goal.around), tree)
    return tree[:count].tobytes() if outcome == FOUND else None
