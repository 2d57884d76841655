"""Whether one limb is in the way with the arm anywhere in a box of its positions."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.embodiment.proof_check.arm import Beside
from services.embodiment.proof_check.proof.content import LEAF
from services.embodiment.prove.arrays import anywhere, inner, joints
from services.embodiment.prove.tree.boxes import FOUND, divide
from services.embodiment.prove.tree.inner import SLACK

Array = NDArray[np.float64]
Box = tuple[Array, Array]

NODES = 2_000  # of the tree of one limb
CODES = 256 - LEAF  # that leaves can have


@dataclass(frozen=True, slots=True)
class Met:
    """A limb that is in the way in a part of the lift, to which body it goes, and the tree of its joints."""

    body: str
    tree: bytes


class Asked:
    """A limb as compiled loops take it."""

    def __init__(self, body: str, one: Beside) -> None:
        wanted = anywhere(len(one.limb.chain.links))
        self.body, self._one = body, one
        chain, solid = joints(one.limb.chain), inner(one.limb, one.around)
        self._about = chain, 0, (wanted, wanted), False, False, SLACK, solid

    def in_the_way(self, box: Box) -> Met | None:
        """Where a core meets something solid with the arm anywhere in a box, if it is found to."""
        tree = np.zeros(NODES, dtype=np.uint8)
        outcome, written = divide(*self._one.box(*box), *self._about, tree)
        return Met(self.body, tree[:written].tobytes()) if outcome == FOUND else None
