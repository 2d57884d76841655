"""Roads: how a parked robot drives among the furniture, straight or over a lattice of base poses.

Containers of one kitchen share what is known of free poses, and nothing else: no answer depends on what was
asked before.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Drive
from services.embodiment.body.limb import Limb
from services.embodiment.body.parked import Parked
from services.embodiment.body.world import Rules, World
from services.embodiment.ways.lattice import Lattice
from services.embodiment.ways.paths import shortened
from services.embodiment.ways.spaces import DriveSpace

Array = NDArray[np.float64]

SHORTCUTS = 30


@dataclass(slots=True, eq=False)
class Roads:
    """Drives of a robot whose arms are carried in one way.

    Attributes:
        space: Decides what is free.
        posture: x with the arm as it is carried, the base at 0, shape (n,).
        lattice: Where no straight drive leads.
    """

    space: DriveSpace
    posture: Array
    lattice: Lattice
    rng: np.random.Generator = field(default_factory=np.random.default_rng)

    def begin(self, seed: int) -> None:
        """Be ready for another question, as if it were the first."""
        self.rng = np.random.default_rng(seed)
        self.lattice.begin()

    def straight(self, start: Array, goal: Array) -> Array | None:
        """Corners of the straight drive, shape (K, 3), or None if it is not free."""
        return self.space.edge(start, goal) if self.space.free(start, goal) else None

    def around(self, start: Array, goal: Array, late: Callable[[], bool]) -> Array | None:
        """Corners of a free drive over the lattice, shape (K, 3), or None."""
        path = self.lattice.road(start, goal, late)
        if path is None:
            return None
        end = goal.copy()
        end[2] += 2 * np.pi * np.round((path[-1][2] - goal[2]) / (2 * np.pi))
        return shortened(self.space, self._pulled([start, *path, end]), self.rng, SHORTCUTS)

    def _pulled(self, path: list[Array]) -> list[Array]:
        """Those of the poses that are left when each leads straight as far on as halving the rest finds."""
        at, kept = 0, [path[0]]
        while at < len(path) - 1:
            there = len(path) - 1
            while there > at + 1 and not self.space.free(path[at], path[there]):
                there = (at + there) // 2
            kept.append(path[there])
            at = there
        return kept


Known = dict[tuple[str, bool], Roads]
"""Those of a scene, by gripper, and whether its arm is parked."""


def make_roads(world: World, limb: Limb, posture: Array, rules: Rules, drive: Drive) -> Roads:
    """Roads of the robot with that limb carried so, its hand open."""
    space = DriveSpace(Parked(world, limb.q(posture), rules), drive)
    return Roads(space, posture, Lattice(space))
