"""Trees of boxes of joint positions, each leaf of which is refuted; in interval arithmetic.

From the middle of a box, moving its joints one after the other from the base outwards, a point moves by at
most its distance from each axis, as it is in the middle, times the way to the box's end.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import InputError
from services.embodiment.proof_check.arm import ROUNDING, Arm
from services.embodiment.proof_check.content import LEAF
from services.embodiment.proof_check.cores import Around, pierced
from services.embodiment.proof_check.interval import Interval, apply, cross, exact
from services.embodiment.proof_check.mechanics import Chain, Placement, levers
from services.embodiment.proof_check.statement import Target

Array = NDArray[np.float64]
Block = list[tuple[Array, Array, int]]
"""Lower and upper ends of boxes, and what each names."""

BLOCK = 2048  # leaves that are checked at once


@dataclass(frozen=True, slots=True, eq=False)
class Goal:
    """What refutes a box: an arm that comes to no target, nor to a place of its wrist, or meets a solid.

    Attributes:
        around: What is solid.
        level: Whether only heights are known.
        wrist: The arm to the origin of its last joint, and where that has to be; None if anywhere.
    """

    arm: Arm
    target: Target
    around: tuple[Around, ...]
    level: bool
    wrist: tuple[Arm, Target] | None = None

    @property
    def codes(self) -> int:
        """How many things a leaf can name: joints and fingers, cores, and joints and the wrist's place."""
        near = len(self.arm.chain.links) + 1
        return near + len(self.arm.cores) + (0 if self.wrist is None else near)


def refuted_boxes(goal: Goal, nodes: Iterator[int], low: Array, high: Array) -> int:
    """Number of leaves of one tree, each of which is refuted; nodes beyond its end are left.

    Raises:
        InputError: One is not, or the tree does not cover the box.
    """
    near, cores = len(goal.arm.chain.links) + 1, len(goal.arm.cores)
    leaves, count = _leaves(nodes, low, high, goal.codes), 0
    while block := list(islice(leaves, BLOCK)):
        count += len(block)
        kinds = np.digitize([leaf[2] for leaf in block], [near, near + cores])
        parts = [[leaf for leaf, kind in zip(block, kinds, strict=True) if kind == k] for k in range(3)]
        if parts[0]:
            all_far(goal.arm, goal.target, parts[0], goal.level)
        if parts[1]:
            _all_pierced(goal.arm, goal.around, parts[1])
        if parts[2] and goal.wrist is not None:
            all_far(*goal.wrist, [(a, b, code - near - cores) for a, b, code in parts[2]], goal.level)
    return count


def _leaves(nodes: Iterator[int], low: Array, high: Array, codes: int) -> Iterator[tuple[Array, Array, int]]:
    """Boxes of the leaves, and what each of them names; together they are the whole box.

    Raises:
        InputError: The tree ends early, or names what is not there.
    """
    stack = [(low, high)]
    while stack:
        low, high = stack.pop()
        node = next(nodes, None)
        if node is None or node % LEAF >= (codes if node >= LEAF else len(low)):
            raise InputError("the proof's tree is damaged", allowed="a whole tree over the arm's joints")
        if node >= LEAF:
            yield low, high, node - LEAF
            continue
        stack += halves(low, high, node)


def halves(low: Array, high: Array, axis: int) -> list[tuple[Array, Array]]:
    """The upper and the lower half of a box, in the order in which a stack takes them."""
    upper_low, lower_high = low.copy(), high.copy()
    upper_low[axis] = lower_high[axis] = (low[axis] + high[axis]) / 2
    return [(upper_low, high), (low, lower_high)]


def _all_pierced(arm: Arm, around: tuple[Around, ...], block: Block) -> None:
    """In each box the named core has a point of something solid in it.

    Raises:
        InputError: It has none, as far as was shown.
    """
    low, high = (np.array([one[k] for one in block]) for k in (0, 1))
    named = np.array([one[2] for one in block]) - len(arm.chain.links) - 1
    middle = (low + high) / 2
    half = np.maximum(high - middle, middle - low) * (1 + 1e-12)
    for c in np.unique(named).tolist():
        of = named == c
        if not (pierced(arm.cores, c, arm.chain, around, (middle[of], half[of])) > 0).all():
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
    low, high = (np.array([one[k] for one in block]) for k in (0, 1))
    named = np.array([one[2] for one in block])
    middle = (low + high) / 2
    half = np.maximum(high - middle, middle - low) * (1 + 1e-12)
    origins, axes, tool = arm.chain.frames(middle)
    for k in np.unique(named):
        of = named == k
        if k == len(arm.chain.links):
            at = Placement(tool.rotation[of], tool.translation[of])
            _box_apart(arm, target, at, (origins[of], axes[of], half[of]), level)
            continue
        arms = levers(origins[of], axes[of], int(k), arm.chain.links)
        if level:
            arms = np.where(
                np.arange(k + 1) < arm.upright, rises(arm.chain, axes[of].magnitude().hi)[:, : k + 1], arms
            )
        moved = (arms * half[of, : k + 1]).sum(axis=1) * (1 + 1e-12)
        apart = target.distance(origins[of][:, k], level) - moved
        short = np.flatnonzero(~(apart > arm.reach[k] + ROUNDING))
        if len(short):
            name = arm.chain.links[k].name
            worst = float(apart[short].min())
            raise InputError(
                f"{name} can come as near as {worst:.4f} m to the handle, as far as was shown",
                allowed=f"more than {arm.reach[k]:.4f} m, its distance to the fingers",
            )


def _box_apart(
    arm: Arm, target: Target, tool: Placement, joints: tuple[Interval, Interval, Array], level: bool
) -> None:
    """The grasp box is apart from the handle: no point of it moves farther than the gap in the middle.

    Raises:
        InputError: It is not, as far as was shown.
    """
    origins, axes, half = joints
    last = len(arm.chain.links)
    centre = apply(tool.rotation, exact(arm.middle)) + tool.translation
    turns = np.array([link.turns for link in arm.chain.links])
    radius = float(np.linalg.norm(arm.half)) * (1 + 1e-12)
    arms = cross(centre[:, None] - origins, axes).norm().hi + radius
    arms = np.where(turns, arms, 1.0)
    if level:
        arms = np.where(np.arange(last) < arm.upright, rises(arm.chain, axes.magnitude().hi), arms)
    moved = (arms * half).sum(axis=1) * (1 + 1e-12)
    gap = target.gap(Placement(tool.rotation, centre), arm.half, level) - moved
    if not (gap > 0).all():
        raise InputError(
            f"the fingers can come to the handle: {float(gap.min()):.4f} m between them, as far as was shown",
            allowed="a gap",
        )


def rises(chain: Chain, axes: Array) -> Array:
    """How far an upright joint lifts what it carries for a unit of it; `axes` are magnitudes (L, n, 3)."""
    slides = np.array([not link.turns for link in chain.links])
    return np.where(slides, axes[:, :, 2], 0.0)
