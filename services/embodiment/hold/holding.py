"""Holdings: robot paths which keep a grasped handle in hand while the container moves.

A holding is searched at one value of the container (the pivot) from many seeds with the base free,
then led along the whole motion: with the arm still where the base alone can follow (a drawer, an
upright hinge, an omnidirectional drive), else by the whole body.
"""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Drive
from services.embodiment.body import ik
from services.embodiment.body.limb import BASE, Limb
from services.embodiment.body.rolling import telescope
from services.embodiment.body.track import EXACT, Base, bases, mobility, tracked
from services.embodiment.body.world import Contact, Rules, World
from services.embodiment.hold.grasp import Grasp
from services.embodiment.hold.handle import Bar, Mechanics

Array = NDArray[np.float64]

WAYPOINTS = 61  # values of the container at which a path is solved and checked
SEEDS = 48  # in one batch
STEPS = 24  # of the solver, for one seed: of those that meet in 60, 99.9 % have met
TOGETHER = 8  # seeds that are looked at together: most batches end with the first of them
NEAR, FAR = 0.3, 1.1  # [m] from base to handle, horizontally, of seeds
INSIDE = 0.004  # [rad or m] kept from joint limits, for the spline through the waypoints
LEVEL = 1e-6  # [1, m] how far from planar a handle's motion may be for the base alone to follow it


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """One grasped handle's motion.

    Attributes:
        values: Of the container's joint at the waypoints, shape (K,).
        handle_r, handle_p: World poses of the handle's joint frame there.
        outward: World direction away from the front at the first waypoint.
    """

    mechanics: Mechanics
    values: Array
    handle_r: Array
    handle_p: Array
    outward: Array

    @staticmethod
    def through(mechanics: Mechanics, bar: Bar, q: Array, values: Array) -> "Problem":
        """The handle at these values of the container, all else of the scene as at q."""
        handle_r, handle_p = mechanics.handle_poses(q, bar.joint, values)
        return Problem(mechanics, values, handle_r, handle_p, handle_r[0] @ bar.outward)

    def planar(self) -> bool:
        """Whether the handle moves in a horizontal plane and turns about the vertical only."""
        turn = self.handle_r @ self.handle_r[0].T
        return bool(np.abs(turn[:, 2, 2] - 1).max() < LEVEL and np.ptp(self.handle_p[:, 2]) < LEVEL)

    def turning(self) -> bool:
        """Whether the handle moves in a horizontal plane along an arc."""
        return self.planar() and float(np.abs(self.handle_r[-1] - self.handle_r[0]).max()) > LEVEL

    def along(self, index: int) -> float:
        """World direction of the handle's level motion at a waypoint [rad]."""
        ends = max(index - 1, 0), min(index + 1, len(self.values) - 1)
        way = self.handle_p[ends[1]] - self.handle_p[ends[0]]
        return float(np.arctan2(way[1], way[0]))

    def carried(self, x: Array, pivot: int) -> Array:
        """The x (n,) at the pivot as the base alone carries it along, shape (K, n)."""
        turn = self.handle_r @ self.handle_r[pivot].T
        xs = np.repeat(x[None], len(self.values), axis=0)
        base = np.array([x[0], x[1], 0.0]) - self.handle_p[pivot]
        xs[:, :2] = (turn @ base + self.handle_p)[:, :2]
        yaw = np.unwrap(np.arctan2(turn[:, 1, 0], turn[:, 0, 0]))
        xs[:, 2] = x[2] + yaw - yaw[pivot]
        return xs


@dataclass(frozen=True, slots=True, eq=False)
class Holding:
    """A path of a limb along the handle's motion, free of contact but for fingers and handle.

    Attributes:
        xs: Shape (K, n).
        rest: Scene configuration at x = 0 with the fingers closed on the bar.
        style: How the path came about: carried or followed.
    """

    limb: Limb
    grasp: Grasp
    xs: Array
    rest: Array
    style: str


@dataclass(frozen=True, slots=True)
class Farthest:
    """How far a handle was held at best by paths that do not hold it to the end.

    Attributes:
        index: Of the last waypoint at which all is well, from the first on.
        shapes: What comes too near at the next; None where limits end the path.
    """

    index: int
    shapes: tuple[int, int] | None


@dataclass(slots=True)
class Tally:
    """What a search has tried, and the contacts and failures it met."""

    grasps: int = 0
    seeds: int = 0
    solved: int = 0
    paths: int = 0
    broken: int = 0
    contacts: Counter[tuple[str, int, int]] = field(default_factory=Counter[tuple[str, int, int]])
    farthest: Farthest | None = None

    @property
    def came(self) -> int:
        """The last waypoint of the farthest path; −1 where there is none."""
        return -1 if self.farthest is None else self.farthest.index

    def met(self, stage: str, contact: Contact) -> None:
        """One more contact at a stage."""
        self.contacts[stage, *contact.shapes] += 1


def inside(limb: Limb) -> tuple[Array, Array]:
    """Limits for waypoints, shape (n,): a spline through these keeps those of the limb."""
    kept = np.minimum(INSIDE, (limb.upper - limb.lower) / 4)
    return limb.lower + kept, limb.upper - kept


class Searcher:
    """Search of holdings for one limb and drive."""

    def __init__(self, world: World, limb: Limb, problem: Problem, rules: Rules, drive: Drive) -> None:
        self.world, self.limb, self.problem, self.rules, self.drive = world, limb, problem, rules, drive
        self.planar = problem.planar()
        self.bases = bases(drive, problem.turning())
        self.telescope = None if drive is Drive.OMNI else telescope(limb)
        self._batches = 0
        self.weight = mobility(limb)
        self.lower, self.upper = inside(limb)
        self.tally = Tally()
        self._standing: Array | None = None
        self._aims: dict[tuple[Grasp, int | None], tuple[Array, Array]] = {}

    def _aim_at(self, grasp: Grasp, index: int | None) -> tuple[Array, Array]:
        """World tool poses of a grasp at a waypoint, or at all of them; kept, so not to be changed."""
        key = grasp, index
        if key not in self._aims:
            at = slice(None) if index is None else index
            self._aims[key] = grasp.tool(self.problem.handle_r[at], self.problem.handle_p[at])
        return self._aims[key]

    def stand(self, base: Array) -> None:
        """The base stays at this pose (3,)."""
        self.weight[BASE] = 0.0
        self._standing = base

    def stood(self, xs: Array) -> Array:
        """The path xs (K, n), its base where it stands, if it does: rounding may have moved it."""
        if self._standing is not None:
            xs[:, BASE] = self._standing
        return xs

    def batch(
        self,
        grasps: list[tuple[Grasp, Array]],
        pivot: int,
        rng: np.random.Generator,
    ) -> Iterator[Holding]:
        """Holdings of grasps (each with its closed scene rest) that one batch of seeds leads to."""
        seeds, weight = self.seeds(pivot, rng), self.weight.copy()
        if self.telescope is not None and self._standing is None and self._batches % 2 == 0:
            self._aim(seeds, pivot, rng)
            weight[2] = 0.0
        self._batches += 1
        for first in range(0, SEEDS, TOGETHER):
            chosen = [grasps[i % len(grasps)] for i in range(first, first + TOGETHER)]
            xs = seeds[first : first + TOGETHER]
            for s in self._clear(self._met(xs, chosen, pivot, weight), xs, chosen, pivot):
                yield from self._led(xs[s], *chosen[s], pivot)

    def _met(
        self, xs: Array, chosen: list[tuple[Grasp, Array]], index: int, weight: Array
    ) -> NDArray[np.intp]:
        """Which of xs (N, n) were moved to where the tool is in their grasps at a waypoint."""
        aims = (self._aim_at(one, index) for one, _ in chosen)
        target_r, target_p = (np.array(part) for part in zip(*aims, strict=True))
        limits = self.lower, self.upper
        met = ik.solve_many(xs, target_r, target_p, self.limb.chain, weight, *limits, STEPS, EXACT)
        self.tally.seeds += len(xs)
        self.tally.solved += int(met.sum())
        return np.flatnonzero(met)

    def seeds(self, pivot: int, rng: np.random.Generator) -> Array:
        """A batch of random x about the handle at a waypoint, or where the base stands."""
        seeds = self.limb.drawn(rng, SEEDS, self.lower, self.upper)
        out = self.problem.outward
        side = np.arctan2(out[1], out[0]) + rng.uniform(-1.2, 1.2, SEEDS)
        away = rng.uniform(NEAR, FAR, SEEDS)
        seeds[:, 0] = self.problem.handle_p[pivot, 0] + away * np.cos(side)
        seeds[:, 1] = self.problem.handle_p[pivot, 1] + away * np.sin(side)
        seeds[:, 2] = side + np.pi + rng.uniform(-np.pi, np.pi, SEEDS)
        if self._standing is not None:
            seeds[:, BASE] = self._standing
        return seeds

    def _aim(self, seeds: Array, pivot: int, rng: np.random.Generator) -> None:
        """Turn the seeds so that the telescope lies along the handle's motion, one way or the other."""
        assert self.telescope is not None
        yaw = self.problem.along(pivot) - self.telescope
        seeds[:, 2] = yaw + np.pi * rng.integers(0, 2, SEEDS)

    def _clear(
        self, met: NDArray[np.intp], xs: Array, chosen: list[tuple[Grasp, Array]], index: int
    ) -> Iterator[int]:
        """Which of the postures that met their grasps at a waypoint touch nothing."""
        if not len(met):
            return
        q = self.limb.q(xs[met], np.stack([chosen[s][1] for s in met]))
        q = self.problem.mechanics.put_each(q, np.repeat(self.problem.values[index], len(met)))
        for s, shapes in zip(met.tolist(), self.world.contact_each(q, self.rules), strict=True):
            if shapes is None:
                yield s
            else:
                self.tally.met("pose", Contact(index, shapes))

    def _led(self, x: Array, grasp: Grasp, rest: Array, pivot: int) -> Iterator[Holding]:
        if self.drive is Drive.OMNI and self.planar:
            xs = self.problem.carried(x, pivot)
            if self.free(xs, rest):
                yield Holding(self.limb, grasp, xs, rest, "carried, the arm still")
                return
        for base in self.bases:
            xs = self._followed(x, grasp, rest, pivot, base)
            if xs is None:
                self.tally.broken += 1
            elif self.free(xs, rest):
                yield Holding(self.limb, grasp, xs, rest, f"followed, {base.value}")
                return

    def _followed(self, x: Array, grasp: Grasp, rest: Array, pivot: int, base: Base) -> Array | None:
        """Path through all waypoints from the pivot both ways, shape (K, n)."""
        tool_r, tool_p = self._aim_at(grasp, None)
        limits = self.lower, self.upper
        back = tracked(self.limb, x, (tool_r[pivot::-1], tool_p[pivot::-1]), base, limits)
        if len(back) <= pivot:
            return None
        on = tracked(self.limb, x, (tool_r[pivot:], tool_p[pivot:]), base, limits)
        path = np.concatenate([back[:0:-1], on])
        if len(path) == len(tool_p):
            return path
        if len(path) - 1 > self.tally.came:
            q = self.problem.mechanics.put_each(self.limb.q(path, rest), self.problem.values[: len(path)])
            self._ended(q, self.world.contact(q, self.rules))
        return None

    def _ended(self, q: Array, contact: Contact | None) -> None:
        """A path from the first waypoint on ends where q does, or before at a contact, if there is one."""
        last, shapes = len(q) - 1, None
        while contact is not None and contact.index - 1 > self.tally.came:
            last, shapes = contact.index - 1, contact.shapes
            contact = self.world.contact(q[: contact.index], self.rules)
        if contact is None and last > self.tally.came:
            self.tally.farthest = Farthest(last, shapes)

    def free(self, xs: Array, rest: Array) -> bool:
        """Whether the path touches nothing that it may not."""
        self.tally.paths += 1
        q = self.problem.mechanics.put_each(self.limb.q(xs, rest), self.problem.values)
        contact = self.world.contact(q, self.rules)
        if contact is not None:
            self.tally.met("path", contact)
            self._ended(q, contact)
        return contact is None
