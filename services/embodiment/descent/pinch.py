"""Where a handle lies between fingers, as a residual: anywhere along a part, turned as a grip allows.

Mostly its middle line does, well within what presses. Certification asks for less: that fingers reach 3 mm
over some of a face. So scant holds, in which they reach no farther, are looked for where others reach not
everywhere; at the edge of an arm's reach there may be no others.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.embodiment.body.limb import Limb
from services.embodiment.descent import placed
from services.embodiment.hold.fit import REACH
from services.embodiment.hold.grasp import Hand
from services.embodiment.hold.handle import Bar

Array = NDArray[np.float64]
Pose = tuple[Array, Array]
Face = tuple[Array, Array, Array, float, float]
Room = tuple[Array, Array, Array]

END = 0.004  # [m] kept from the ends of a bar
RIM = 0.005  # [m] kept from the edges of the fingers
SCANT = REACH + 0.0003  # [m] the same, where a face reaches over them just so far as it has to
INNER = 0.012  # [m] from the middle plane, within which shapes of closed fingers are what holds


@dataclass(frozen=True, slots=True, eq=False)
class Grip:
    """A face of a part of a handle that fingers close on.

    Attributes:
        bar: The part.
        normal: Of that face, in the frame of the part's joint, shape (3,).
        wide: Extent of the face across the part [m].
    """

    bar: Bar
    normal: Array
    wide: float


def grips(parts: tuple[Bar, ...]) -> list[Grip]:
    """The four faces along each part."""
    found: list[Grip] = []
    for bar in parts:
        across = np.cross(bar.outward, bar.along)
        faces = (bar.outward, bar.width), (across, bar.depth)
        found += [Grip(bar, side * way, wide) for way, wide in faces for side in (1.0, -1.0)]
    return found


class Pads:
    """The room between a hand's fingers, in its tool's frame.

    Attributes:
        room: Middle and corners of the box that closed fingers' inner shapes lie in, without its edges [m].
        scant: The same, for faces that fingers reach over no farther than they have to.
    """

    def __init__(self, hand: Hand) -> None:
        count = len(hand.fingers)
        turns, middles = (part[-count:] for part in hand.shapes_seen(1.0))
        reach = (np.abs(turns) * hand.world.half[hand.fingers][:, None, :]).sum(axis=2)
        inner = np.abs(middles[:, 1]) - reach[:, 1]
        near = inner <= max(INNER, float(inner.min()))
        low, high = (middles - reach)[near].min(axis=0), (middles + reach)[near].max(axis=0)
        self.room, self.scant = _within(low, high, RIM), _within(low, high, SCANT)


def _within(low: Array, high: Array, rim: float) -> Room:
    """Middle and corners of a box without its edges."""
    kept = np.minimum(rim, (high - low) / 2)
    return (low + high) / 2, low + kept, high - kept


def face(grip: Grip, handle: Pose, scant: bool) -> Face:
    """What `placed.pinched` takes of a grip, the joint that carries it at a pose in the world.

    Args:
        grip: Which part, and which of its faces.
        handle: Pose of that joint.
        scant: Whether all of the face counts; else the middle line of the part, without its ends.
    """
    bar, (r, p) = grip.bar, handle
    half = bar.length / 2 if scant else max(bar.length / 2 - END, 0.0)
    wide = grip.wide / 2 if scant else 0.0
    return r @ bar.along, r @ bar.centre + p, r @ grip.normal, half, wide


def led(x: Array, limb: Limb, tool: Pose) -> tuple[Array, Array]:
    """How far the tool is from a pose [m, and rad · ANGLE], shape (6,), and its derivatives (6, n)."""
    values, rows = np.empty(6), np.empty((6, len(x)))
    placed.led(*limb.tool(x), limb.tool_jacobian(x), tool, values, rows)
    return values, rows
