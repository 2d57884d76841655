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
"""

from dataclasses import replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Gripper
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.interval import exact
from services.embodiment.proof_check.mechanics import HERE, Placement, Tree
from services.embodiment.proof_check.pinch.fingers import groups
from services.embodiment.proof_check.shapes import extents, finger_box

Array = NDArray[np.float64]
Corners = tuple[Array, Array]

APPROACH, CLOSING = 0, 1
"""Axes of the tool: along which it comes near, and along which the fingers close."""
STEP = 1e-3  # [m] farther out than twice `contact` certification begins to look for where a finger touches
ROUNDING = 1e-9  # [m] more than a sum of lengths of some metres is off by


def slab(tree: Tree, gripper: Gripper, tolerances: Tolerances) -> Corners | None:
    """Corners of the box in the tool's frame in which that point is at the grasp [m].

    None where there are no two fingers, or one has no shape.
    """
    parts = groups(tree, gripper).values()
    fingers = [tuple(body for bodies in one.values() for body in bodies) for one in parts]
    boxes = [finger_box(tree.mechanism, replace(gripper, fingers=one), tolerances) for one in fingers]
    known = [box for box in boxes if box is not None]
    inwards = tolerances.contact + tolerances.engaged * float(np.tan(tolerances.facing))
    along = max(2 * tolerances.contact + STEP, inwards)
    found = [_between(one, other, along) for one, other in combinations(known, 2)]
    if len(known) < len(boxes) or not found:
        return None
    low, high = np.min([low for low, _ in found], axis=0), np.max([high for _, high in found], axis=0)
    low[APPROACH], high[APPROACH] = low[APPROACH] - tolerances.engaged, high[APPROACH] - tolerances.engaged
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
