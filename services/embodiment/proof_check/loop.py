r"""An arm and the grasps of a bar, which have the tool at one place: a chain that is closed there.

The arm's joints carry the tool, and so do the coordinates of a grasp, from the bar's side. In a box of
positions of both, each side moves the tool no farther than `Swing` says. No motion is in the box where

- the origin of one of the arm's joints is farther from where the grasp has the tool, or the wrist, than the
  arm reaches from there, as it is bent in the box (`stretch.py`). The tool's origin, and that of the arm's
  last joint, which is the wrist, have to be where the grasp has them;
- an axis of the tool points otherwise: the middles of both sides differ by more than both sides turn it;
- a core of the arm, or one of the hand from the bar's side, meets something solid;
- with the arm in it, a limb beside the arm cannot be clear of everything solid (`arm.py`).

Boxes are halved along joints of the arm and along coordinates of the grasp in one tree: where the arm's
shoulder is in something solid, it is so for all grasps at once.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import InputError
from services.embodiment.proof_check.arm import ROUNDING, Arm, Beside
from services.embodiment.proof_check.geometry.interval import Interval, apply, exact
from services.embodiment.proof_check.geometry.mechanics import HERE, SHORTER, Chain, Placement, Swing
from services.embodiment.proof_check.inside.solids import Around
from services.embodiment.proof_check.stretch import stretches
from services.embodiment.proof_check.tree import Block, all_pierced, firsts, leaves_of, middles, parts_of

Array = NDArray[np.float64]

AXES = 3
TURNED = 1e-9  # [1] more than products of directions are off by


@dataclass(frozen=True, slots=True, eq=False)
class End:
    """A point that arm and grasp have at one place.

    Attributes:
        arm: That ends there.
        seen: The point, from the tool [m], shape (3,).
        near: How far apart both may have it [m].
    """

    arm: Arm
    seen: Array
    near: float


@dataclass(frozen=True, slots=True, eq=False)
class Loop:
    """What is to be refuted of one gripper and all grasps of a bar.

    Attributes:
        ends: The tool's origin, of an arm with its cores, and the wrist.
        around: What is solid.
        bar: From the world to the tool, by way of the bar: its joints are the coordinates of a grasp.
        hand: Cores that the tool carries, with these for joints, and what is solid about them.
        turned: How differently both sides may have an axis of the tool [1].
        beside: Limbs whose trees a box may be handed to.
    """

    ends: tuple[End, End]
    around: tuple[Around, ...]
    bar: Chain
    hand: Beside
    turned: float
    beside: tuple[Beside, ...] = ()

    @property
    def arm(self) -> Arm:
        """The gripper's."""
        return self.ends[0].arm

    @property
    def bounds(self) -> tuple[int, ...]:
        """From which number on leaves name joints before the wrist, axes, cores of the arm, of the hand.

        Those before the first are of joints, or the tool's origin itself; the last is how many there are.
        """
        near = len(self.arm.chain.links) + 1
        counts = near, near, AXES, len(self.arm.cores), len(self.hand.limb.cores)
        return tuple(np.cumsum(counts).tolist())

    def ranges(self) -> tuple[Array, Array]:
        """Lower and upper ends of all positions: of the arm's joints, then of the grasp, shape (n + 4,)."""
        (low, high), (least, most) = self.arm.chain.ranges(), self.bar.ranges()
        return np.concatenate((low, least)), np.concatenate((high, most))


def refuted_loop(loop: Loop, nodes: Iterator[int], low: Array, high: Array) -> int:
    """Number of leaves of a tree, each of which is refuted; nodes beyond its end are left.

    Args:
        loop: What is to be refuted.
        nodes: Of the tree.
        low: Of the box that it covers, shape (n + 4,), as `Loop.ranges`.
        high: Of the same.

    Raises:
        InputError: One leaf is not refuted, or the tree does not cover the box.
    """
    *bounds, codes = loop.bounds
    leaves, count = leaves_of(nodes, low, high, codes, loop.beside), 0
    for kind, part in parts_of(leaves, [*bounds, *firsts(codes, loop.beside)]):
        count += len(part)
        _refuted(loop, kind, part)
    return count


def _refuted(loop: Loop, kind: int, part: Block) -> None:
    """All boxes of one kind are refuted.

    Raises:
        InputError: One is not.
    """
    n = len(loop.arm.chain.links)
    if kind < len(loop.ends):
        _all_apart(loop, loop.ends[kind], part)
    elif kind == len(loop.ends):
        _all_turned(loop, part)
    elif kind == len(loop.ends) + 1:
        all_pierced(loop.arm, loop.around, [(low[:n], high[:n], code) for low, high, code in part])
    elif kind > len(loop.ends) + 2:
        one = loop.beside[kind - len(loop.ends) - 3]
        all_pierced(one.limb, one.around, part)
    else:
        cores = [(low[n:], high[n:], code) for low, high, code in part]
        all_pierced(loop.hand.limb, loop.hand.around, cores)


def _sides(chain: Chain, bar: Chain, part: Block) -> tuple[Placement, Swing, Placement, Swing]:
    """Where the ends of both chains are in the middles of boxes, and how their joints move them."""
    middle, half = middles(part)
    n = len(chain.links)
    return *chain.swing(middle[:, :n], half[:, :n]), *bar.swing(middle[:, n:], half[:, n:])


def _all_apart(loop: Loop, end: End, part: Block) -> None:
    """In each box the named joint's origin, n for the end itself, is too far from where the grasp has it.

    Raises:
        InputError: It is not, as far as was shown.
    """
    own, swing, at, bar = _sides(end.arm.chain, loop.bar, part)
    named, n = np.array([one[2] for one in part]), len(end.arm.chain.links)
    there = at.translation + apply(at.rotation, exact(end.seen))
    for k in np.unique(named).tolist():
        of = np.flatnonzero(named == k)
        mine = own.translation[of] if k == n else swing.origins[of, k]
        before = swing.some(of).of(slice(k + 1))
        apart = _between(mine, before, there[of], bar.some(of)) - end.near - ROUNDING
        reach = 0.0 if k == n else float(end.arm.reach[k])
        left = np.flatnonzero(apart <= reach)
        if len(left) and k < n:
            which = of[left]
            far = stretches(end.arm, k, swing.some(which), own.some(which))
            left = left[apart[left] <= far + ROUNDING]
        if len(left):
            name = "the hand" if k == n else loop.arm.chain.links[k].name
            raise InputError(
                f"{name} can come as near as {apart[left].min():.4f} m to where a grasp has it, as far as "
                "was shown",
                allowed=f"more than {reach:.4f} m, or than the arm reaches as it is bent",
            )


def _between(mine: Interval, swing: Swing, there: Interval, bar: Swing) -> Array:
    """How far apart points are all the time that both sides carry [m], lower bounds, shape (L,)."""
    d = _toward((mine.lo + mine.hi - there.lo - there.hi) / 2)
    gap = (exact(d) * (mine - there)).total().lo
    none = np.zeros(3)
    ways = (side.along(d, Placement(HERE.rotation, at), none) for side, at in ((swing, mine), (bar, there)))
    return gap - sum(ways)


def _all_turned(loop: Loop, part: Block) -> None:
    """In each box the named axis of the tool points otherwise than the grasp has it.

    Raises:
        InputError: It need not, as far as was shown.
    """
    tool, swing, at, bar = _sides(loop.arm.chain, loop.bar, part)
    row, named = np.arange(len(part)), np.array([one[2] for one in part])
    mine, there = tool.rotation.T[row, named], at.rotation.T[row, named]
    d = _toward((mine.lo + mine.hi - there.lo - there.hi) / 2)
    gap = (exact(d) * (mine - there)).total().lo
    beyond = gap - swing.turned(d, mine) - bar.turned(d, there) - loop.turned - TURNED
    if not (beyond > 0).all():
        raise InputError(
            f"the hand can be turned as a grasp has it: to within {-beyond.min():.4f}, as far as was shown",
            allowed="a hand that is turned otherwise",
        )


def _toward(away: Array) -> Array:
    """Directions, no longer than 1, of vectors (L, 3)."""
    return away * SHORTER / np.maximum(np.linalg.norm(away, axis=1, keepdims=True), np.finfo(float).tiny)
