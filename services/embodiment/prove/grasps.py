"""Where no grasp across a bar can be had: cells of grasps, each with a tree of the arm's joints."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Gripper
from services.embodiment.hold.handle import Bar
from services.embodiment.hold.sets import FINGER_HALF
from services.embodiment.proof_check.arm import Arm
from services.embodiment.proof_check.grasps import HAND, SIGNS, Grasps
from services.embodiment.proof_check.proof.claim import Bar as ClaimedBar
from services.embodiment.proof_check.proof.content import LEAF, Refutation
from services.embodiment.proof_check.statement import Statement
from services.embodiment.proof_check.tree import Goal, halves
from services.embodiment.prove.arrays import ANYHOW, aim, anywhere, inner, joints
from services.embodiment.prove.limbs.met import CODES
from services.embodiment.prove.tree.boxes import FOUND, divide
from services.embodiment.prove.tree.inner import SLACK
from services.embodiment.prove.values import at_one

Array = NDArray[np.float64]

WIDTHS = np.array([1.0, 0.15, 0.12, 0.7])
"""[m/m, m/rad, m/rad, m/m] How much place, pitch, tilt and depth count: what they move the wrist, about."""
NODES = ((0.3, 50), (0.1, 150), (0.04, 400), (0.02, 1_000), (0.01, 2_000), (0.002, 8_000))
"""Nodes of the tree of one cell, by its width [m], counted so."""
LOOKS = ((6_000, None), (60_000, 2), (20_000, None), (150_000, None))
"""Nodes that are spent for one gripper at one value, and at how many of them, from the ends: all, if None."""
FEW = 100  # nodes of the tree of the hand alone, in a cell


def claimed(bar: Bar) -> ClaimedBar:
    """A bar as a claim tells it: grasps of it leave the fingers on it."""
    along = bar.along / np.linalg.norm(bar.along)
    outward = bar.outward - (bar.outward @ along) * along
    outward = outward / np.linalg.norm(outward)
    centre, along, outward = ((float(x), float(y), float(z)) for x, y, z in (bar.centre, along, outward))
    return ClaimedBar(centre, along, outward, max(float(bar.length) / 2 - FINGER_HALF, 0.0))


class _Search:
    """Looks for trees of one gripper at one value, one cell after the other."""

    def __init__(self, grasps: Grasps, arm: Arm) -> None:
        self.spent = 0
        self._grasps, self._chain, self._box = grasps, joints(arm.chain), arm.chain.ranges()
        goal = grasps.goal(SIGNS[0], grasps.low, grasps.high)
        self.told = goal.codes <= CODES
        self._solids = inner(goal.arm, goal.around)
        hands = {sign: grasps.hand(sign) for sign in SIGNS}
        nothing = anywhere(len(grasps.low))
        self._hands = {
            sign: (joints(one.limb.chain), inner(one.limb, one.around), (nothing, nothing))
            for sign, one in hands.items()
        }
        self._tree = np.zeros(NODES[-1][1], dtype=np.uint8)

    def alone(self, sign: float, low: Array, high: Array) -> bytes | None:
        """The tree of a cell in which the hand is in something solid wherever it is, of a few nodes."""
        about, solids, aims = self._hands[sign]
        tree = self._tree[:FEW]
        outcome, count = divide(low, high, about, 0, aims, False, ANYHOW, False, SLACK, solids, tree)
        return tree[:count].tobytes() if outcome == FOUND else None

    def refute(self, sign: float, low: Array, high: Array, nodes: int) -> bytes | None:
        """The tree of a cell, of at most so many nodes."""
        goal = self._grasps.goal(sign, low, high)
        assert goal.wrist is not None
        aims = aim(goal.arm, goal.target), aim(*goal.wrist)
        about = self._chain, 0, aims, True, _facing(goal), False, SLACK, self._solids
        outcome, count = divide(*self._box, *about, self._tree[:nodes])
        self.spent += count
        return self._tree[:count].tobytes() if outcome == FOUND else None


def of_grasps(
    statement: Statement, values: Sequence[float], late: Callable[[], bool]
) -> list[Refutation] | None:
    """A refutation of all grasps of the bar by each gripper, all at one value, if found in time."""
    known: dict[tuple[str, float], Refutation] = {}

    def look(gripper: Gripper, value: float, most: int) -> Refutation | None:
        key, arm = (gripper.name, value), statement.arm(gripper)
        if key not in known and arm is not None and statement.bar is not None and not late():
            grasps = Grasps(statement, arm, statement.bar, value)
            if (found := _by_grasps(grasps, arm, value, most, late)) is not None:
                known[key] = found
        return known.get(key)

    looks = (at_one(statement.grippers, values[:count], partial(look, most=most)) for most, count in LOOKS)
    return next((found for found in looks if found is not None), None)


def _by_grasps(
    grasps: Grasps, arm: Arm, value: float, most: int, late: Callable[[], bool]
) -> Refutation | None:
    """A refutation of all grasps of a bar by one gripper at a value, with so many nodes, if found in time."""
    search, parts = _Search(grasps, arm), list[bytes]()
    if not search.told:
        return None
    for sign in SIGNS:
        stack = [(grasps.low, grasps.high)]
        while stack:
            low, high = stack.pop()
            widths = WIDTHS * (high - low)
            nodes = next((most for width, most in NODES if widths.max() > width), None)
            if nodes is None or search.spent > most or late():
                return None
            hand = search.alone(sign, low, high)
            tree = search.refute(sign, low, high, nodes) if hand is None else hand
            if tree is not None:
                parts += bytes([LEAF if hand is None else HAND]), tree
                continue
            axis = int(np.argmax(widths))
            parts.append(bytes([axis]))
            stack += halves(low, high, axis)
    names = tuple(link.name for link in arm.chain.links)
    box = tuple(zip(*(end.tolist() for end in arm.chain.ranges()), strict=True))
    return Refutation(arm.gripper, value, names, box, b"".join(parts), grasped=True)


def _facing(goal: Goal) -> Array:
    """How the hand has to be turned, rows as `divide` takes them."""
    facing, tool = goal.facing, goal.arm.chain.end.rotation.middle
    assert facing is not None
    return np.array(
        [
            [*tool[:, j], *way, facing.low[i, j], facing.high[i, j]]
            for i, way in enumerate(facing.ways)
            for j in range(3)
        ]
    )
