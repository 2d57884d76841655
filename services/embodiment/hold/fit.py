"""Which grasps the kitchen leaves room for, by the hand alone."""

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from services.embodiment.body import hands
from services.embodiment.body.world import Contact, Rules, World
from services.embodiment.hold.grasp import Grasp, Hand, grasp_set
from services.embodiment.hold.handle import Bar
from services.embodiment.hold.holding import Problem

Array = NDArray[np.float64]

Pair = tuple[int, int]

OPENINGS = (0.0, 0.55, 0.75)  # [1] shares by which the fingers are closed when the hand comes near
SWING = 6  # steps at which closing fingers are checked
BLOCK = 45  # grasps that are looked at together
ENOUGH = 6  # grasps with which no narrower opening is tried
CHECKED = 7  # values of the container at which the hand alone is checked
BESIDE = 0.05  # [m] that a grasp's tool may lie beside the bar


class Room:
    """The kitchen as the hand finds it at some values of the container, seen from the handle.

    Attributes:
        hand: Whose fingers close.
    """

    def __init__(self, hand: Hand, problem: Problem, bar: Bar) -> None:
        self.hand, self.problem = hand, problem
        self.world: World = hand.world
        self.at = np.unique(np.linspace(0, len(problem.values) - 1, CHECKED).astype(int))
        q = problem.mechanics.put(hand.configuration(0.0), problem.values[self.at])
        self._frames = [self.world.frames(one) for one in q]
        first, there = self.at[0], problem.handle_r
        self._turn = there[self.at] @ there[first].T
        self._shift = problem.handle_p[self.at] - (self._turn @ problem.handle_p[first])
        middle = there[first] @ bar.centre + problem.handle_p[first]
        reach = hand.reach + bar.length / 2 + BESIDE
        self._near = [self._seen(k, middle, reach) for k in range(len(self.at))]

    def _seen(self, k: int, middle: Array, reach: float) -> tuple[NDArray[np.int64], Array, Array]:
        """Kitchen shapes near the handle at checked value k, and their poses as the handle sees them."""
        world, turn = self.world, self._turn[k]
        split, (joint, local_r, local_c) = world.split, world.boxes
        joint, local_r, local_c = joint[:split], local_r[:split], local_c[:split]
        r, p = self._frames[k]
        at_r = turn.T @ (r[joint] @ local_r)
        at_c = ((r[joint] @ local_c[:, :, None])[:, :, 0] + p[joint] - self._shift[k]) @ turn
        beyond = np.abs(((middle - at_c)[:, None] @ at_r)[:, 0]) - world.half[:split]
        near = np.flatnonzero(np.linalg.norm(np.maximum(beyond, 0.0), axis=1) < reach)
        return near, np.ascontiguousarray(at_r[near]), np.ascontiguousarray(at_c[near])

    def screened(self, grasps: list[Grasp], q: Array, rules: Rules, unfit: Counter[Pair]) -> list[Grasp]:
        """Those grasps at which the hand as in q touches nothing before the container moves.

        `unfit` counts the pairs of shapes whose contact rules the others out.
        """
        first = self.at[0]
        poses = [one.tool(self.problem.handle_r[first], self.problem.handle_p[first]) for one in grasps]
        found = np.empty((len(grasps), 2), np.int64)
        hands.touching_many(
            self.hand.shapes,
            self.hand.shapes_seen(q),
            (np.stack([r for r, _ in poses]), np.stack([p for _, p in poses])),
            self._near[0],
            self.world.split,
            self.world.radius,
            self.world.shapes,
            rules.environment,
            found,
        )
        touches = found[:, 0] >= 0
        unfit.update(map(tuple, found[touches].tolist()))
        return [grasps[g] for g in np.flatnonzero(~touches)]

    def contact(self, grasp: Grasp, q: Array, rules: Rules, first: int, last: int) -> Contact | None:
        """A contact of the hand with fingers as in q at the checked values first … last − 1."""
        tool = grasp.tool(self.problem.handle_r[self.at[0]], self.problem.handle_p[self.at[0]])
        hand = self.hand.shapes_at(q, *tool)
        for k in range(first, last):
            one, other = hands.touching(
                self.hand.shapes,
                hand,
                self._near[k],
                self.world.split,
                self.world.radius,
                self.world.shapes,
                rules.environment,
            )
            if one >= 0:
                return Contact(int(self.at[k]), (one, other))
        return None


def fitting(  # noqa: PLR0913, PLR0917  # what is held, what it demands, and when to stop
    hand: Hand,
    problem: Problem,
    bar: Bar,
    demands: tuple[Rules, Rules],
    unfit: Counter[Pair],
    late: Callable[[], bool] = lambda: False,
    steep: bool = False,
) -> Iterator[tuple[Grasp, Array]]:
    """Grasps that the hand alone can take and keep, each with the scene at x = 0 and fingers closed.

    `demands` are the distances demanded while it holds, and of the open hand; `unfit` counts the pairs
    of shapes whose contact rules a grasp out. Those that come from far above or below are first if `steep`.
    """
    room = Room(hand, problem, bar)
    found = 0
    for share in OPENINGS:
        opened, grasps = hand.configuration(share), grasp_set(bar, steep)
        while block := list(islice(grasps, BLOCK)):
            if late():
                return
            for grasp in room.screened(block, opened, demands[1], unfit):
                fitted = _fitted(room, replace(grasp, opened=hand.opening(share)), demands, unfit)
                if fitted is not None:
                    found += 1
                    yield fitted
        if found >= ENOUGH:
            return


def _fitted(
    room: Room, grasp: Grasp, demands: tuple[Rules, Rules], unfit: Counter[Pair]
) -> tuple[Grasp, Array] | None:
    """The grasp with its fingers closed on the handle, if they can be and the hand can stay."""
    handle = room.world.shapes_of((room.problem.mechanics.container.handle,))
    closed = room.hand.closed_on(grasp, handle, room.problem.handle_r[0], room.problem.handle_p[0])
    if closed is None:
        return None
    q = room.hand.configuration(dict(closed.fingers))
    contact = room.contact(closed, q, demands[0], 0, len(room.at))
    if contact is not None:
        unfit[contact.shapes] += 1
        return None
    return (closed, q) if _closes(room, closed, demands) else None


def _closes(room: Room, grasp: Grasp, demands: tuple[Rules, Rules]) -> bool:
    """Whether the open hand stands free at the grasp, and its fingers swing free of all but the handle."""
    start, end = dict(grasp.opened), dict(grasp.fingers)
    for step in range(SWING + 1):
        fingers = {joint: start[joint] + step / SWING * (end[joint] - start[joint]) for joint in start}
        q = room.hand.configuration(fingers)
        if room.contact(grasp, q, demands[1 if step == 0 else 0], 0, 1) is not None:
            return False
    return True
