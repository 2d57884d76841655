"""How an arm is carried where a robot with its arm parked is too wide to drive."""

import numpy as np
from numpy.typing import NDArray

from services.embodiment.body.limb import BASE, Limb, ends
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
    low, high = ends(limb.lower, limb.upper)
    xs = rng.uniform(low, high, (SEEDS, len(low)))
    for _ in range(1 + GENERATIONS):
        xs[:, BASE] = 0.0
        widths = _widths(world, limb, xs)
        slimmer = (k for k in np.argsort(widths, kind="stable").tolist() if widths[k] < least)
        free = next((k for k in slimmer if world.free(limb.q(xs[k : k + 1])[0], alone)), None)
        if free is not None:
            best, least = xs[free], float(widths[free])
        change = rng.normal(scale=rng.choice(CHANGES), size=(CHILDREN, len(best)))
        xs = np.clip(best + change, low, high)
    return best


def _alone(world: World, rules: Rules) -> Rules:
    """The same distances, but of the kitchen only the floor's."""
    environment = np.full_like(rules.environment, MAY_TOUCH)
    environment[:, world.scene.floor] = rules.environment[:, world.scene.floor]
    return Rules(environment, rules.pairs, rules.own)


def _widths(world: World, limb: Limb, xs: Array) -> Array:
    """Mean width of the robot's outline, seen from above, at each of xs (N, n), the base at 0 [m]."""
    moves = _moving(world, limb)
    low, high = _outline(world, limb.q(xs), np.flatnonzero(moves))
    still_low, still_high = _outline(world, limb.q(xs[:1]), np.flatnonzero(~moves))
    return (np.maximum(high, still_high) - np.minimum(low, still_low)).mean(axis=1)


def _moving(world: World, limb: Limb) -> NDArray[np.bool_]:
    """Which shapes of the robot the arm's variables move."""
    joints = np.flatnonzero(limb.expansion[:, 3:].any(axis=1)) + 1
    return np.any(world.carried(joints)[world.split :], axis=1)


def _outline(world: World, qs: Array, shapes: NDArray[np.intp]) -> tuple[Array, Array]:
    """How far some of the robot's shapes reach to either side, seen from each angle, (K, angles) each [m]."""
    (joint, local_r, local_c), shapes = world.boxes, shapes + world.split
    across = np.stack([np.cos(ANGLES), np.sin(ANGLES), np.zeros_like(ANGLES)])
    frames = [world.frames(q) for q in qs]
    r, p = (np.stack(part)[:, joint[shapes]] for part in zip(*frames, strict=True))
    middle = ((r @ local_c[shapes, :, None])[..., 0] + p) @ across
    turned = (r @ local_r[shapes]).transpose(0, 1, 3, 2) @ across
    reach = (world.half[shapes, None] @ np.abs(turned))[:, :, 0]
    return (
        (middle - reach).min(axis=1, initial=np.inf),
        (middle + reach).max(axis=1, initial=-np.inf),
    )
