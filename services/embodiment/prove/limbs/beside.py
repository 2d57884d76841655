"""Where bodies beside the arm are in the way with the container at a value, whatever the gripper does."""

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Gripper
from sdt_kg.mechanism import Joint, JointType
from sdt_kg.motion import BASE_JOINTS
from services.embodiment.proof_check.arm import Arm
from services.embodiment.proof_check.geometry.mechanics import Tree
from services.embodiment.proof_check.places import at_value
from services.embodiment.proof_check.proof.content import LEAF, Refutation
from services.embodiment.proof_check.statement import Statement
from services.embodiment.proof_check.tree import halves
from services.embodiment.prove.limbs.met import CODES, Asked, Box, Met
from services.embodiment.prove.limbs.steps import Climb
from services.embodiment.prove.tree.divided import divided
from services.embodiment.prove.values import Look, at_one

Array = NDArray[np.float64]

CARRIED = 3  # joints behind the base on which bodies are looked at: a lift and two more
LIFT = len(BASE_JOINTS)  # the joint that is halved for all limbs
HALVED = 4  # times at most
SPARSE = 4  # every so many values are looked at first, then those about the best
TRIED = 5  # values at which all of the lift is to be refuted
AMID = 2_000  # boxes of the arm in a part of the lift in which no limb is in the way


Parts = Met | tuple["Parts", "Parts"] | None
"""Of the lift: what is in the way there, or in its lower and upper half; None where nothing is."""


def never() -> bool:
    """Time is not up."""
    return False


class Limbs:
    """Looks where limbs of one robot are in the way; what it finds counts for all its grippers.

    Args:
        statement: What is to be refuted, with a fixed base.
        values: Of the container at which is looked, in order [rad or m].
        late: Whether time is up.
    """

    def __init__(self, statement: Statement, values: list[float], late: Callable[[], bool]) -> None:
        self._late = late
        self._statement, self._bodies = statement, _ends(statement)
        self._values, self._known = values, dict[float, Parts]()
        self._climb: Climb | None = None

    def values(self, arm: Arm) -> list[float]:
        """Values at which limbs are in the way, those first where that is in the largest part of the lift.

        Of equally large ones, those first where fewest boxes show it.
        """
        for value in self._values[::SPARSE]:
            if self._late():
                return []
            self._look(arm, value)
        best = max(self._known, key=self._rank, default=None)
        if best is not None and self._rank(best)[0]:
            k = self._values.index(best)
            for value in self._values[max(k - SPARSE, 0) : k + SPARSE]:
                if self._late():
                    break
                self._look(arm, value)
        found = sorted(self._known, key=self._rank, reverse=True)[:TRIED]
        return [value for value in found if self._rank(value)[0]]

    def refutations(
        self,
        grippers: Sequence[Gripper],
        arms: Mapping[str, Arm],
        by_tree: Look,
        shown: Callable[[Arm, Refutation], bool],
    ) -> list[Refutation] | None:
        """One of each gripper: at one value, by limbs or else by its tree, or by steps; None if one has none.

        Args:
            grippers: Of the robot.
            arms: Theirs, by name.
            by_tree: Looks for a tree of one gripper's arm at a value.
            shown: Whether the check finds so too.
        """

        def look(gripper: Gripper, value: float) -> Refutation | None:
            one = self.at(arms[gripper.name], value, AMID)
            return one if one is not None and shown(arms[gripper.name], one) else by_tree(gripper, value)

        found = at_one(grippers, self.values(next(iter(arms.values()))), look)
        if found is not None:
            return found
        steps = [next((one for one in self.steps(arm) if shown(arm, one)), None) for arm in arms.values()]
        return [one for one in steps if one is not None] if all(steps) else None

    def at(self, arm: Arm, value: float, nodes: int) -> Refutation | None:
        """The refutation of one gripper at such a value, by limbs in parts of the lift, by its arm in others.

        Args:
            arm: The gripper's.
            value: One of `values`.
            nodes: Of the arm's tree in each part that is left.
        """
        goal, box = at_value(self._statement, arm, value), arm.chain.ranges()
        used = self.used(value)
        tree = self.tree(value, goal.codes, box, lambda low, high: divided(goal, low, high, nodes))
        if tree is None:
            return None
        names = tuple(link.name for link in arm.chain.links)
        ends = tuple(zip(*(each.tolist() for each in box), strict=True))
        return Refutation(arm.gripper, value, names, ends, tree, beside=used, parked=True)

    def used(self, value: float) -> tuple[str, ...]:
        """To which bodies limbs go that are in the way at one of `values`, in the order of their codes."""
        return tuple(sorted(_bodies(self._known[value])))

    def tree(
        self, value: float, codes: int, box: Box, divide: Callable[[Array, Array], bytes | None]
    ) -> bytes | None:
        """A tree that goes over to limbs in parts of the lift where these are in the way at one of `values`.

        Args:
            value: That.
            codes: How many things other leaves can name.
            box: Of positions, which begin with those of base and lift.
            divide: The tree of a part that is left, lower and upper ends; None if none is found.
        """
        used = self.used(value)
        if codes + len(used) > CODES:
            return None
        return _tree(self._known[value], {body: codes + k for k, body in enumerate(used)}, box, divide)

    def steps(self, arm: Arm) -> Iterator[Refutation]:
        """Steps from value to value, if in each part of the lift limbs are in the way at some value."""
        if self._known and all(map(any, zip(*map(_shares, self._known.values()), strict=True))):
            about = self._statement, self._bodies, self._values[::SPARSE], arm
            self._climb = self._climb or Climb(*about, self._late)
            yield from self._climb.refutations(arm)

    def _rank(self, value: float) -> tuple[float, int, float]:
        """In how much of the lift limbs are in the way, by how few boxes (less than nothing), and where."""
        parts = self._known[value]
        return _covered(parts), -_nodes(parts), value

    def _look(self, arm: Arm, value: float) -> None:
        if value in self._known:
            return
        limbs = {body: self._statement.beside(arm, body, value, parked=True) for body in self._bodies}
        asked = [Asked(body, one) for body, one in limbs.items() if one.shared > LIFT]
        self._known[value] = _parts(asked, arm.chain.ranges(), HALVED)


def _ends(statement: Statement) -> tuple[str, ...]:
    """Bodies at the ends of short limbs, each with limits; all bodies on the way there are looked at too."""
    tree = Tree(statement.twin.mechanism(statement.robot))
    found: dict[tuple[str, ...], str] = {}
    for body in tree.mechanism.bodies:
        moving = [joint for joint in tree.path(body.name) if joint.type is not JointType.FIXED]
        if 1 < len(moving) <= CARRIED and all(map(_bounded, moving)):
            found[tuple(joint.name for joint in moving)] = body.name
    return tuple(
        body for on, body in found.items() if not any(len(on) < len(o) and o[: len(on)] == on for o in found)
    )


def _bounded(joint: Joint) -> bool:
    return joint.mimic is None and joint.type is not JointType.CONTINUOUS


def _parts(limbs: list[Asked], box: Box, halved: int) -> Parts:
    """What is in the way in a box of the arm's positions, halved so many times at most."""
    found = (one.in_the_way(box) for one in limbs)
    met = next((one for one in found if one is not None), None)
    if met is not None or not halved:
        return met
    upper, lower = (_parts(limbs, half, halved - 1) for half in halves(*box, LIFT))
    return None if lower is None and upper is None else (lower, upper)


def _covered(parts: Parts) -> float:
    """In how much of the lift something is in the way."""
    if parts is None or isinstance(parts, Met):
        return 0.0 if parts is None else 1.0
    return (_covered(parts[0]) + _covered(parts[1])) / 2


def _shares(parts: Parts, halved: int = HALVED) -> list[bool]:
    """Of each equal part of the lift, halved so many times: whether something is in the way there."""
    if parts is None or isinstance(parts, Met):
        return [parts is not None] * 2**halved
    return _shares(parts[0], halved - 1) + _shares(parts[1], halved - 1)


def _nodes(parts: Parts) -> int:
    """Of all trees of limbs."""
    if parts is None or isinstance(parts, Met):
        return 0 if parts is None else len(parts.tree)
    return _nodes(parts[0]) + _nodes(parts[1])


def _bodies(parts: Parts) -> set[str]:
    """To which bodies the limbs go that are in the way."""
    if parts is None:
        return set()
    return {parts.body} if isinstance(parts, Met) else _bodies(parts[0]) | _bodies(parts[1])


def _tree(
    parts: Parts, codes: dict[str, int], box: Box, divide: Callable[[Array, Array], bytes | None]
) -> bytes | None:
    """The tree that goes over to limbs where these are in the way; `codes` are those of the bodies."""
    if isinstance(parts, Met):
        return bytes([LEAF + codes[parts.body]]) + parts.tree
    if parts is None:
        return divide(*box)
    found = [bytes([LIFT])]
    for part, half in zip(parts, reversed(halves(*box, LIFT)), strict=True):
        tree = _tree(part, codes, half, divide)
        if tree is None:
            return None
        found.append(tree)
    return b"".join(found)
