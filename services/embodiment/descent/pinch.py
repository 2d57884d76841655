"""Where a handle lies between fingers, as a residual: anywhere along a part, turned as a grip allows."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.embodiment.body.limb import Limb
from services.embodiment.hold.grasp import Hand
from services.embodiment.hold.handle import Bar

Array = NDArray[np.float64]
Pose = tuple[Array, Array]

ANGLE = 0.1  # [m] what one radian counts as
TURNED = float(np.radians(24))  # [rad] between a face and the way in which fingers close, at most
END = 0.004  # [m] kept from the ends of a bar
RIM = 0.005  # [m] kept from the edges of the fingers
INNER = 0.012  # [m] from the middle plane, within which shapes of closed fingers are what holds


@dataclass(frozen=True, slots=True, eq=False)
class Grip:
    """A face of a part of a handle that fingers close on.

    Attributes:
        bar: The part.
        normal: Of that face, in the frame of the part's joint, shape (3,).
    """

    bar: Bar
    normal: Array


def grips(parts: tuple[Bar, ...]) -> list[Grip]:
    """The four faces along each part."""
    found: list[Grip] = []
    for bar in parts:
        across = np.cross(bar.outward, bar.along)
        found += [Grip(bar, side * way) for way in (bar.outward, across) for side in (1.0, -1.0)]
    return found


class Pads:
    """The room between a hand's fingers, in its tool's frame.

    Attributes:
        low, high: Corners of the box that closed fingers' inner shapes lie in, without its edges [m].
    """

    def __init__(self, hand: Hand) -> None:
        count = len(hand.fingers)
        turns, middles = (part[-count:] for part in hand.shapes_seen(1.0))
        reach = (np.abs(turns) * hand.world.half[hand.fingers][:, None, :]).sum(axis=2)
        inner = np.abs(middles[:, 1]) - reach[:, 1]
        near = inner <= max(INNER, float(inner.min()))
        low, high = (middles - reach)[near].min(axis=0), (middles + reach)[near].max(axis=0)
        self.middle = (low + high) / 2
        kept = np.minimum(RIM, (high - low) / 2)
        self.low, self.high = low + kept, high - kept


def pinched(x: Array, limb: Limb, pads: Pads, grip: Grip, handle: Pose) -> tuple[Array, Array]:
    """How far the part's line is from the middle of the fingers [m], and its face from how they close.

    Args:
        x: Of the limb, shape (n,).
        limb: Whose tool it is.
        pads: Of its hand.
        grip: What is held.
        handle: World pose of the joint that carries it.

    Returns:
        The residual, shape (0 … 4,), and its derivatives (…, n).
    """
    (r, p), rates = limb.tool(x), limb.tool_jacobian(x)
    bar, half = grip.bar, max(grip.bar.length / 2 - END, 0.0)
    along, centre = handle[0] @ bar.along, handle[0] @ bar.centre + handle[1]
    beside = r @ pads.middle
    there = float((p + beside - centre) @ along)
    off = centre + np.clip(there, -half, half) * along - p
    seen = r.T @ off
    aim = np.array([np.clip(seen[k], pads.low[k], pads.high[k]) if k != 1 else 0.0 for k in range(3)])
    away = seen - aim
    moved = _lever(off) @ rates[3:] - rates[:3]
    if abs(there) < half:  # the place on the part goes with the fingers
        moved += np.outer(along, along @ (rates[:3] - _lever(beside) @ rates[3:]))
    rows = r.T @ moved
    chosen = away != 0
    turned = _turned(r, handle[0] @ grip.normal, rates)
    if turned is None:
        return away[chosen], rows[chosen]
    return np.append(away[chosen], turned[0]), np.vstack((rows[chosen], turned[1]))


def _lever(arm: Array) -> Array:
    """The matrix of the product with an arm (3,) from the left, shape (3, 3)."""
    x, y, z = arm
    return np.array([(0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)])


def _turned(r: Array, normal: Array, rates: Array) -> tuple[float, Array] | None:
    """By how much a face is turned too far from how fingers close [m], and its derivatives (n,)."""
    close = r[:, 1]
    angle = float(np.arccos(np.clip(close @ normal, -1, 1)))
    if angle <= TURNED:
        return None
    axis = np.cross(normal, close)
    size = float(np.linalg.norm(axis))
    axis = axis / size if size > 1e-9 else r[:, 0]
    return ANGLE * (angle - TURNED), ANGLE * (axis @ rates[3:])


def led(x: Array, limb: Limb, tool: Pose) -> tuple[Array, Array]:
    """How far the tool is from a pose [m, and rad · ANGLE], shape (6,), and its derivatives (6, n)."""
    (r, p), rates = limb.tool(x), limb.tool_jacobian(x)
    turn = r @ tool[0].T
    axis = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / 2
    return np.concatenate([p - tool[1], ANGLE * axis]), np.concatenate([rates[:3], ANGLE * rates[3:]])
