"""Bodies beside an arm: on joints other than its own, as another arm's shoulder or a head.

Whatever a gripper does, the joints of these bodies, too, stand somewhere within their limits. The joints that
carry both come first in both chains: base and lift, mostly. In a box of the arm's positions these are in an
interval each; if with them there, wherever the limb's other joints are, a core of the limb meets something
solid, then nothing can be certified with the arm in that box, whatever the gripper holds.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import InputError
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.arm import Arm
from services.embodiment.proof_check.inside.cores import Around
from services.embodiment.proof_check.mechanics import Chain, Placement, Tree

Array = NDArray[np.float64]


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
        ends = np.array([[link.lower, link.upper] for link in self.limb.chain.links]).T
        return (
            np.concatenate((low[: self.shared], ends[0, self.shared :])),
            np.concatenate((high[: self.shared], ends[1, self.shared :])),
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
