"""Where a robot begins that is not told where."""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Drive
from sdt_kg.twin import Container
from services.embodiment.hold.kit import Kits

Array = NDArray[np.float64]
Start = tuple[float, float, float]

RING = 0.1  # [m] between two rings of poses around the usual one, and about so much between two on a ring
FARTHEST = 3.0  # [m] of a pose from the usual one


def usual(kits: Kits, container: Container, drive: Drive) -> Start:
    """The base pose at the kitchen's start, turned to the handle.

    A robot that drives and would touch the kitchen there, parked, starts at the nearest free pose.
    """
    scene = kits.world.scene
    x, y, _ = scene.twin.kitchen().start
    handle = scene.placement(scene.q((0.0, 0.0, 0.0), {}), container.handle).translation
    return turned(x, y, handle) if drive is Drive.FIXED else near(kits, x, y, handle)


def turned(x: float, y: float, target: Array) -> Start:
    """The base pose at x, y [m] that faces a target, world position (3,)."""
    return x, y, math.atan2(target[1] - y, target[0] - x)


def near(kits: Kits, x: float, y: float, target: Array) -> Start:
    """The base pose nearest to x, y [m], facing the target, in which the parked robot touches nothing.

    Poses are tried ring after ring; the one at x, y itself is given back where none is free.
    """
    parked = kits.parked()
    for ring in _rings(x, y):
        poses = [turned(*at, target) for at in ring]
        free = np.flatnonzero(parked.stands(np.array(poses)))
        if len(free):
            return poses[free[0]]
    return turned(x, y, target)


def contact_at(kits: Kits, start: Start) -> tuple[tuple[int, int], float] | None:
    """A pair of shapes nearer than certification allows where a robot starts, parked; their distance [m]."""
    world = kits.world
    q = world.scene.q(start, {})
    contact = world.contact(q[None], kits.outside())
    return None if contact is None else (contact.shapes, world.distance(contact.shapes, *world.frames(q)))


def _rings(x: float, y: float) -> Iterator[list[tuple[float, float]]]:
    """Positions on circles about x, y, nearest first; each from where it meets the world's x axis on."""
    yield [(x, y)]
    for k in range(1, round(FARTHEST / RING) + 1):
        angles = np.linspace(0, 2 * np.pi, round(2 * np.pi * k), endpoint=False)
        yield [(x + k * RING * math.cos(one), y + k * RING * math.sin(one)) for one in angles.tolist()]
