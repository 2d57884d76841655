"""The best posture of one arm among many: compact, not in front, on its own side, with ways out of it."""

from collections import Counter

import numpy as np
from numpy.typing import NDArray

from services.embodiment.body.limb import BASE, Limb, ends
from services.embodiment.body.world import Rules, World

Array = NDArray[np.float64]

SEEDS = 1024  # random postures
KEPT = 8  # of them, the best, and of each generation
CHILDREN = 12  # of each that is kept
GENERATIONS = 30
CHANGES = (0.05, 0.15, 0.4)  # [rad or m] standard deviations of a child, one of them for each generation
FROM_LIMITS = 0.05  # share of its range that a joint keeps from either limit
ANGLES = np.linspace(0.0, np.pi, 8, endpoint=False)  # [rad] from which the robot is looked at
LOOKED = 8  # postures of a generation that are asked for ways out: the cheapest
OUT = 16  # postures with the hand away from the robot to which ways out lead
STEPS = 12  # looks on the straight way to one

# What each costs, beside a metre of mean width.
IN_FRONT = 2.0  # a metre in front of the base
ACROSS = 1.0  # a metre on the other arm's side
HIGH = 0.3  # a metre of height
FROM_MIDDLE = 0.05  # joints at their limits
CLOSED_IN = 0.5  # no straight way out


class Postures:
    """Postures x (n,) of a limb, its base at the origin.

    Args:
        world: The robot alone on a floor.
        limb: Of the arm.
        demands: Distances that a posture keeps, and those that the ways out of it do.
        fixed: Variables that stay as they are parked, shape (n,).
        side: 1 if the arm is the left one of several, -1 if the right one, else 0.

    Attributes:
        met: How often which shapes touched.
    """

    def __init__(
        self, world: World, limb: Limb, demands: tuple[Rules, Rules], fixed: NDArray[np.bool_], side: int
    ) -> None:
        self.world, self.limb, self.demands, self.fixed, self.side = world, limb, demands, fixed, side
        low, high = ends(limb.lower, limb.upper)
        away = FROM_LIMITS * (high - low)
        self.low, self.high = low + away, high - away
        self.met = Counter[tuple[int, int]]()
        self._rows = slice(world.split, None)
        self._joint: NDArray[np.int64] = world.boxes[0][self._rows]
        self._local_r, self._local_c = world.boxes[1][self._rows], world.boxes[2][self._rows]
        standing = world.shapes_of(world.scene.standing)
        self._base = np.isin(np.arange(world.split, len(world.body)), standing)
        moved = np.flatnonzero(np.abs(limb.expansion[:, 3:][:, ~fixed[3:]]).any(axis=1)) + 1
        self._arm = np.isin(self._joint, below(world.tree[0], set(moved.tolist())))

    def best(self) -> Array | None:
        """The posture that costs least; None where none is free."""
        rng = np.random.default_rng(0)
        seeds = rng.uniform(self.low, self.high, (SEEDS, len(self.low)))
        xs = self._free(np.concatenate([np.clip(self.limb.parked, self.low, self.high)[None], seeds]))
        out = self._outside(xs)
        best, costs = np.empty((0, len(self.low))), np.empty(0)
        for _ in range(1 + GENERATIONS):
            cheap = self.costs(xs)
            few = np.argsort(cheap, kind="stable")[:LOOKED]
            ways = np.array([CLOSED_IN * (1 - self._open(x, out)) for x in xs[few]])
            best, costs = np.concatenate([best, xs[few]]), np.concatenate([costs, cheap[few] + ways])
            order = np.argsort(costs, kind="stable")[:KEPT]
            best, costs = best[order], costs[order]
            change = rng.normal(scale=rng.choice(CHANGES), size=(CHILDREN, *best.shape))
            xs = self._free(np.clip(best + change, self.low, self.high).reshape(-1, len(self.low)))
        return best[0] if len(best) else None

    def _free(self, xs: Array) -> Array:
        xs[:, self.fixed] = self.limb.parked[self.fixed]
        contacts = self.world.contact_each(self.limb.q(xs), self.demands[0])
        self.met.update(pair for pair in contacts if pair is not None)
        return xs[np.array([pair is None for pair in contacts], np.bool_)]

    def _outside(self, xs: Array) -> Array:
        """Of free postures some with the hand away from the robot."""
        away = np.array([np.linalg.norm(self.limb.tool(x)[1][:2]) for x in xs])
        return xs[away >= np.median(away)][:OUT] if len(xs) else xs

    def _open(self, x: Array, out: Array) -> float:
        """Share of the postures to which a straight way leads."""
        shares = np.linspace(0.0, 1.0, STEPS)[:, None]
        ways = (self.limb.q(x + shares * (end - x)) for end in out)
        return sum(self.world.contact(way, self.demands[1]) is None for way in ways) / max(len(out), 1)

    def costs(self, xs: Array) -> Array:
        """What postures cost but for their ways out: shape (N, n) to (N,)."""
        off = ((2 * xs - self.low - self.high) / (self.high - self.low))[:, BASE.stop :]
        return np.array([self._cost(q) for q in self.limb.q(xs)]) + FROM_MIDDLE * (off**2).mean(axis=1)

    def _cost(self, q: Array) -> float:
        r, p = self.world.frames(q)
        centre = (r[self._joint] @ self._local_c[:, :, None])[:, :, 0] + p[self._joint]
        turned = r[self._joint] @ self._local_r
        looks = np.stack([np.cos(ANGLES), np.sin(ANGLES), np.zeros_like(ANGLES)])
        reach = (self.world.half[self._rows, None] @ np.abs(turned.transpose(0, 2, 1) @ looks))[:, 0]
        width = ((centre @ looks + reach).max(axis=0) - (centre @ looks - reach).min(axis=0)).mean()
        half = (np.abs(turned) @ self.world.half[self._rows, :, None])[:, :, 0]
        ahead, top = (centre + half)[:, 0], (centre + half)[:, 2].max()
        front = max(0.0, float(ahead.max() - ahead[self._base].max(initial=0.0)))
        across = (
            (half[self._arm, 1] - self.side * centre[self._arm, 1]).max(initial=0.0) if self.side else 0.0
        )
        return float(width + IN_FRONT * front + HIGH * top + ACROSS * across)


def below(parents: NDArray[np.int64], joints: set[int]) -> list[int]:
    """The joints and all that they carry."""
    for joint, parent in enumerate(parents.tolist()):
        if joint and parent in joints:
            joints.add(joint)
    return sorted(joints)
