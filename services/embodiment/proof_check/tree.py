"""Trees of boxes of joint positions, each leaf of which is refuted; in interval arithmetic."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import InputError
from services.embodiment.proof_check.arm import ROUNDING, Arm, Beside
from services.embodiment.proof_check.geometry.interval import apply, exact
from services.embodiment.proof_check.geometry.mechanics import HERE, Placement, Swing
from services.embodiment.proof_check.inside.across import reaches_across
from services.embodiment.proof_check.inside.cores import pierced
from services.embodiment.proof_check.inside.solids import Around
from services.embodiment.proof_check.proof.content import LEAF
from services.embodiment.proof_check.stretch import stretches
from services.embodiment.proof_check.target import Target

Array = NDArray[np.float64]
Leaf = tuple[Array, Array, int]
"""Lower and upper ends of a box, and what it names."""
Block = list[Leaf]

BLOCK = 2048  # leaves that are checked at once


@dataclass(frozen=True, slots=True, eq=False)
class Goal:
    """What refutes a box: an arm that comes to no target, nor to a place of its wrist, or meets a solid.

    Attributes:
        around: What is solid.
        level: Whether only heights are known.
        wrist: The arm to the origin of its last joint, and where that has to be; None if anywhere.
        beside: Limbs whose trees a box may be handed to.
    """

    arm: Arm
    target: Target
    around: tuple[Around, ...]
    level: bool
    wrist: tuple[Arm, Target] | None = None
    beside: tuple[Beside, ...] = ()

    @property
    def ends(self) -> tuple[int, int, int]:
        """How many things a leaf can name: joints and fingers, cores, the wrist's; each and those before."""
        near = len(self.arm.chain.links) + 1
        cores = near + len(self.arm.cores)
        return near, cores, cores + (0 if self.wrist is None else near)

    @property
    def codes(self) -> int:
        """How many things a leaf can name in all."""
        return self.ends[-1]


def refuted_boxes(goal: Goal, nodes: Iterator[int], low: Array, high: Array) -> int:
    """Number of leaves of one tree, each of which is refuted; nodes beyond its end are left.

    Raises:
        InputError: One is not, or the tree does not cover the box.
    """
    leaves, count = leaves_of(nodes, low, high, goal.codes, goal.beside), 0
    for kind, part in parts_of(leaves, [*goal.ends[:-1], *firsts(goal.codes, goal.beside)]):
        count += len(part)
        _refuted_part(goal, kind, part)
    return count


def parts_of(leaves: Iterator[Leaf], bounds: Sequence[int]) -> Iterator[tuple[int, Block]]:
    """Leaves of one kind, many at once, and which that is.

    Args:
        leaves: Boxes, and what they name.
        bounds: From which number on that is of the next kind; it is then counted from the first of its kind.
    """
    begins = (0, *bounds)
    while block := list(islice(leaves, BLOCK)):
        kinds = np.digitize([leaf[2] for leaf in block], bounds)
        for kind in np.unique(kinds).tolist():
            each = zip(block, kinds, strict=True)
            yield kind, [(low, high, code - begins[kind]) for (low, high, code), one in each if one == kind]


def _refuted_part(goal: Goal, kind: int, part: Block) -> None:
    """All boxes of one kind are refuted: by the arm, its cores, its wrist, or a limb.

    Raises:
        InputError: One is not.
    """
    if kind == 0:
        all_far(goal.arm, goal.target, part, goal.level)
    elif kind == 1:
        all_pierced(goal.arm, goal.around, part)
    elif kind == 2 and goal.wrist is not None:
        all_far(*goal.wrist, part, goal.level)
    else:
        one = goal.beside[kind - 3]
        all_pierced(one.limb, one.around, part)


def refuted_limb(one: Beside, nodes: Iterator[int], low: Array, high: Array) -> int:
    """The same of the tree of a limb alone, with the arm in a box: each leaf names a core of it.

    Raises:
        InputError: One is not refuted, or the tree does not cover the box.
    """
    leaves, count = _leaves_of_limb(nodes, one, 0, one.box(low, high)), 0
    while block := list(islice(leaves, BLOCK)):
        count += len(block)
        all_pierced(one.limb, one.around, block)
    return count


def firsts(codes: int, beside: tuple[Beside, ...]) -> list[int]:
    """From which number on leaves name a core of each limb, behind all that an arm's leaf can name."""
    return [codes + sum(len(one.limb.cores) for one in beside[:k]) for k in range(len(beside))]


def leaves_of(
    nodes: Iterator[int], low: Array, high: Array, codes: int, beside: tuple[Beside, ...] = ()
) -> Iterator[tuple[Array, Array, int]]:
    """Boxes of the leaves, and what each of them names; together they are the whole box.

    A node that names a limb is followed by the tree of that: its leaves name its cores.

    Raises:
        InputError: The tree ends early, or names what is not there.
    """
    stack, first = [(low, high)], firsts(codes, beside)
    while stack:
        low, high = stack.pop()
        node = next(nodes, None)
        if node is None or node % LEAF >= (codes + len(beside) if node >= LEAF else len(low)):
            raise InputError("the proof's tree is damaged", allowed="a whole tree over the arm's joints")
        if node < LEAF:
            stack += halves(low, high, node)
        elif node < LEAF + codes:
            yield low, high, node - LEAF
        else:
            k = node - LEAF - codes
            yield from _leaves_of_limb(nodes, beside[k], first[k], beside[k].box(low, high))


def _leaves_of_limb(
    nodes: Iterator[int], one: Beside, first: int, box: tuple[Array, Array]
) -> Iterator[tuple[Array, Array, int]]:
    """The same of a limb, whose leaves are numbered like an arm's and name cores alone, from a number on.

    Raises:
        InputError: The tree ends early, or a leaf names no core: a limb is far from the handle anyway.
    """
    near = len(one.limb.chain.links) + 1
    for low, high, code in leaves_of(nodes, *box, near + len(one.limb.cores)):
        if code < near:
            raise InputError("a limb that is refuted by its distance", allowed="cores that meet a solid")
        yield low, high, first + code - near


def halves(low: Array, high: Array, axis: int) -> list[tuple[Array, Array]]:
    """The upper and the lower half of a box, in the order in which a stack takes them."""
    upper_low, lower_high = low.copy(), high.copy()
    upper_low[axis] = lower_high[axis] = (low[axis] + high[axis]) / 2
    return [(upper_low, high), (low, lower_high)]


def middles(block: Block) -> tuple[Array, Array]:
    """Middles of boxes, and how far they reach from there at most, shape (L, n) each."""
    low, high = (np.array([one[k] for one in block]) for k in (0, 1))
    middle = (low + high) / 2
    return middle, np.maximum(high - middle, middle - low) * (1 + 1e-12)


def all_pierced(arm: Arm, around: tuple[Around, ...], block: Block) -> None:
    """In each box the named core, counted from the first, reaches across a solid or keeps a point in it.

    Raises:
        InputError: It has none, as far as was shown.
    """
    middle, half = middles(block)
    named = np.array([one[2] for one in block])
    for c in np.unique(named).tolist():
        of = np.flatnonzero(named == c)
        about = arm.cores, c, arm.chain, around
        left = of[~reaches_across(*about, (middle[of], half[of]))]
        if len(left) and not (pierced(*about, (middle[left], half[left])) > 0).all():
            raise InputError(
                f"{arm.cores[c].body} can be clear of everything solid, as far as was shown",
                allowed="a collision",
            )


def all_far(arm: Arm, target: Target, block: Block, level: bool) -> None:
    """In each box the named joint's origin is farther from the handle than its arm reaches.

    Behind the last joint comes the grasp box itself, all of which is apart from the handle.

    Raises:
        InputError: It is not.
    """
    middle, half = middles(block)
    named = np.array([one[2] for one in block])
    origins, axes, tool = arm.chain.frames(middle)
    turns = np.array([link.turns for link in arm.chain.links])
    upright = arm.upright if level else 0
    grasp = Placement(tool.rotation, apply(tool.rotation, exact(arm.middle)) + tool.translation)
    whole = Swing(origins, axes, half, turns, upright)
    for k in np.unique(named).tolist():
        of = np.flatnonzero(named == k)
        swing = whole.some(of)
        if k == len(arm.chain.links):
            _box_apart(arm, target, grasp.some(of), swing, level)
        else:
            _joint_apart(arm, target, k, swing, grasp.some(of), level)


def _joint_apart(  # noqa: PLR0913, PLR0917  # what a box is refuted by
    arm: Arm, target: Target, k: int, swing: Swing, grasp: Placement, level: bool
) -> None:
    """Joint k's origin is farther from the handle than the grasp box can be from it, in all of each box.

    Raises:
        InputError: It is not, as far as was shown.
    """
    before = swing.of(slice(k + 1), swing.upright)
    at = Placement(HERE.rotation, swing.origins[:, k])
    apart = target.apart(at, np.zeros(3), before, level)
    near = np.flatnonzero(apart <= arm.reach[k] + ROUNDING)
    if not level and len(near):
        far = stretches(arm, k, swing.some(near), grasp.some(near))
        near = near[apart[near] <= far + ROUNDING]
    if len(near):
        raise InputError(
            f"{arm.chain.links[k].name} can come as near as {apart[near].min():.4f} m to the handle, as far "
            "as was shown",
            allowed=f"more than {arm.reach[k]:.4f} m, its distance to the fingers, or that of a bent arm",
        )


def _box_apart(arm: Arm, target: Target, tool: Placement, swing: Swing, level: bool) -> None:
    """The grasp box is apart from the handle in all of each box.

    Raises:
        InputError: It is not, as far as was shown.
    """
    apart = target.apart(tool, arm.half, swing, level)
    if not (apart > 0).all():
        raise InputError(
            f"the fingers can come to the handle: {apart.min():.4f} m between them, as far as was shown",
            allowed="a gap",
        )
