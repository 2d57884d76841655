"""Which grasps the kitchen leaves room for, by the hand alone."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from services.embodiment.body import kernels
from services.embodiment.body.world import Contact, Rules, World
from services.embodiment.hold.grasp import Grasp, Hand, grasp_set
from services.embodiment.hold.handle import Bar
from services.embodiment.hold.holding import Problem

Array = NDArray[np.float64]

OPENINGS = (0.0, 0.55, 0.75)  # [1] shares by which the fingers are closed when the hand comes near
SWING = 6  # steps at which closing fingers are checked
ENOUGH = 6  # grasps with which no narrower opening is tried
CHECKED = 7  # values of the container at which the hand alone is checked


class Room:
    """The kitchen as the hand finds it at some values of the container.

    Attributes:
        hand: Whose fingers close.
    """

    def __init__(self, hand: Hand, problem: Problem) -> None:
        self.hand, self.problem = hand, problem
        self.world: World = hand.world
        self.at = np.unique(np.linspace(0, len(problem.values) - 1, CHECKED).astype(int))
        split = self.world.split
        self._index = np.concatenate([np.arange(split), hand.shapes])
        self._frames = [
            self.world.frames(q)
            for q in problem.mechanics.put(hand.configuration(0.0), problem.values[self.at])
        ]
        self._boxes = [self._place(r, p) for r, p in self._frames]

    def _place(self, r: Array, p: Array) -> tuple[Array, Array]:
        n = len(self.world.body)
        box_r, box_c = np.empty((n, 3, 3)), np.empty((n, 3))
        kernels.place_boxes(r, p, self.world.boxes, box_r, box_c)
        return box_r, box_c

    def contact(self, grasp: Grasp, q: Array, rules: Rules, first: int, last: int) -> Contact | None:
        """A contact of the hand with fingers as in q at the checked values first … last − 1."""
        tool_r, tool_p = grasp.tool(self.problem.handle_r[self.at[0]], self.problem.handle_p[self.at[0]])
        r, p = self.hand.placed(q, tool_r, tool_p)
        base_r, base_p = self.problem.handle_r[self.at[0]], self.problem.handle_p[self.at[0]]
        for k in range(first, last):
            turn = self.problem.handle_r[self.at[k]] @ base_r.T
            shift = self.problem.handle_p[self.at[k]] - turn @ base_p
            shapes = self._touching(k, (turn, shift), (r, p), rules)
            if shapes is not None:
                return Contact(int(self.at[k]), shapes)
        return None

    def _touching(
        self, k: int, moved: tuple[Array, Array], frames: tuple[Array, Array], rules: Rules
    ) -> tuple[int, int] | None:
        """Shapes in contact at checked value k, the hand of the frames moved by (turn, shift)."""
        turn, shift = moved
        boxes = self._place(*frames)
        world, split, shapes = self.world, self.world.split, self.hand.shapes
        kitchen_r, kitchen_c = self._boxes[k]
        pose = (
            np.concatenate([kitchen_r[:split], turn @ boxes[0][shapes]]),
            np.concatenate([kitchen_c[:split], boxes[1][shapes] @ turn.T + shift]),
        )
        index, margins = self._index, np.ascontiguousarray(rules.environment[shapes - split])
        found = np.empty((256, 2), np.int64)
        state, count = kernels.check_environment(
            split, pose, world.half[index], world.radius[index], world.kind[index], margins, found
        )
        if state == kernels.FREE:
            return None
        pairs = [(int(index[a]), int(index[b])) for a, b in found[: min(count, len(found))]]
        if state == kernels.HIT or count > len(found):
            return pairs[0]
        r, p = self._frames[k][0].copy(), self._frames[k][1].copy()
        own = slice(world.scene.base[0] + 1, None)
        r[own], p[own] = turn @ frames[0][own], frames[1][own] @ turn.T + shift
        return next(
            (pair for pair in pairs if world.near(pair, r, p, rules.environment[pair[0] - split, pair[1]])),
            None,
        )


def fitting(
    hand: Hand,
    problem: Problem,
    bar: Bar,
    demands: tuple[Rules, Rules],
    unfit: Counter[tuple[int, int]],
) -> Iterator[tuple[Grasp, Array]]:
    """Grasps that the hand alone can take and keep, each with the scene at x = 0 and fingers closed.

    `demands` are the distances demanded while it holds, and of the open hand; `unfit` counts the pairs
    of shapes whose contact rules a grasp out.
    """
    room = Room(hand, problem)
    handle = room.world.shapes_of((problem.mechanics.container.handle,))
    found = 0
    for share in OPENINGS:
        opened = hand.configuration(share)
        for grasp in grasp_set(bar):
            contact = room.contact(grasp, opened, demands[1], 0, 1)
            if contact is not None:
                unfit[contact.shapes] += 1
                continue
            closed = hand.closed_on(grasp, handle, problem.handle_r[0], problem.handle_p[0])
            if closed is None:
                continue
            closed = replace(closed, opened=hand.opening(share))
            q = hand.configuration(dict(closed.fingers))
            contact = room.contact(closed, q, demands[0], 0, len(room.at))
            if contact is not None:
                unfit[contact.shapes] += 1
            elif _closes(room, closed, demands):
                found += 1
                yield closed, q
        if found >= ENOUGH:
            return


def _closes(room: Room, grasp: Grasp, demands: tuple[Rules, Rules]) -> bool:
    """Whether the open hand stands free at the grasp, and its fingers swing free of all but the handle."""
    start, end = dict(grasp.opened), dict(grasp.fingers)
    for step in range(SWING + 1):
        fingers = {joint: start[joint] + step / SWING * (end[joint] - start[joint]) for joint in start}
        q = room.hand.configuration(fingers)
        if room.contact(grasp, q, demands[1 if step == 0 else 0], 0, 1) is not None:
            return False
    return True
