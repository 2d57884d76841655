"""From where a scene is looked at: the same for a page and for paper."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ANGLE = math.radians(32.0)
"""[rad] Height of the field of view."""

PITCH = math.radians(30.0)
"""[rad] How steeply the camera looks down."""

ASIDE = math.radians(60.0)
"""[rad] From how far aside a robot is looked at."""

PERSON, ARM = 1.5, 0.5
"""[m] Height and half width of what is shown of a robot at the least."""

ASPECT = 2.0
"""[1] Width of a picture by its height; a narrower page steps back."""

FILLED = 0.85
"""[1] How much of the picture's half height what matters may take."""

LONG = 1.6
"""[1] A room whose sides are longer than this by each other is looked at across."""

NEAREST, FARTHEST, HALVINGS = 0.3, 60.0, 24
"""[m] Between which the distance is halved, and how often."""


@dataclass(frozen=True, slots=True)
class Camera:
    """A pinhole camera that is level.

    Attributes:
        target: What it looks at [m].
        yaw: Direction from the target to the camera, about z [rad].
        pitch: The same, above the horizon [rad].
        distance: From the target [m].
        reach: What is nearer to the camera than the target by more than this is cut away, so that one
            sees into rooms [m].
        angle: Height of the field of view [rad].
    """

    target: tuple[float, float, float]
    yaw: float
    pitch: float
    distance: float
    reach: float
    angle: float = ANGLE

    def seen(self, points: Array) -> Array:
        """Points, shape (…, 3), by what is right, up and away from the camera [m]."""
        cy, sy, cp, sp = math.cos(self.yaw), math.sin(self.yaw), math.cos(self.pitch), math.sin(self.pitch)
        back, right = np.array([cp * cy, cp * sy, sp]), np.array([-sy, cy, 0.0])
        return (points - np.array(self.target) - self.distance * back) @ np.array(
            (right, np.cross(back, right), -back)
        ).T

    def screen(self, points: Array) -> Array:
        """Right, up (both 1 at half the height of the picture) and depth [m] of points, shape (…, 3)."""
        seen = self.seen(points)
        seen[..., :2] /= (np.maximum(seen[..., 2], 1e-6) * math.tan(self.angle / 2))[..., None]
        return seen


def overview(points: Array, start: tuple[float, float]) -> Camera:
    """All that matters of a kitchen, seen from the side of the room on which robots start.

    Args:
        points: Shape (K, 3): handles, for example [m].
        start: x, y of the place from which robots start [m].
    """
    here = np.vstack((points, [(*start, 0.0), (*start, PERSON)]))
    sides, centre = np.ptp(here, axis=0), (here.min(axis=0) + here.max(axis=0)) / 2
    toward = np.array(start) - centre[:2]
    if max(sides[:2]) > LONG * min(sides[:2]):  # across a long room, not along it
        toward[int(np.argmax(sides[:2]))] = 0.0
    return framed(here, math.atan2(toward[1], toward[0]))


def beside(tool: Array, base: Array, start: tuple[float, float]) -> Camera:
    """A robot at work, seen obliquely past it, from the side that is nearer to where it came from.

    Args:
        tool: Where its tool is meanwhile, shape (K, 3) [m].
        base: x, y of its base at the end, shape (2,) [m].
        start: x, y of the place from which it started [m].
    """
    corners = [
        (*(base + ARM * np.array([dx, dy])), z) for dx in (-1, 1) for dy in (-1, 1) for z in (0.0, PERSON)
    ]
    here = np.vstack((tool, corners))
    middle = here.mean(axis=0)[:2]
    behind = math.atan2(base[1] - tool[-1, 1], base[0] - tool[-1, 0])
    away = [middle + np.array([math.cos(yaw), math.sin(yaw)]) for yaw in (behind - ASIDE, behind + ASIDE)]
    near = int(np.argmin([np.linalg.norm(each - np.array(start)) for each in away]))
    return framed(here, behind + (-ASIDE, ASIDE)[near])


def framed(points: Array, yaw: float) -> Camera:
    """Points, shape (K, 3) [m], as large as they fit into the picture, from a direction."""
    x, y, z = (float(each) for each in (points.min(axis=0) + points.max(axis=0)) / 2)
    low, high = NEAREST, FARTHEST
    for _ in range(HALVINGS):
        distance = (low + high) / 2
        right, up, depth = Camera((x, y, z), yaw, PITCH, distance, 0.0).screen(points).T
        fits = depth.min() > NEAREST and max(abs(right).max() / ASPECT, abs(up).max()) < FILLED
        low, high = (low, distance) if fits else (distance, high)
    depth = Camera((x, y, z), yaw, PITCH, high, 0.0).screen(points)[:, 2]
    return Camera((x, y, z), yaw, PITCH, high, high - float(depth.min()) + NEAREST)
