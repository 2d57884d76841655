"""Compiled loops are loaded, or compiled on the first run after installation, before any clock runs."""

import numpy as np

from services.embodiment.body import ik, kernels
from services.embodiment.body.limb import Limb, Margins, rules
from services.embodiment.body.world import World


def warm(world: World, limb: Limb) -> None:
    """Every compiled function has run once, with the types in which it is used."""
    n = len(limb.lower)
    x, weight = np.zeros(n), np.ones(n)
    demands = rules(world, limb, Margins())
    world.contact(limb.q(x)[None], demands)
    rotation, translation = limb.tool(x)
    limb.tool_jacobian(x)
    target_r, target_p = rotation[None].copy(), translation[None].copy()
    bounds = weight, limb.lower, limb.upper
    ik.solve_many(x[None].copy(), target_r, target_p, limb.chain, *bounds, 1, 1.0)
    ik.follow(x, target_r, target_p, limb.chain, *bounds, 1, 1.0, 1.0, np.empty((1, n)))
    r, p = world.frames(limb.q(x))
    count = len(world.body)
    box_r, box_c = np.empty((count, 3, 3)), np.empty((count, 3))
    kernels.place_boxes(r, p, world.boxes, box_r, box_c)
    room = np.empty((256, 2), np.int64)
    kernels.check_environment(
        world.split, (box_r, box_c), world.half, world.radius, world.kind, demands.environment, room
    )
