"""A bar of a handle, as a claim tells it: that it is the handle's, and how it lies, is looked at anew."""

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import InputError
from services.embodiment.proof_check.geometry.interval import exact
from services.embodiment.proof_check.geometry.mechanics import HERE, Chain, Placement
from services.embodiment.proof_check.proof.claim import Bar
from services.embodiment.proof_check.statement import Statement

Array = NDArray[np.float64]

NEARLY = 1e-9  # [1] unit vectors at right angles are off by no more
BESIDE = 0.002  # [m] out of a box about the handle a bar's middle line may be, and it may be so much shorter
FINGER = 0.015  # [m] half a finger's width: so far from its ends the bar is not grasped
OPENS = 0.7  # [1] cosine between away from the front and the way in which the handle opens, at least
STEP = 1e-4  # [rad or m] of the container, that tells which way that is


def bar_of(statement: Statement, bar: Bar) -> Placement:
    """The bar's middle and its directions outward, along and across, in the frame of the handle's joint.

    Raises:
        InputError: They are no unit vectors at right angles, or the handle has no such bar: one inside a box
            about it, along which it is longest, from end to end but for half a finger, and that it moves away
            from the front with as it opens.
    """
    outward, along = np.array(bar.outward), np.array(bar.along)
    turn = np.stack((outward, along, np.cross(outward, along)), axis=1)
    if not np.abs(turn.T @ turn - np.eye(3)).max() <= NEARLY or not bar.reach >= 0.0:
        raise InputError("a bar without directions", allowed="unit vectors along it and away from the front")
    at = statement.twin.state[statement.container.joint]
    chain, _, _ = statement.before_handle(at)
    placed = [(chain.end @ middle, half) for middle, half in statement.handle_boxes()]
    boxes = [(one.translation.middle, one.rotation.middle, half) for one, half in placed]
    _is_within(bar, boxes)
    _is_whole(bar, turn, boxes)
    opens = _way(statement, at, np.array(bar.centre))
    across = opens - along * (along @ opens)
    if not outward @ across >= OPENS * np.linalg.norm(across):
        raise InputError("a bar before whose front the hand would not be", allowed="the way it opens")
    return Placement(exact(turn), exact(bar.centre))


def _is_within(bar: Bar, boxes: list[tuple[Array, Array, Array]]) -> None:
    """The bar's middle line is in a box about a shape of the handle.

    Raises:
        InputError: It is not.
    """
    ends = np.array(bar.centre) + bar.reach * np.outer((-1.0, 1.0), bar.along)
    if not any((np.abs((ends - at) @ turn) <= half + BESIDE).all() for at, turn, half in boxes):
        raise InputError(
            "grasps of a bar that is not the handle's", allowed="one inside a box about its shapes"
        )


def _is_whole(bar: Bar, turn: Array, boxes: list[tuple[Array, Array, Array]]) -> None:
    """The handle goes no farther along the bar than that, but for half a finger, and less far across.

    Raises:
        InputError: It does.
    """
    seen = np.array([at for at, _, _ in boxes]) @ turn - np.array(bar.centre) @ turn
    reach = np.array([np.abs(turn.T @ axes) @ half for _, axes, half in boxes])
    low, high = (seen - reach).min(axis=0), (seen + reach).max(axis=0)
    if max(-low[1], high[1]) > bar.reach + FINGER + BESIDE:
        raise InputError(
            f"a bar that is grasped {bar.reach:.4f} m from its middle at most",
            allowed=f"all of it but half a finger: {max(-low[1], high[1]) - FINGER:.4f} m",
        )
    if high[2] - low[2] > high[1] - low[1] + BESIDE:
        raise InputError("a bar across the handle", allowed="one along which it is longest")


def _way(statement: Statement, value: float, point: Array) -> Array:
    """How a point moves as the container opens, both in the frame of the handle's joint, shape (3,)."""
    container = statement.container

    def joint(at: float) -> tuple[Array, Array]:
        chain, q, _ = statement.before_handle(at)
        _, _, placed = Chain(chain.links, HERE).frames(q)
        return placed.rotation.middle[0], placed.translation.middle[0]

    turn, before = joint(max(value - STEP, container.lower))
    other, after = joint(min(value + STEP, container.upper))
    return turn.T @ (other @ point + after - turn @ point - before)
