r"""How far the grasp box can be from a joint in boxes of positions: what is behind it may be bent there.

Seen from the origin of joint k, only the joints behind it move anything. Let a unit direction u go from that
origin to the middle of the grasp box, or to the origin of a joint m. In the middle of a box of positions let
a corner, or that origin, be a along u from the joint, forth or back, and b beside that line. In all of the
box it moves by at most s along u and by at most w at all (`Swing`), so it is no farther from the joint than

.. math:: \sqrt{(a + s)^2 + (b + w)^2};

and the grasp box no farther than that, with joint m by as much more as it is from there at all (`Arm.reach`).
How joint k itself stands does not count, nor do those before it.
"""

import numpy as np
from numpy.typing import NDArray

from services.embodiment.proof_check.arm import Arm
from services.embodiment.proof_check.geometry.interval import Interval, apply, cross, exact
from services.embodiment.proof_check.geometry.mechanics import HERE, SHORTER, Placement, Swing
from services.embodiment.proof_check.geometry.shapes import SIGNS

Array = NDArray[np.float64]

LONGER = 1 + 1e-11  # [1] by less than that directions are shorter than 1
CLOSE = 1e-6  # [m] nearer to a joint than that, a point has no direction from there


def stretches(arm: Arm, k: int, swing: Swing, grasp: Placement) -> Array:
    """How far the grasp box can be from joint k's origin, in each of L boxes of positions [m], shape (L,).

    Args:
        arm: Whose grasp box it is.
        k: Index of the joint.
        swing: Of all joints of the arm.
        grasp: Where the middle of the grasp box is in the middles of the boxes, L placements.
    """
    last, origin = len(arm.chain.links), swing.origins[:, k]
    farthest = np.full(len(swing.half), arm.reach[k])
    for m in range(k + 2, last):
        at = Placement(HERE.rotation, swing.origins[:, m])
        far = _farthest(origin, at, np.zeros(3), swing.of(slice(k + 1, m + 1)))
        farthest = np.minimum(farthest, far + arm.reach[m])
    return np.minimum(farthest, _farthest(origin, grasp, arm.half, swing.of(slice(k + 1, last))))


def _farthest(origin: Interval, at: Placement, own: Array, swing: Swing) -> Array:
    """The same of boxes, at L placements, that these joints carry; half extents [m], shape (3,)."""
    away = at.translation - origin
    length = np.linalg.norm(away.middle, axis=1, keepdims=True)
    d = np.where(length > CLOSE, away.middle / np.maximum(length, CLOSE), np.eye(3)[0]) * SHORTER
    corners = away[:, None] + apply(at.rotation[..., None, :, :], exact(SIGNS * own))
    ways = exact(d)[:, None]
    ahead = (ways * corners).total().magnitude().hi + swing.along(d, at, own)[:, None]
    beside = cross(ways, corners).norm().hi + swing.whole(at, own)[:, None]
    return np.hypot(ahead, beside).max(axis=1) * LONGER
