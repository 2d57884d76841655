"""The whole body follows tool poses, the base as its drive allows."""

from enum import Enum
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Drive
from services.embodiment.body import ik
from services.embodiment.body.limb import BASE, Limb
from services.embodiment.body.rolling import rolled

Array = NDArray[np.float64]

JUMP = 0.35  # [rad or m] largest change of a variable between two tool poses
STEPS = 40  # of the solver, from one tool pose to the next
EXACT = 1e-7  # [m, and rad · ik.ARM] tool error of a solution
FASTEST = 2.0  # [rad/s or m/s] speeds above this make a variable no more willing


class Base(Enum):
    """What the base does while the tool follows."""

    STANDS = "the base stands"
    STRAIGHT = "the base drives straight on or back"
    ROLLS = "the base drives and turns"
    FREE = "the base moves freely"


def bases(drive: Drive, turning: bool) -> tuple[Base, ...]:
    """What a base may do while the tool follows, simplest first.

    A differential drive turns only where the tool's way is `turning` about the vertical: on other
    ways telescope and heading, or the arm alone, go wherever a turn would lead.
    """
    return {
        Drive.OMNI: (Base.STANDS, Base.FREE),
        Drive.DIFFERENTIAL: (Base.STANDS, Base.STRAIGHT, *((Base.ROLLS,) if turning else ())),
        Drive.FIXED: (Base.STANDS,),
    }[drive]


def mobility(limb: Limb) -> Array:
    """How willingly each variable moves: its speed against that of the fastest arm joint, shape (n,).

    Where the arm has none that moves, against that of the base.
    """
    return _mobility(limb).copy()


@lru_cache(maxsize=16)
def _mobility(limb: Limb) -> Array:
    speed = np.minimum(limb.velocity, FASTEST)
    return np.sqrt(speed / (speed[3:].max(initial=0.0) or speed.max()))


def track(
    limb: Limb, x: Array, target: tuple[Array, Array], base: Base, limits: tuple[Array, Array]
) -> Array | None:
    """Variables at each of the tool poses (K, 3, 3), (K, 3), from x near the first, shape (K, n).

    None where the tool cannot be kept on them.
    """
    path = tracked(limb, x, target, base, limits)
    return path if len(path) == len(target[0]) else None


def tracked(
    limb: Limb, x: Array, target: tuple[Array, Array], base: Base, limits: tuple[Array, Array]
) -> Array:
    """The same, up to the last of the tool poses at which the tool can be kept on them."""
    weight = mobility(limb)
    if base is Base.ROLLS:
        return rolled(limb, x, target, weight, limits)
    chain, start = limb.chain, x
    if base is Base.STANDS:
        weight[BASE] = 0.0
    elif base is Base.STRAIGHT:
        chain, start = _along_heading(limb, x)
        weight[1:3] = 0.0
    path = np.empty((len(target[0]), len(x)))
    rotation, translation = np.ascontiguousarray(target[0]), np.ascontiguousarray(target[1])
    done = ik.follow(start, rotation, translation, chain, weight, *limits, STEPS, EXACT, JUMP, path)
    path = path[:done]
    if base is Base.STRAIGHT:
        way = path[:, 0].copy()
        path[:, 0], path[:, 1] = x[0] + np.cos(x[2]) * way, x[1] + np.sin(x[2]) * way
        path[:, 2] = x[2]
    return path


def _along_heading(limb: Limb, x: Array) -> tuple[tuple, Array]:
    """The chain as seen from the base's pose at x, where the first variable is the way along its heading."""
    place_r, place_p, *rest = limb.chain
    c, s = np.cos(x[2]), np.sin(x[2])
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    place_r, place_p = place_r.copy(), place_p.copy()
    place_r[0] = turn @ place_r[0]
    place_p[0] += [x[0], x[1], 0.0]
    start = x.copy()
    start[BASE] = 0.0
    return (place_r, place_p, *rest), start
