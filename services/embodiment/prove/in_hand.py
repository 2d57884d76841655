"""Whether grasps have a handle in hand: then a proof about such holds is one about all that are searched."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from sdt_kg.iri import Iri
from services.embodiment.body.world import World
from services.embodiment.proof_check.proof.content import IN_HAND

Array = NDArray[np.float64]

MARGIN = 0.002  # [m] by which they are nearer than they had to be


def in_hand(world: World, handle: Iri, tools: Iterable[Array]) -> bool:
    """Whether each tool is near enough to a box about one of the handle's shapes, with a margin.

    Args:
        world: Robot and kitchen.
        handle: IRI of a body of the kitchen.
        tools: Origins of tools in the frame of the joint that carries the handle [m], shape (3,).
    """
    shapes = world.shapes_of((handle,))
    _, turns, middles = world.boxes
    for tool in tools:
        seen = (turns[shapes].transpose(0, 2, 1) @ (tool - middles[shapes])[:, :, None])[:, :, 0]
        away = np.linalg.norm(np.maximum(np.abs(seen) - world.half[shapes], 0.0), axis=1)
        if away.min(initial=np.inf) > IN_HAND - MARGIN:
            return False
    return True
