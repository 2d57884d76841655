"""Parts of a handle beside its bar that a hand may close on: posts, and whatever else carries it.

Certification asks for two fingers on both sides of the handle, wherever. Held by a post, with the palm's
narrow side towards the front, a handle leaves the hand other directions than its bar does: from above it,
one finger behind the bar and one beyond its end.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sdt_kg.iri import Iri
from services.embodiment.body.world import World
from services.embodiment.hold.handle import Bar

Array = NDArray[np.float64]


def parts(world: World, handle: Iri, bar: Bar) -> tuple[Bar, ...]:
    """The bar, and each other shape of the handle as a bar."""
    joints, turns, middles = world.boxes
    found = [bar]
    for k in world.shapes_of((handle,)).tolist():
        turn, middle, half = turns[k], middles[k], world.half[k]
        if joints[k] != bar.joint or (np.abs((bar.centre - middle) @ turn) <= half).all():
            continue
        _, wide, long = np.argsort(half, kind="stable").tolist()
        width, depth, length = sorted((2 * half).tolist())
        found.append(Bar(bar.joint, middle, turn[:, long], turn[:, wide], length, depth, width))
    return tuple(found)


def around(every: tuple[Bar, ...]) -> Bar:
    """The first of these bars, so long that its middle is as far from its ends as from any of the others."""
    bar = every[0]
    far = [float(np.linalg.norm(one.centre - bar.centre)) + one.length / 2 for one in every]
    return replace(bar, length=2 * max(far))
