"""Where no grasp across a bar can be had: a tree of the arm's joints and of grasps at once."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

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
from services.embodiment.prove.limbs.beside import Limbs
from services.embodiment.prove.limbs.met import CODES
from services.embodiment.prove.tree.boxes import FOUND, REACHED
from services.embodiment.prove.tree.inner import SLACK
from services.embodiment.prove.tree.loop import divide_loop
from services.embodiment.prove.values import at_one

Array = NDArray[np.float64]

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
BESIDE = (5_000, 0.03), (10_000, 0.3)
"""The same after the first of them, where limbs are in the way in parts of the lift: of each other part."""


def claimed(bar: Bar) -> ClaimedBar:
    """A bar as a claim tells it: grasps of it leave the fingers on it."""
    along = bar.along / np.linalg.norm(bar.along)
    outward = bar.outward - (bar.outward @ along) * along
    outward = outward / np.linalg.norm(outward)
    centre, along, outward = ((float(x), float(y), float(z)) for x, y, z in (bar.centre, along, outward))
    return ClaimedBar(centre, along, outward, max(float(bar.length) / 2 - FINGER_HALF, 0.0))


def of_grasps(
    statement: Statement, values: Sequence[float], limbs: Limbs, late: Callable[[], bool]
) -> list[Refutation] | None:
    """A refutation of all grasps of the bar by each gripper, all at one value, if found in time.

    Of a handle that has no such bar as is claimed, there is none.

    Args:
        statement: What is to be refuted.
        values: Of the container, those first at which is looked first [rad or m].
        limbs: What is beside the arms.
        late: Whether time is up.
    """
    try:
        looks = _Looks(statement, limbs, late).each(values)
        return next((found for found in looks if found is not None), None)
    except InputError:
        return None


class _Looks:
    """Looks for refutations of all grippers, with ever more nodes."""

    def __init__(self, statement: Statement, limbs: Limbs, late: Callable[[], bool]) -> None:
        self._statement, self._limbs, self._late = statement, limbs, late
        self._known: dict[tuple[str, float, bool], _Search] = {}

    def each(self, values: Sequence[float]) -> Iterator[list[Refutation] | None]:
        """What each look finds, of the arms alone and, after the first of these, with limbs."""
        grippers = self._statement.grippers
        for k, (most, leeway, count) in enumerate(LOOKS):
            yield at_one(grippers, values[:count], partial(self._at, most=most, leeway=leeway, beside=False))
            for nodes, way in BESIDE if k == 0 else ():
                look = partial(self._at, most=nodes, leeway=way, beside=True)
                yield at_one(grippers, self._blocked(), look)

    def _blocked(self) -> list[float]:
        """Values at which limbs are in the way, which are the same beside each arm."""
        arms = map(self._statement.arm, self._statement.grippers)
        arm = next((arm for arm in arms if arm is not None), None)
        return [] if arm is None else self._limbs.values(arm)

    def _at(
        self, gripper: Gripper, value: float, most: int, leeway: float, beside: bool
    ) -> Refutation | None:
        key, arm, bar = (gripper.name, value, beside), self._statement.arm(gripper), self._statement.bar
        if arm is None or bar is None or self._late():
            return None
        if key not in self._known:
            grasps = Grasps(self._statement, arm, bar, value)
            self._known[key] = _Search(grasps, arm, value, self._limbs if beside else None)
        return self._known[key].refute(most, leeway)


class _Search:
    """Looks for the trees of one gripper at one value."""

    def __init__(self, grasps: Grasps, arm: Arm, value: float, limbs: Limbs | None) -> None:
        self._arm, self._value, self._limbs = arm, value, limbs
        self._loops = [grasps.loop(sign) for sign in SIGNS]
        self._trees, self._ends = list[bytes](), self._loops[0].bounds[-1] > CODES

    def refute(self, most: int, leeway: float) -> Refutation | None:
        """The refutation, if so many nodes are enough for each tree, or each part of it."""
        while len(self._trees) < len(self._loops):
            tree = None if self._ends else self._tree(self._loops[len(self._trees)], most, leeway)
            if tree is None:
                return None
            self._trees.append(tree)
        names = (*(link.name for link in self._arm.chain.links), *COORDINATES)
        box = tuple(zip(*(end.tolist() for end in self._loops[0].ranges()), strict=True))
        about = self._arm.gripper, self._value, names, box, b"".join(self._trees)
        if self._limbs is None:
            return Refutation(*about, grasped=True)
        return Refutation(*about, beside=self._limbs.used(self._value), parked=True, grasped=True)

    def _tree(self, loop: Loop, most: int, leeway: float) -> bytes | None:
        def divide(low: Array, high: Array) -> bytes | None:
            outcome, tree = _divided(loop, low, high, most, leeway)
            self._ends = self._ends or outcome == REACHED
            return tree if outcome == FOUND else None

        box = loop.ranges()
        if self._limbs is None:
            return divide(*box)
        return self._limbs.tree(self._value, loop.bounds[-1], box, divide)


def _divided(loop: Loop, low: Array, high: Array, most: int, leeway: float) -> tuple[int, bytes]:
    """What came of so many nodes, and the tree of a box if it is whole."""
    arm, bar = loop.arm.chain, loop.bar
    hand = bar.end.rotation.middle, bar.end.translation.middle
    tool = (arm.end.rotation.middle, arm.end.translation.middle), hand, loop.ends[1].seen
    ends = tuple((end.arm.reach, end.near + SLACK) for end in loop.ends)
    solids = inner(loop.arm, loop.around), inner(loop.hand.limb, loop.hand.around)
    tree = np.zeros(most, dtype=np.uint8)
    chains = joints(arm), joints(bar)
    outcome, count = divide_loop(low, high, chains, tool, ends, loop.turned, solids, leeway, tree)
    return outcome, tree[:count].tobytes()
