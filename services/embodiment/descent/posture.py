"""Postures that hold a handle: a descent drives it between the fingers and shapes out of each other.

From a random posture the handle is led between the fingers; then depths count too, the hand closes there, and
the tool stays where it is while what is left of them is driven out.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from services.embodiment.body.hand import fingers
from services.embodiment.body.limb import BASE
from services.embodiment.descent.depths import SPARE, Depths
from services.embodiment.descent.pinch import Grip, Pads, Pose, face, led
from services.embodiment.descent.solver import Bounds, Solver
from services.embodiment.hold.fit import REACH, ROUNDS
from services.embodiment.hold.grasp import TOUCH
from services.embodiment.hold.holding import inside

Array = NDArray[np.float64]

STEPS, LAST_STEPS = 25, 40  # of a descent, and of the one with the hand closed
LED = 0.02  # [m] from the handle at which it goes on with depths
HALF_CLOSED = 0.75  # [1] share of fingers that cannot close where they are
LOOKS = 3  # times that the hand is closed on the way
HOPELESS = 0.04  # [m] of the residual after the second of them
SLOW = 0.8  # [1] of the residual that is left when it ends early
NEARLY = 0.004  # [m] of the residual with which a closed hand is looked at
MET, FREE = 1e-5, 2e-6  # [m] of residuals that count as none: on the way, and at its end
HELD = 1e-4  # [m, rad · ANGLE] from where the hand closed
OPEN_COST, LOOSE_COST = 0.01, 0.005  # [m] that a hand that does not close, or not reach over, counts as
KEPT = 12  # postures that were nearly free, from which others begin
AGAIN = 0.4  # [1] of starts that are beside one of them
APART = 2e-4  # [m] of residual between two of them
SCANTLY = 0.5  # [1] of starts that look for scant holds
BESIDE = (0.03, 0.1, 0.3)  # [rad or m] standard deviations from one


@dataclass(frozen=True, slots=True, eq=False)
class Posture:
    """A posture that was come to.

    Attributes:
        x: Of the limb, shape (n,).
        shares: By which its finger joints are closed, shape (F,).
        cost: What is left of the residual [m].
        grip: What is held.
        holds: Whether nothing is too near and fingers reach over the handle.
    """

    x: Array
    shares: Array
    cost: float
    grip: Grip
    holds: bool


@dataclass(slots=True, eq=False)
class Descent:
    """The search for postures of one hand.

    Attributes:
        handle: World pose of the handle's joint at a value of the container.
        inward: How far fingers that reach over it may move on until they meet it there [m].
        scant: Whether scant holds are looked for too (`pinch.py`).
        starts: How many were made.
        near: By value, what was nearly free there.
    """

    depths: Depths
    solver: Solver
    pads: Pads
    grips: list[Grip]
    handle: Callable[[float], Pose]
    bounds: Bounds
    start: Array
    rng: np.random.Generator
    inward: float
    scant: bool = False
    starts: int = 0
    near: dict[float, list[Posture]] = field(default_factory=dict[float, list[Posture]])

    def found(self, value: float, starts: int, late: Callable[[], bool]) -> Posture | None:
        """A posture that holds the handle there, from so many starts."""
        near = self.near.setdefault(value, [])
        for _ in range(starts):
            if late():
                return None
            self.starts += 1
            came = self._from(*self._begin(near), value)
            if came is None:
                continue
            if came.holds:
                return came
            if all(abs(one.cost - came.cost) >= APART for one in near):
                near.append(came)
                near.sort(key=lambda one: one.cost)
                del near[KEPT:]
        return None

    def _begin(self, near: list[Posture]) -> tuple[Array, Grip]:
        """A posture to begin at, and what is to be held."""
        if near and self.rng.random() < AGAIN:
            one = near[self.rng.integers(len(near))]
            change = self.rng.normal(size=len(one.x)) * self.rng.choice(BESIDE)
            return self.bounds.beside(one.x, change), one.grip
        x = self.depths.limb.drawn(self.rng, 1, self.bounds.lower, self.bounds.upper)[0]
        x[BASE] = self.start
        return x, self.grips[self.rng.integers(len(self.grips))]

    def _from(self, x: Array, grip: Grip, value: float) -> Posture | None:
        """Where the descent from x comes to; None where the handle does not come between the fingers."""
        scant, sides = self.scant and self.rng.random() < SCANTLY, len(self.depths.hand.closing[1])
        goal = face(grip, self.handle(value), scant), self.pads.scant if scant else self.pads.room
        x, cost = self.solver.pinch(x, goal, None, STEPS, MET)
        if cost > LED:
            return None
        for look in range(LOOKS):
            closed = self._closed(x, value)
            shares, before = np.full(sides, HALF_CLOSED) if closed is None else closed[1], cost
            x, cost = self.solver.pinch(x, goal, (shares, value), STEPS, MET)
            if cost < MET or (look and (cost > HOPELESS or cost > SLOW * before)):
                break
        closed = self._closed(x, value)
        if closed is None:
            return Posture(x, np.full(sides, HALF_CLOSED), cost + OPEN_COST + LOOSE_COST, grip, False)
        tool, shares, over = closed
        if not over or cost > NEARLY:
            return Posture(x, shares, cost + LOOSE_COST * (not over), grip, False)
        y, left = self.kept(x, shares, tool, value, LAST_STEPS)
        holds = self.free(y, shares, value) and float(np.abs(led(y, self.depths.limb, tool)[0]).max()) < HELD
        return Posture(y, shares, left if holds else max(cost, left), grip, holds)

    def kept(self, x: Array, shares: Array, tool: Pose, value: float, steps: int) -> tuple[Array, float]:
        """Descends to where the tool is at a pose and shapes out of each other; what is left of that."""
        return self.solver.lead(x, tool, (shares, value), steps, FREE)

    def free(self, x: Array, shares: Array, value: float) -> bool:
        """Whether nearly nothing is left of depths: less than what is demanded beyond certification."""
        lacks = self.depths.residual(x, shares, value)[0]
        return float(lacks.max(initial=0.0)) < SPARE

    def _closed(self, x: Array, value: float) -> tuple[Pose, Array, bool] | None:
        """The tool where the hand has closed, its joints' shares, and whether it reaches over the handle."""
        depths = self.depths
        hand, world = depths.hand, depths.world
        count = len(hand.closing[1])
        own = world.shapes_of((depths.mechanics.container.handle,))
        (joints, turns, middles), (r, p) = world.boxes, world.frames(depths.q(x, np.zeros(count), value))
        at = (r[joints[own]] @ middles[own][:, :, None])[:, :, 0] + p[joints[own]]
        bar, tool = (own, r[joints[own]] @ turns[own], at), depths.limb.tool(x)
        shares, begin = np.zeros(count), (np.zeros((count, 2)), np.zeros((count, 2), np.int64))
        about, room = (hand.parts, hand.closing, bar, world.shapes), hand.room()
        if not fingers.closed(tool, shares, hand.sides, *about, TOUCH, ROUNDS, room, *begin):
            return None
        over = fingers.engaged(tool, shares.copy(), hand.pads, *about, REACH, self.inward, room)
        return tool, shares, bool(over)


def make_descent(  # noqa: PLR0913, PLR0917  # of what, where from, and how it holds
    depths: Depths,
    grips: list[Grip],
    handle: Callable[[float], Pose],
    start: Array,
    rng: np.random.Generator,
    inward: float,
) -> Descent:
    """The search for postures of one hand, its base standing at `start` (3,)."""
    lower, upper = inside(depths.limb)
    moves = np.ones(len(lower), np.bool_)
    moves[BASE] = False
    bounds = Bounds(moves, lower, upper)
    solver = Solver(depths, bounds)
    return Descent(depths, solver, Pads(depths.hand), grips, handle, bounds, start, rng, inward)
