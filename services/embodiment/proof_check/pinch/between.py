r"""Where the handle is between two fingers: a point of a box about it, seen from the tool.

Certification accepts a hold only if, when the container begins to move, two fingers press on the handle
along the closing direction, y of the tool, and reach over it: each of them still touches it when first
moved by `engaged` towards the palm, along -x, and then along y. So far it is moved along y as it is until
it touches, at most `contact` inwards or twice that and a step outwards (`certify.held.grip`), and no more
than `engaged` tan(`facing`) farther inwards.

So a point a of the handle is in a box about one of the fingers, moved so, and a point b in one about the
other. What lies between a and b need not be handle, but is in a box about all of it. With the one finger's
box from a_0 to a_1 along y, and the other's from b_0 to b_1, some point between a and b has a y from the
smaller to the larger of a_1 and b_0: if neither a nor b has, they lie on both sides of that. Its x and z
are amid those of both boxes. That is a slab, mostly millimetres wide, where the grasp box has the width of
the open hand. As a point of the handle's frame it stays in the slab while the tool keeps its pose on the
handle, but for what the tool slips and turns.

Nothing is asked of the form of fingers and handle, nor of which side a finger presses on.

Fingers may overlap at their roots, so that the slab about all of them is wide where only their ends come
to. So they may be parted at some x of the tool. Of a and b, both are beyond it: then a slab between boxes
about what there is of each finger beyond it has that point. Or one is not: then that point of the handle is
in a box about what there is of all fingers before it. Each hold is one of both.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import chain, combinations

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Gripper
from sdt_kg.mechanism import Mechanism
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.geometry.interval import exact
from services.embodiment.proof_check.geometry.mechanics import HERE, Placement, Tree
from services.embodiment.proof_check.geometry.shapes import Corners, extents, finger_shapes, hull
from services.embodiment.proof_check.pinch.fingers import groups

Array = NDArray[np.float64]

APPROACH, CLOSING = 0, 1
"""Axes of the tool: along which it comes near, and along which the fingers close."""
STEP = 1e-3  # [m] farther out than twice `contact` certification begins to look for where a finger touches
ROUNDING = 1e-9  # [m] more than a sum of lengths of some metres is off by


@dataclass(frozen=True, slots=True)
class Along:
    """Where along its fingers a hand has the handle.

    Attributes:
        at: Place along x of the tool, its fingers moved by `engaged` towards the palm [m].
        beyond: Whether both fingers touch the handle beyond that; else one of them does before.
    """

    at: float
    beyond: bool


def slab(tree: Tree, gripper: Gripper, tolerances: Tolerances, along: Along | None = None) -> Corners | None:
    """Corners of the box in the tool's frame in which that point is at the grasp [m].

    None where there are no two fingers, or one has no shape; or none of these in that part.

    Args:
        tree: The robot's.
        gripper: Whose fingers.
        tolerances: Of certification.
        along: Which holds are meant; None: all.
    """
    fingers, inwards = _fingers(tree, gripper, tolerances), inward(tolerances)
    if fingers is None:
        return None
    if along is not None and not along.beyond:
        before = _cut(chain.from_iterable(fingers), most=along.at)
        return _closed(hull(before), inwards) if before else None
    if along is not None:
        fingers = [beyond for boxes in fingers if (beyond := _cut(boxes, least=along.at))]
    found = [_between(one, other, inwards) for one, other in combinations(map(hull, fingers), 2)]
    return hull(found) if found else None


@lru_cache(maxsize=32)
def places(mechanism: Mechanism, gripper: Gripper, tolerances: Tolerances) -> tuple[float, ...]:
    """Where fingers may be parted, so that something is on both sides: where shapes end [m], in order."""
    tree = Tree(mechanism)
    fingers = _fingers(tree, gripper, tolerances) or ()
    each = sorted({np.nextafter(high[APPROACH], np.inf) for _, high in chain.from_iterable(fingers)})
    return tuple(at for at in each if slab(tree, gripper, tolerances, Along(at, beyond=True)) is not None)


def inward(tolerances: Tolerances) -> float:
    """How far a finger is moved along the closing direction at most until it touches the handle [m]."""
    inwards = tolerances.contact + tolerances.engaged * float(np.tan(tolerances.facing))
    return max(2 * tolerances.contact + STEP, inwards)


def _fingers(tree: Tree, gripper: Gripper, tolerances: Tolerances) -> Sequence[Sequence[Corners]] | None:
    """Boxes about the shapes of each finger, moved by `engaged` towards the palm; None without two such."""
    parts = groups(tree, gripper).values()
    bodies = [tuple(body for bodies in one.values() for body in bodies) for one in parts]
    each = [finger_shapes(tree.mechanism, replace(gripper, fingers=one), tolerances) for one in bodies]
    known = [boxes for boxes in each if boxes is not None]
    if len(known) < len(each) or len(known) < 2:
        return None
    back = np.zeros(3)
    back[APPROACH] = -tolerances.engaged
    return [[(low + back, high + back) for low, high in boxes] for boxes in known]


def _cut(boxes: Iterable[Corners], least: float = -np.inf, most: float = np.inf) -> list[Corners]:
    """What there is of boxes between two places along the approach."""
    found: list[Corners] = []
    for low, high in boxes:
        if low[APPROACH] <= most and high[APPROACH] >= least:
            ends = low.copy(), high.copy()
            ends[0][APPROACH], ends[1][APPROACH] = max(low[APPROACH], least), min(high[APPROACH], most)
            found.append(ends)
    return found


def _closed(box: Corners, along: float) -> Corners:
    """A box about one that is moved by so much along the closing direction."""
    low, high = box[0].copy(), box[1].copy()
    low[CLOSING], high[CLOSING] = low[CLOSING] - along, high[CLOSING] + along
    return low, high


def _between(one: Corners, other: Corners, along: float) -> Corners:
    """The box of points between the boxes of two fingers, each moved by at most `along` as they close."""
    below, above = sorted((one, other), key=lambda box: float(box[0][CLOSING] + box[1][CLOSING]))
    low, high = np.minimum(one[0], other[0]), np.maximum(one[1], other[1])
    low[CLOSING], high[CLOSING] = sorted((below[1][CLOSING] + along, above[0][CLOSING] - along))
    return low, high


def about_all(boxes: list[tuple[Placement, Array]]) -> tuple[Placement, Array]:
    """A box about all these, along the axes of their frame, and its half extents [m], shape (3,)."""
    reaches = [extents(at, half).hi for at, half in boxes]
    low = np.min([at.translation.lo - reach for (at, _), reach in zip(boxes, reaches, strict=True)], axis=0)
    high = np.max([at.translation.hi + reach for (at, _), reach in zip(boxes, reaches, strict=True)], axis=0)
    middle = (low + high) / 2
    half = np.maximum(high - middle, middle - low) + ROUNDING
    return Placement(HERE.rotation, exact(middle)), half
