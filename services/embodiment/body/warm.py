"""Compiled loops are loaded, or compiled on the first run after installation, before any clock runs."""

import numpy as np

from services.embodiment.body import hands, ik
from services.embodiment.body.limb import Limb, Margins, rules
from services.embodiment.body.parked import Parked
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
    world.distances(demands.pairs[:1], r, p)
    one = np.zeros(1, np.int64)
    pose = r[:1].copy(), p[:1].copy()
    hands.touching(
        one + world.split,
        pose,
        (one, *pose),
        world.split,
        world.radius,
        world.shapes,
        demands.environment,
    )
    hands.touching_many(
        one + world.split,
        pose,
        pose,
        (one, *pose),
        world.split,
        world.radius,
        world.shapes,
        demands.environment,
        np.empty((1, 2), np.int64),
    )
    tool = limb.tool(x)
    scene = world.tree, world.boxes, world.shapes, one, one, tool, tool
    hands.gaps(limb.q(x), *scene, np.empty(1))
    hands.closing(limb.q(x), limb.q(x), *scene, np.ones((2, 1), np.bool_), 0.0, 0)
    Parked(world, limb.q(x), demands).drives(np.zeros((1, 3)))
