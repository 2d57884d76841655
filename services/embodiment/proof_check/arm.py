"""One gripper's chain, and how far its grasp box can be from each joint."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.embodiment.proof_check.inside.boxes import Core
from services.embodiment.proof_check.interval import apply, exact
from services.embodiment.proof_check.mechanics import HERE, Chain

Array = NDArray[np.float64]

ROUNDING = 1e-7  # [m] what quaternions and axes of not quite unit length, and upright hinges, can be off by
UPRIGHT = 1e-12  # [1] deviation of a hinge's axis from the vertical that counts as none


@dataclass(frozen=True, slots=True, eq=False)
class Arm:
    """One gripper's chain, and how far the grasp box can be from each joint.

    Attributes:
        chain: From the world (fixed base), or from a base somewhere on the floor (else).
        reach: Largest distance from each joint's origin to a point of the grasp box [m], shape (n,).
        upright: How many of the first joints leave every later one upright: lifts and upright hinges.
        middle, half: Of the grasp box, in the tool's frame [m], shape (3,).
        cores: Boxes inside the bodies that the chain carries; none where only heights are known.
    """

    gripper: str
    chain: Chain
    reach: Array
    upright: int
    middle: Array
    half: Array
    cores: tuple[Core, ...] = ()


def make_arm(gripper: str, chain: Chain, corners: Array, upright: int) -> Arm:
    """The arm whose grasp box has these corners in the tool's frame [m], shape (8, 3)."""
    low, high = corners.min(axis=0), corners.max(axis=0)
    half = (high - low) / 2 + ROUNDING
    return Arm(gripper, chain, _reaches(chain, corners), upright, (low + high) / 2, half)


def _reaches(chain: Chain, corners: Array) -> Array:
    """From each joint's origin at most so far to the grasp box: lengths add up."""
    reach = np.zeros(len(chain.links))
    end = apply(chain.end.rotation, exact(corners)) + chain.end.translation
    further = float(end.norm().hi.max())
    for k in range(len(chain.links) - 1, -1, -1):
        reach[k] = further
        link = chain.links[k]
        step = link.before.translation
        if not link.turns:
            axis = apply(link.before.rotation, exact(link.axis))
            ends = (step + axis * exact(q) for q in (link.lower, link.upper))
            further += max(float(one.norm().hi) for one in ends)
        else:
            further += float(step.norm().hi)
    return reach * (1 + 1e-12)


def upright(chain: Chain) -> int:
    """How many of the first joints only lift, shift and turn about the vertical."""
    at = HERE
    for k, link in enumerate(chain.links):
        at = at @ link.before
        up = apply(at.rotation, exact(link.axis))[..., 2].magnitude()
        if link.turns and float(up.lo) < 1 - UPRIGHT:
            return k
    return len(chain.links)
