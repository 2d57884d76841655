"""How an arm is carried where a robot with its arm parked is too wide to drive."""

import numpy as np
from numpy.typing import NDArray

from services.embodiment.body.limb import BASE, Limb
from services.embodiment.body.world import MAY_TOUCH, Rules, World

Array = NDArray[np.float64]

SEEDS = 384  # random postures
GENERATIONS = 24  # by which the slimmest is changed
CHILDREN = 24  # of it in each
CHANGES = (0.05, 0.15, 0.4)  # [rad or m] standard deviations of a child, one of them for each generation
ANGLES = np.linspace(0.0, np.pi, 8, endpoint=False)  # [rad] from which the robot is looked at


def slim(world: World, limb: Limb, rules: Rules) -> Array:
    """The slimmest posture found, as x (n,) with the base at 0, that touches neither robot nor floor.

    Slim is what is narrow, seen from all around: the mean width of a convex outline is its girth over π
    (Cauchy). It is drawn from one seed of its own: no answer depends on what was asked before.
    """
    rng, alone = np.random.default_rng(0), _alone(world, rules)
    best, least = limb.parked, float(_widths(world, limb, limb.parked[None])[0])
    low = np.where(np.isfinite(limb.lower), limb.lower, -np.pi)
    high = np.where(np.isfinite(limb.upper), limb.upper, np.pi)
    xs = rng.uniform(low, high, (SEEDS, len(low)))
    for _ in range(1 + GENERATIONS):
        xs[:, BASE] = 0.0
        free = [pair is None for pair in world.contact_each(limb.q(xs), alone)]
        xs = xs[np.array(free, np.bool_)]
        widths = _widths(world, limb, xs)
        if len(xs) and widths.min() < least:
            best, least = xs[widths.argmin()], float(widths.min())
        change = rng.normal(scale=rng.choice(CHANGES), size=(CHILDREN, len(best)))
        xs = np.clip(best + change, low, high)
    return best


def _alone(world: World, rules: Rules) -> Rules:
    """The same distances, but of the kitchen only the floor's."""
    environment = np.full_like(rules.environment, MAY_TOUCH)
    environment[:, world.scene.floor] = rules.environment[:, world.scene.floor]
    return Rules(environment, rules.pairs, rules.own)


def _widths(world: World, limb: Limb, xs: Array) -> Array:
    """Mean width of the robot's outline, seen from above, at each of xs (N, n) [m]."""
    joint, local_r, local_c = world.boxes
    joint, local_r, local_c = joint[world.split :], local_r[world.split :], local_c[world.split :]
    across = np.stack([np.cos(ANGLES), np.sin(ANGLES), np.zeros_like(ANGLES)])
    out = np.empty(len(xs))
    for k, q in enumerate(limb.q(xs)):
        r, p = world.frames(q)
        middle = ((r[joint] @ local_c[:, :, None])[:, :, 0] + p[joint]) @ across
        turned = (r[joint] @ local_r).transpose(0, 2, 1) @ across
        reach = (world.half[world.split :, None] @ np.abs(turned))[:, 0]
        out[k] = ((middle + reach).max(axis=0) - (middle - reach).min(axis=0)).mean()
    return out
