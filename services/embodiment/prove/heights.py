"""Whether a handle is too high or too low for any hand: cheap, and only a reason to look for a proof first.

Heights along a chain are intervals. As long as only prismatic joints and upright hinges were passed,
the frame is known but for a turn about the vertical, and heights add up exactly; behind any other
hinge a link may point anywhere, so it adds its whole length up and down.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from services.embodiment.body.limb import Limb
from services.embodiment.body.world import World
from services.embodiment.hold.handle import Mechanics

Array = NDArray[np.float64]

SLACK = 0.005  # [m] beyond what certification tolerates: contact 2 mm, overhang, rounding
UPRIGHT = 1e-9  # [1] deviation of a hinge's axis from the vertical that counts as none
KEPT = 16  # limbs whose span is kept: two of each of the scenes that a worker keeps
CHECKED = 9  # values of the container at which heights are compared


@dataclass(slots=True)
class Heights:
    """Where a frame of the chain can be.

    Attributes:
        low, high: Of its origin [m].
        frame: Its rotation but for a turn about the vertical, shape (3, 3); None if it may be any.
    """

    low: float = 0.0
    high: float = 0.0
    frame: Array | None = None

    def along(self, offset: Array) -> None:
        """The origin goes on by an offset in the frame [m], shape (3,)."""
        if self.frame is None:
            length = float(np.linalg.norm(offset))
            self.low, self.high = self.low - length, self.high + length
        else:
            up = float(self.frame[2] @ offset)
            self.low, self.high = self.low + up, self.high + up

    def slide(self, axis: Array, lower: float, upper: float) -> None:
        """A prismatic joint anywhere between its limits."""
        if self.frame is None:
            length = max(abs(lower), abs(upper)) * float(np.linalg.norm(axis))
            self.low, self.high = self.low - length, self.high + length
        else:
            up = float(self.frame[2] @ axis)
            self.low += min(lower * up, upper * up)
            self.high += max(lower * up, upper * up)

    def turn(self, axis: Array) -> None:
        """A hinge at any angle."""
        if self.frame is not None and abs(abs(self.frame[2] @ axis) - 1) > UPRIGHT:
            self.frame = None


def heights(world: World, joint: int) -> Heights:
    """Where the origin of a model joint's frame can be, for all base poses and joint positions."""
    parents, place_r, place_p, axes, kinds = world.tree
    scene, chain = world.scene, []
    while joint > 0:
        chain.append(joint)
        joint = int(parents[joint])
    at = Heights(frame=np.eye(3))
    for j in reversed(chain):
        at.along(place_p[j])
        at.frame = None if at.frame is None else at.frame @ place_r[j]
        if kinds[j]:
            at.turn(axes[j])
        elif j - 1 not in scene.base:
            source = int(scene.coupling.source[j - 1])
            ends = np.array([scene.bounds.lower[source], scene.bounds.upper[source]])
            ends = ends * scene.coupling.multiplier[j - 1] + scene.coupling.offset[j - 1]
            at.slide(axes[j], float(ends.min()), float(ends.max()))
    return at


@lru_cache(maxsize=KEPT)
def span(world: World, limb: Limb) -> tuple[float, float]:
    """Heights that no point of the limb's fingers can go below and above [m]; kept for other containers."""
    lows, highs = [], []
    for shape in world.shapes_of(limb.fingers):
        at = heights(world, int(world.boxes[0][shape]))
        at.along(world.boxes[2][shape])
        radius = float(np.linalg.norm(world.half[shape]))
        lows.append(at.low - radius)
        highs.append(at.high + radius)
    return min(lows), max(highs)


def handle_span(world: World, mechanics: Mechanics, q: Array) -> tuple[float, float]:
    """Heights of a box around the handle at scene configuration q [m]."""
    r, p = world.frames(q)
    joint, local_r, centre = world.boxes
    lows, highs = [], []
    for shape in world.shapes_of((mechanics.container.handle,)):
        j = joint[shape]
        height = float(r[j, 2] @ centre[shape] + p[j, 2])
        reach = float(np.abs(r[j, 2] @ local_r[shape]) @ world.half[shape])
        lows.append(height - reach)
        highs.append(height + reach)
    return min(lows), max(highs)


def out_of_reach(world: World, mechanics: Mechanics, limbs: list[Limb], values: Array) -> bool:
    """Whether no finger of any gripper comes as high, or as low, as the handle somewhere on its way."""
    handle = mechanics.container.handle
    if not limbs or not len(world.shapes_of((handle,))):
        return False
    spans = [span(world, limb) for limb in limbs]
    lowest, highest = min(low for low, _ in spans), max(high for _, high in spans)
    somewhere = world.scene.q((0.0, 0.0, 0.0), {})
    for q in mechanics.put(somewhere, np.linspace(values[0], values[-1], CHECKED)):
        low, high = handle_span(world, mechanics, q)
        if max(low - highest, lowest - high) > SLACK + world.scene.annotation.overhang:
            return True
    return False
