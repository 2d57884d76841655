"""Levenberg and Marquardt's descent within bounds, of one limb whose hand is about one handle."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from services.embodiment.descent.depths import Depths
from services.embodiment.descent.downhill import PLACES, descend
from services.embodiment.descent.pinch import Face, Pose, Room

Array = NDArray[np.float64]
Held = tuple[Array, float]

NOWHERE = np.eye(3), np.zeros(3)


@dataclass(frozen=True, slots=True)
class Bounds:
    """What may move, and between which limits, each of shape (n,)."""

    moves: NDArray[np.bool_]
    lower: Array
    upper: Array

    def beside(self, x: Array, change: Array) -> Array:
        """x, changed by so much of what may move."""
        return np.clip(x + np.where(self.moves, change, 0.0), self.lower, self.upper)


@dataclass(slots=True, eq=False)
class Solver:
    """Descents from postures x (n,) within bounds: where each comes to, and what is left there.

    That is the root of the sum of squares of what the hand lacks of its place and, where it is said by which
    shares its joints are closed (F,) and where the container is, of what shapes lack of their distances.
    """

    depths: Depths
    bounds: Bounds
    _about: tuple = field(init=False)
    _room: tuple = field(init=False)

    def __post_init__(self) -> None:
        depths, limb, world = self.depths, self.depths.limb, self.depths.world
        n, joints = len(limb.lower), len(limb.chain[3])
        expansion = np.ascontiguousarray(limb.expansion)
        self._about = limb.chain, depths.scene, depths.pairs, depths.levers, expansion
        tool = np.empty((3, 3)), np.empty(3), np.empty((joints, 3)), np.empty((joints, 3)), np.empty((6, n))
        places = np.empty(PLACES), np.empty((PLACES, n))
        self._room = places, np.empty(world.scene.model.nq), tool, *depths.room

    def pinch(
        self, x: Array, goal: tuple[Face, Room], held: Held | None, steps: int, enough: float
    ) -> tuple[Array, float]:
        """A face of the handle comes into a room between the fingers."""
        return self._down(x, (False, *goal, NOWHERE), held, steps, enough)

    def lead(self, x: Array, tool: Pose, held: Held | None, steps: int, enough: float) -> tuple[Array, float]:
        """The tool comes to a pose."""
        nothing = NOWHERE[1], NOWHERE[1], NOWHERE[1]
        return self._down(x, (True, (*nothing, 0.0, 0.0), nothing, tool), held, steps, enough)

    def _down(
        self, x: Array, goal: tuple, held: Held | None, steps: int, enough: float
    ) -> tuple[Array, float]:
        there, depths, bounds = x.copy(), self.depths, self.bounds
        q = depths.limb.rest if held is None else depths.q(np.zeros(len(x)), *held)
        limits = bounds.moves, bounds.lower, bounds.upper
        left = descend(there, goal, (held is not None, q), self._about, limits, steps, enough, self._room)
        return there, float(left)
