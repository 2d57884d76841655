"""Compiled loops are loaded, or compiled on the first run after installation, before any clock runs."""

import numpy as np

from services.embodiment.body import ik
from services.embodiment.body.demands import Margins, rules
from services.embodiment.body.hand import fingers, placing
from services.embodiment.body.limb import Limb
from services.embodiment.body.parked import Parked
from services.embodiment.body.world import Rules, World


def warm(world: World, limb: Limb) -> None:
    """Every compiled function has run once, with the types in which it is used."""
    n = len(limb.lower)
    x, weight = np.zeros(n), np.ones(n)
    demands = rules(world, limb, Margins())
    world.contact(limb.q(x)[None], demands)
    world.contact_each(limb.q(x)[None], demands)
    rotation, translation = limb.tool(x)
    limb.tool_jacobian(x)
    target_r, target_p = rotation[None].copy(), translation[None].copy()
    bounds = weight, limb.lower, limb.upper
    ik.solve_many(x[None].copy(), target_r, target_p, limb.chain, *bounds, 1, 1.0)
    ik.misses(x[None], target_r, target_p, limb.chain)
    ik.follow(x, target_r, target_p, limb.chain, *bounds, 1, 1.0, 1.0, np.empty((1, n)))
    r, p = world.frames(limb.q(x))
    world.poses(limb.q(x)[None], 1)
    world.distances(demands.pairs[:1], r, p)
    _warm_hands(world, limb, demands)
    Parked(world, limb.q(x), demands).drives(np.zeros((1, 3)))


def _warm_hands(world: World, limb: Limb, demands: Rules) -> None:
    x, one = np.zeros(len(limb.lower)), np.zeros(1, np.int64)
    at, tool, frames = (np.eye(3)[None], np.zeros((1, 3))), limb.tool(x), world.frames(limb.q(x))
    hand = one + world.split, 0, one + 1, world.tree, world.boxes, tool, frames
    rest, margins, kitchen = (world.split, world.radius, world.shapes), demands.environment, (one, *at)
    closing, shares = (limb.q(x), limb.q(x)[None]), np.zeros(1)
    room = placing.room(1, world.scene.model.nq)
    placing.posed(limb.q(x), hand, at)
    placing.touching_many(hand[0], at, at, kitchen, *rest, margins, np.empty((1, 2), np.int64))
    sides = np.ones((1, 2, 1), np.bool_)
    begin = np.zeros((1, 2)), np.zeros((1, 2), np.int64)
    fingers.closed(tool, shares, sides, hand, closing, kitchen, world.shapes, 0.0, 0, room, *begin)
    placing.stays(tool, shares, hand, closing, (*kitchen, one), rest, margins, room)
    placing.swings(tool, shares, shares, 1, hand, closing, kitchen, rest, (margins, margins), room)
