"""Where one hold cannot be had at all values of the container: cells of the wrist's place, one by one."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.embodiment.proof_check.arm import Arm
from services.embodiment.proof_check.places import at_value, region, too_far, wrist_of
from services.embodiment.proof_check.proof.content import LEAF, NO_HOLD, Places, Refutation
from services.embodiment.proof_check.statement import Statement
from services.embodiment.proof_check.tree import halves
from services.embodiment.prove.arrays import Aim, aim, anywhere, inner, joints, loosely
from services.embodiment.prove.tree.boxes import FOUND, divide
from services.embodiment.prove.tree.inner import SLACK

Array = NDArray[np.float64]

COARSE = 0.1  # [m] half width of a cell from which on it is worth a look
FINE = 0.003  # [m] half width of a cell that is not halved any more
NODES = ((0.03, 150), (0.015, 400), (0.006, 2_000), (FINE, 10_000))
"""Nodes of the tree of one cell at one value, by its half width [m]: what is refuted mostly is by fewer."""
LAST = 50_000  # the same, of a cell that is not halved any more
FIRST = 2  # values at which so many are tried: those that refuted the last cells
LESS = 4  # part of them at the others
LEAST = 100  # but so many
ALONE = 3  # part of them for the wrist's place alone, looked at first: joints behind it are not halved then
MOST = 500_000  # nodes that are spent for one gripper
NEAR = 1e-4  # [m] more than what is off between a cell's shift and that of the whole region


@dataclass(frozen=True, slots=True, eq=False)
class _Value:
    """One value of the container: the handle, where its frame is, by how much cells grow, what is solid."""

    handle: Aim
    rotation: Array
    translation: Array
    grown: float
    solids: tuple[object, ...]


class _Search:
    """Looks for a tree of joint positions for one cell after the other."""

    def __init__(self, statement: Statement, arm: Arm, values: list[float]) -> None:
        self.box = arm.chain.ranges()
        self.whole = region(statement, arm)
        self.spent = 0
        self._arm, self._chain, self._wrist = arm, joints(arm.chain), wrist_of(arm)
        self._known = [_value(statement, arm, value, self.whole) for value in values]
        self._order = list(range(len(values)))
        self._anything, self._tree = anywhere(len(arm.chain.links)), np.zeros(LAST, dtype=np.uint8)

    def refute(self, middle: Array, half: Array) -> tuple[int, bytes] | None:
        """Number of a value that refutes a cell, and the tree; mostly it refutes the next cell too."""
        most = next((nodes for width, nodes in NODES if half.max() >= width), LAST)
        for rank, k in enumerate(self._order):
            at, nodes = self._known[k], most if rank < FIRST else max(most // LESS, LEAST)
            cell = _cell(at, self._wrist, middle, half)
            alone = self._divide(at, (self._anything, cell), max(nodes // ALONE, LEAST))
            tree = alone or self._divide(at, (at.handle, cell), nodes)
            if tree is not None:
                self._order.remove(k)
                self._order.insert(0, k)
                return k, tree
        return None

    def _divide(self, at: _Value, aims: tuple[Aim, Aim], nodes: int) -> bytes | None:
        about = self._chain, self._arm.upright, aims, True, False, SLACK, at.solids
        outcome, count = divide(*self.box, *about, self._tree[:nodes])
        self.spent += count
        return self._tree[:count].tobytes() if outcome == FOUND else None


def by_places(
    statement: Statement, arm: Arm, values: list[float], late: Callable[[], bool]
) -> Refutation | None:
    """A refutation of one gripper, if each cell of places of its wrist is refuted at some value in time."""
    if statement.level or not len(statement.target(values[0]).boxes):
        return None
    search = _Search(statement, arm, values)
    parts, stack = list[tuple[int, bytes]](), [search.whole]
    while stack:
        if late():
            return None
        low, high = stack.pop()
        if too_far(statement, arm, low, high):
            parts.append((-1, bytes([NO_HOLD])))
            continue
        middle, half = (low + high) / 2, (high - low) / 2
        last = half.max() < FINE
        found = search.refute(middle, half) if half.max() < COARSE else None
        if found is not None:
            parts.append(found)
            continue
        if last or search.spent > MOST:
            return None
        axis = int(np.argmax(half))
        parts.append((-1, bytes([axis])))
        stack += halves(low, high, axis)
    return _refutation(arm, search, values, parts)


def _refutation(
    arm: Arm, search: _Search, values: list[float], parts: list[tuple[int, bytes]]
) -> Refutation | None:
    """The whole tree, with the values that are needed; None if no cell needs one: then there is no handle."""
    used = [k for k, _ in parts if k >= 0]
    if not used:
        return None
    taken = sorted(set(used))
    nodes = b"".join(tail if k < 0 else bytes([LEAF + taken.index(k)]) + tail for k, tail in parts)
    names = tuple(link.name for link in arm.chain.links)
    box, whole = (
        tuple(zip(low.tolist(), high.tolist(), strict=True)) for low, high in (search.box, search.whole)
    )
    most = max(taken, key=used.count)
    places = Places(tuple(values[k] for k in taken), whole)
    return Refutation(arm.gripper, values[most], names, box, nodes, places)


def _value(statement: Statement, arm: Arm, value: float, whole: tuple[Array, Array]) -> _Value:
    """What is known of a value, once for all cells."""
    goal, none = at_value(statement, arm, value), np.zeros(3)
    at, widest = statement.cell(arm, value, none, none), statement.cell(arm, value, *whole)
    (_, _, (rotations, translations, half)) = aim(arm, at)
    grown = float(half[0, 0] - at.shift[0] + widest.shift[0]) + NEAR
    return _Value(loosely(arm, goal.target), rotations[0], translations[0], grown, inner(arm, goal.around))


def _cell(at: _Value, wrist: Arm, middle: Array, half: Array) -> Aim:
    """Where the wrist is at a value, if at the grasp it was in the cell."""
    place = at.rotation @ middle + at.translation
    tool = np.eye(3), np.zeros(3), wrist.half
    return wrist.reach, tool, (at.rotation[None], place[None], (half + at.grown)[None])
