"""Where no grasp across a bar can be had: a tree of the arm's joints and of grasps at once."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from sdt_kg.annotation import Gripper
from sdt_kg.errors import InputError
from services.embodiment.hold.handle import Bar
from services.embodiment.hold.sets import FINGER_HALF
from services.embodiment.proof_check.arm import Arm
from services.embodiment.proof_check.grasps import COORDINATES, SIGNS, Grasps
from services.embodiment.proof_check.loop import Loop
from services.embodiment.proof_check.proof.claim import Bar as ClaimedBar
from services.embodiment.proof_check.proof.content import Refutation
from services.embodiment.proof_check.statement import Statement
from services.embodiment.prove.arrays import inner, joints
from services.embodiment.prove.limbs.met import CODES
from services.embodiment.prove.tree.boxes import FOUND, REACHED
from services.embodiment.prove.tree.inner import SLACK
from services.embodiment.prove.tree.loop import divide_loop
from services.embodiment.prove.values import at_one

LOOKS = (
    (2_000, 0.03, None),
    (10_000, 0.01, 2),
    (10_000, 0.3, 2),
    (40_000, 0.03, 2),
    (10_000, 0.03, None),
    (10_000, 0.3, None),
    (100_000, 0.03, None),
)
"""Nodes of one tree, the leeway by which gaps are compared (`divide_loop`) [m, rad], and at how many values,
from the ends: all, if None. Which leeway is best is not known before: PR2 977 takes 2,500 nodes with 0.01 and
424,000 with 0.3; 284 takes 3,800 with 0.3, 45,000 with 0.05, and more than 400,000 with 0.01."""


def claimed(bar: Bar) -> ClaimedBar:
    """A bar as a claim tells it: grasps of it leave the fingers on it."""
    along = bar.along / np.linalg.norm(bar.along)
    outward = bar.outward - (bar.outward @ along) * along
    outward = outward / np.linalg.norm(outward)
    centre, along, outward = ((float(x), float(y), float(z)) for x, y, z in (bar.centre, along, outward))
    return ClaimedBar(centre, along, outward, max(float(bar.length) / 2 - FINGER_HALF, 0.0))


def of_grasps(
    statement: Statement, values: Sequence[float], late: Callable[[], bool]
) -> list[Refutation] | None:
    """A refutation of all grasps of the bar by each gripper, all at one value, if found in time.

    Of a handle that has no such bar as is claimed, there is none.
    """
    known: dict[tuple[str, float], _Search] = {}

    def look(gripper: Gripper, value: float, most: int, leeway: float) -> Refutation | None:
        key, arm = (gripper.name, value), statement.arm(gripper)
        if arm is None or statement.bar is None or late():
            return None
        if key not in known:
            known[key] = _Search(Grasps(statement, arm, statement.bar, value), arm, value)
        return known[key].refute(most, leeway)

    looks = (
        at_one(statement.grippers, values[:count], partial(look, most=most, leeway=leeway))
        for most, leeway, count in LOOKS
    )
    try:
        return next((found for found in looks if found is not None), None)
    except InputError:
        return None


class _Search:
    """Looks for the trees of one gripper at one value."""

    def __init__(self, grasps: Grasps, arm: Arm, value: float) -> None:
        self._arm, self._value = arm, value
        self._loops = [grasps.loop(sign) for sign in SIGNS]
        self._trees, self._ends = list[bytes](), self._loops[0].bounds[-1] > CODES

    def refute(self, most: int, leeway: float) -> Refutation | None:
        """The refutation, if so many nodes are enough for each tree."""
        while len(self._trees) < len(self._loops):
            if self._ends:
                return None
            outcome, tree = _divided(self._loops[len(self._trees)], most, leeway)
            self._ends = outcome == REACHED
            if outcome != FOUND:
                return None
            self._trees.append(tree)
        names = (*(link.name for link in self._arm.chain.links), *COORDINATES)
        box = tuple(zip(*(end.tolist() for end in self._loops[0].ranges()), strict=True))
        return Refutation(self._arm.gripper, self._value, names, box, b"".join(self._trees), grasped=True)


def _divided(loop: Loop, most: int, leeway: float) -> tuple[int, bytes]:
    """What came of so many nodes, and the tree if it is whole."""
    arm, bar = loop.arm.chain, loop.bar
    hand = bar.end.rotation.middle, bar.end.translation.middle
    tool = (arm.end.rotation.middle, arm.end.translation.middle), hand, loop.ends[1].seen
    ends = tuple((end.arm.reach, end.near + SLACK) for end in loop.ends)
    solids = inner(loop.arm, loop.around), inner(loop.hand.limb, loop.hand.around)
    tree = np.zeros(most, dtype=np.uint8)
    chains = joints(arm), joints(bar)
    outcome, count = divide_loop(*loop.ranges(), chains, tool, ends, loop.turned, solids, leeway, tree)
    return outcome, tree[:count].tobytes()
