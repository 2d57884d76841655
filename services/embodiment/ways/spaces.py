"""Spaces for `paths`: an arm over a standing base, and a parked robot that drives."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Drive
from services.embodiment.body.limb import BASE, Limb, ends
from services.embodiment.body.parked import Parked
from services.embodiment.body.world import Rules, World
from services.embodiment.ways.paths import between

Array = NDArray[np.float64]

FINGER_REACH = 0.2  # [m] what a hand reaches beyond the last joint, for step sizes only
ARM_STEP = 0.025  # [m] farthest that any point of the arm moves between two checks
FINE_STEP = 0.015  # [m] the same on a path to be used; bounds the way of any point, two to three-fold
ARM_EXTENSION = 1.2  # [m] that one extension of a tree moves the arm at most
DRIVE_STEP = 0.03  # [m] between two checks of a driving robot
TURN_REACH = 0.6  # [m] what one radian of base rotation counts as


@lru_cache(maxsize=16)
def reaches(limb: Limb) -> Array:
    """How far a point of the limb moves for a unit of each arm variable [m/rad or m/m], shape (n,).

    Kept, so not to be changed.
    """
    lengths = np.linalg.norm(limb.chain[1], axis=1)
    kind, variable = limb.chain[3], limb.chain[4]
    beyond = np.cumsum(lengths[::-1])[::-1] - lengths + np.linalg.norm(limb.chain[8]) + FINGER_REACH
    out = limb.carries.copy()
    for c, k in enumerate(variable):
        if k >= 0:
            out[k] = max(out[k], beyond[c] if kind[c] else np.abs(limb.expansion[:, k]).sum())
    return out


@dataclass(frozen=True, slots=True, eq=False)
class ArmSpace:
    """Arm configurations x with the base standing at x[:3].

    Attributes:
        rest: Scene configuration at x = 0, with fingers and container as they are to be.
        weight: `reaches` of the limb.
    """

    world: World
    limb: Limb
    rules: Rules
    rest: Array
    weight: Array
    base: Array

    def sample(self, rng: np.random.Generator) -> Array:
        x = rng.uniform(*ends(self.limb.lower, self.limb.upper))
        x[BASE] = self.base
        return x

    def distance(self, one: Array, others: Array) -> Array:
        return np.linalg.norm((others - one)[:, 3:] * self.weight[3:], axis=1)

    def towards(self, start: Array, end: Array) -> Array:
        length = self._length(start, end)
        return end if length <= ARM_EXTENSION else start + ARM_EXTENSION / length * (end - start)

    def edge(self, start: Array, end: Array) -> Array:
        return np.stack([start, end])

    def free(self, start: Array, end: Array) -> bool:
        return self._free(start, end, ARM_STEP)

    def finely_free(self, start: Array, end: Array) -> bool:
        """The same, looked at as densely as a path that is to be used."""
        return self._free(start, end, FINE_STEP)

    def _free(self, start: Array, end: Array, step: float) -> bool:
        pieces = int(np.ceil(self._length(start, end) / step)) + 1
        xs = between(start, end, pieces)
        return self.world.contact(self.limb.q(xs, self.rest), self.rules) is None

    def _length(self, start: Array, end: Array) -> float:
        return float(np.abs(end - start) @ self.weight)


@dataclass(frozen=True, slots=True, eq=False)
class DriveSpace:
    """Base poses (x, y, yaw) of a robot whose arms do not move; yaw is a real number."""

    parked: Parked
    drive: Drive

    def stands(self, pose: Array) -> bool:
        """Whether the parked robot touches nothing at a base pose."""
        return bool(self.parked.stands(pose[None])[0])

    def stand_free(self, poses: Array) -> list[bool]:
        """Whether the parked robot touches nothing, at each of many base poses (K, 3)."""
        return self.parked.stands(poses).tolist()

    def distance(self, one: Array, others: Array) -> Array:
        away = others - one
        return np.linalg.norm(away[:, :2], axis=1) + TURN_REACH * np.abs(away[:, 2])

    def edge(self, start: Array, end: Array) -> Array:
        """Straight for an omnidirectional base, else turn, drive (forwards or backwards), turn."""
        away = end[:2] - start[:2]
        if self.drive is Drive.OMNI or np.linalg.norm(away) < 1e-9:
            return np.stack([start, end])
        ahead = np.arctan2(away[1], away[0])
        options = [ahead + k * np.pi + start[2] - _wrap(start[2]) for k in (-2, -1, 0, 1, 2)]
        heading = min(options, key=lambda one: abs(one - start[2]) + abs(end[2] - one))
        return np.array([start, [*start[:2], heading], [*end[:2], heading], end])

    def free(self, start: Array, end: Array) -> bool:
        return self.free_along(self.edge(start, end))

    def free_along(self, poses: Array) -> bool:
        """Whether the straight pieces between base poses (K, 3), one after the other, touch nothing."""
        away = np.diff(poses, axis=0)
        far = np.linalg.norm(away[:, :2], axis=1) + TURN_REACH * np.abs(away[:, 2])
        pieces = np.ceil(far / DRIVE_STEP).astype(int) + 1
        piece = np.repeat(np.arange(len(away)), pieces)
        share = (np.arange(1, len(piece) + 1) - (np.cumsum(pieces) - pieces)[piece]) / pieces[piece]
        return self.parked.drives(poses[piece] + share[:, None] * away[piece])


def _wrap(angle: float) -> float:
    return float((angle + np.pi) % (2 * np.pi) - np.pi)
