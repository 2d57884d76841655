"""One gripper's chain, how far its grasp box can be from each joint, and what is beside it.

Bodies beside an arm are on joints other than its own, as another arm's shoulder or a head. Whatever a
gripper does, the joints of these bodies, too, stand somewhere within their limits. The joints that
carry both come first in both chains: base and lift, mostly. In a box of the arm's positions these are in an
interval each; if with them there, wherever the limb's other joints are, a core of the limb meets something
solid, then nothing can be certified with the arm in that box, whatever the gripper holds.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import InputError
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.geometry.interval import Interval, apply, exact
from services.embodiment.proof_check.geometry.mechanics import HERE, Chain, Link, Placement, Tree
from services.embodiment.proof_check.inside.boxes import Core
from services.embodiment.proof_check.inside.solids import Around

Array = NDArray[np.float64]

ROUNDING = 5e-7  # [m] what quaternions and axes of not quite unit length, and upright hinges, can be off by
BALLS = 32  # of those about what a joint carries that are handed inwards
UPRIGHT = 2e-14  # [1] less than 1 is a hinge's cosine to the vertical: 0.2 µm in each metre


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
    """From each joint's origin at most so far to the grasp box.

    Balls about all of it, seen from each joint, are handed inwards; the one that reaches least counts.
    """
    end = apply(chain.end.rotation, exact(corners)) + chain.end.translation
    middles = exact(np.array([np.zeros(3), (end.lo + end.hi).mean(axis=0) / 2]))
    balls = middles, (end[None] - middles[:, None]).norm().hi.max(axis=1)
    reach = np.zeros(len(chain.links))
    for k in range(len(chain.links) - 1, -1, -1):
        far = balls[0].norm().hi + balls[1]
        reach[k] = far.min()
        least = np.argsort(far)[:BALLS]
        balls = _inwards(chain.links[k], balls[0][least], balls[1][least])
    return reach * (1 + 1e-12)


def _inwards(link: Link, middles: Interval, radii: Array) -> tuple[Interval, Array]:
    """Balls about what a joint makes of balls, wherever it stands, seen from the joint before.

    A hinge leaves a middle's place along its axis as it is: what is across it counts as radius, or all of it.
    """
    axis = exact(link.axis)
    if link.turns:
        along, far = axis * (axis * middles).total()[:, None], middles.norm().hi
        off = (
            float(((axis * axis).total() - exact(1.0)).magnitude().hi) * far
        )  # an axis not quite of length 1
        radii = np.concatenate((radii + (middles - along).norm().hi + off, radii + far))
        none = np.zeros_like(along.lo)
        middles = Interval(np.concatenate((along.lo, none)), np.concatenate((along.hi, none)))
    else:
        middles = middles + axis * exact((link.lower + link.upper) / 2)
        radii = radii + (link.upper - link.lower) / 2 * (1 + 1e-12) + ROUNDING
    return apply(link.before.rotation, middles) + link.before.translation, radii * (1 + 1e-12)


def upright(chain: Chain) -> int:
    """How many of the first joints only lift, shift and turn about the vertical."""
    at = HERE
    for k, link in enumerate(chain.links):
        at = at @ link.before
        up = apply(at.rotation, exact(link.axis))[..., 2].magnitude()
        if link.turns and float(up.lo) < 1 - UPRIGHT:
            return k
    return len(chain.links)


@dataclass(frozen=True, slots=True, eq=False)
class Beside:
    """A limb beside an arm, with the container at one value.

    Attributes:
        limb: Its chain, from the world to the body at its end, and the cores on it; it has no gripper.
        around: What is solid for these.
        shared: How many of its first joints are the arm's too.
    """

    limb: Arm
    around: tuple[Around, ...]
    shared: int

    def box(self, low: Array, high: Array) -> tuple[Array, Array]:
        """All positions of the limb's joints with the arm in a box, lower and upper ends, shape (m,)."""
        lower, upper = self.limb.chain.ranges()
        return (
            np.concatenate((low[: self.shared], lower[self.shared :])),
            np.concatenate((high[: self.shared], upper[self.shared :])),
        )


def beside(arm: Arm, limb: Arm, around: tuple[Around, ...]) -> Beside:
    """A limb beside an arm; both are of one robot and base."""
    both = zip(arm.chain.links, limb.chain.links, strict=False)
    differs = [one.name != other.name for one, other in both] + [True]
    return Beside(limb, around, differs.index(True))


def chain_to(tree: Tree, body: str, root: Placement, tolerances: Tolerances) -> Chain:
    """The joints that carry a body, each for itself anywhere in its limits.

    Raises:
        InputError: There is no such body, or a joint is not kept to limits of its own.
    """
    joints = tree.path(body)
    if not joints or any(joint.mimic for joint in joints):
        raise InputError(f"a proof from {body}", allowed="a body on joints of which none mimics another")
    chain = tree.chain(joints, root, tolerances.position)
    if not all(np.isfinite((link.lower, link.upper)).all() for link in chain.links):
        raise InputError(f"a proof from {body}", allowed="a body whose slides have limits")
    return chain
