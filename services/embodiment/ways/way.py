"""The way to a holding, or why there is none."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.embodiment.body.limb import BASE
from services.embodiment.body.world import Contact

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Approach:
    """All before the grasp, in the order in which it is done.

    Attributes:
        drive: x from parked at the start, at the corners of the drive, shape (D, n).
        raise_arm: x at the corners of the arm's way from how it is carried, shape (A, n).
        drive_in: x before and after the base comes near, shape (2, n).
        reach: x at waypoints of the last centimetres, shape (R, n).
    """

    drive: Array
    raise_arm: Array
    drive_in: Array
    reach: Array


@dataclass(frozen=True, slots=True)
class Blocked:
    """Why a holding could not be approached.

    Attributes:
        stage: leave, park, fold or drive.
    """

    stage: str
    contact: Contact | None = None


def joined(road: Array, arm: tuple[Array, Array], left: Array, carried: Array) -> Approach:
    """The whole way; `left` leads from the grasp back to where the base comes near."""
    (tucked, corners), drive = arm, np.repeat(carried[None], len(road), axis=0)
    drive[:, BASE] = road
    whole = [corners.copy(), np.stack([corners[-1], left[-1]]), left[::-1].copy()]
    for part in whole:
        part[:, 2] += road[-1, 2] - corners[-1, 2]
    return Approach(np.concatenate([tucked, drive]), *whole)
