"""Which grasps the kitchen leaves room for, by the hand alone."""

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from services.embodiment.body import hands
from services.embodiment.body.world import Rules, World
from services.embodiment.hold.grasp import TOUCH, Grasp, Hand, grasp_set, steepness, wide_set
from services.embodiment.hold.handle import Bar
from services.embodiment.hold.holding import Problem

Array = NDArray[np.float64]
Pair = tuple[int, int]
Fitted = tuple[Grasp, Array]

OPENINGS = (0.0, 0.55, 0.75)  # [1] shares by which the fingers are closed when the hand comes near
SWING = 6  # steps at which closing fingers are checked
BLOCK = 45  # grasps that are looked at together
ENOUGH = 6  # grasps with which no narrower opening is tried
CHECKED = 7  # values of the container at which the hand alone is checked
BESIDE = 0.05  # [m] that a grasp's tool may lie beside the bar
ROUNDS = 12  # of regula falsi; three or four are usual


class Room:
    """The kitchen as the hand finds it at some values of the container, seen from the handle.

    Attributes:
        near: Kitchen shapes near the handle where the container has not moved: indices, rotations, centres.
        always: The same at all values, one after the other, and where each value ends.
        handle: The same of the handle alone, where the container has not moved.
    """

    def __init__(self, hand: Hand, problem: Problem, bar: Bar) -> None:
        self.world: World = hand.world
        at = np.unique(np.linspace(0, len(problem.values) - 1, CHECKED).astype(int))
        q = problem.mechanics.put(hand.configuration(0.0), problem.values[at])
        r, p = problem.handle_r, problem.handle_p
        middle, reach = r[0] @ bar.centre + p[0], hand.reach + bar.length / 2 + BESIDE
        near = [
            self._near(one, (r[k], p[k]), (r[0], p[0]), middle, reach) for one, k in zip(q, at, strict=True)
        ]
        self.near = near[0]
        ends = np.cumsum([len(one[0]) for one in near])
        self.always = (*(np.concatenate(parts) for parts in zip(*near, strict=True)), ends)
        own = self.world.shapes_of((problem.mechanics.container.handle,))
        frames, (joint, local_r, local_c) = self.world.frames(hand.configuration(0.0)), self.world.boxes
        self.handle = own, frames[0][joint[own]] @ local_r[own], _moved(frames, joint[own], local_c[own])

    def _near(
        self, q: Array, now: tuple[Array, Array], first: tuple[Array, Array], middle: Array, reach: float
    ) -> tuple[NDArray[np.int64], Array, Array]:
        """Kitchen shapes near the handle at q; their poses as if it were not at `now` but at `first`."""
        kitchen, (joint, local_r, local_c) = slice(self.world.split), self.world.boxes
        joint, local_r, local_c = joint[kitchen], local_r[kitchen], local_c[kitchen]
        frames = self.world.frames(q)
        turn = now[0] @ first[0].T
        at_r = turn.T @ (frames[0][joint] @ local_r)
        at_c = (_moved(frames, joint, local_c) - (now[1] - turn @ first[1])) @ turn
        beyond = np.abs(((middle - at_c)[:, None] @ at_r)[:, 0]) - self.world.half[kitchen]
        near = np.flatnonzero(np.linalg.norm(np.maximum(beyond, 0.0), axis=1) < reach)
        return near, np.ascontiguousarray(at_r[near]), np.ascontiguousarray(at_c[near])


def _moved(frames: tuple[Array, Array], joint: NDArray[np.int64], local: Array) -> Array:
    """World positions of points (N, 3) of joints."""
    return (frames[0][joint] @ local[:, :, None])[:, :, 0] + frames[1][joint]


class Fitter:
    """Finds the grasps that the hand alone can take and keep, each with its scene at x = 0, fingers closed.

    What is known of a grasp is kept: it may be asked for in more than one order.

    Args:
        hand: Whose fingers close.
        problem: What is held.
        bar: Where.
        demands: The distances demanded while it holds, and of the open hand.
        unfit: Counts the pairs of shapes whose contact rules a grasp out.
    """

    def __init__(
        self, hand: Hand, problem: Problem, bar: Bar, demands: tuple[Rules, Rules], unfit: Counter[Pair]
    ) -> None:
        self.hand, self.problem, self.bar, self.demands, self.unfit = hand, problem, bar, demands, unfit
        self.room = Room(hand, problem, bar)
        world = hand.world
        self._margins = demands[0].environment, demands[1].environment
        self._rest = world.split, world.radius, world.shapes
        self._known: dict[tuple[float, int], Fitted | None] = {}
        self._all: list[Fitted] | None = None
        self._work = hand.room()
        joints = len(hand.closing[1])
        self._begin = np.zeros((joints, 2)), np.zeros((joints, 2), np.int64)

    def fitting(self, late: Callable[[], bool] = lambda: False, steep: bool = False) -> Iterator[Fitted]:
        """Those grasps; those that come from far above or below are first if `steep`."""
        if self._all is not None:
            yield from sorted(self._all, key=lambda one: steepness(one[0].index)) if steep else self._all
            return
        found: list[Fitted] = []
        for fitted in self._fitted_of(lambda: grasp_set(self.bar, steep), late):
            found.append(fitted)
            yield fitted
        if not late():
            self._all = found

    def wide(self, late: Callable[[], bool]) -> list[Fitted]:
        """The same of the wide set."""
        return list(self._fitted_of(lambda: wide_set(self.bar), late))

    def _fitted_of(self, grasps: Callable[[], Iterator[Grasp]], late: Callable[[], bool]) -> Iterator[Fitted]:
        """Those of a set that fit, the fingers no narrower than needed."""
        found = 0
        for share in OPENINGS:
            some = grasps()
            while block := list(islice(some, BLOCK)):
                if late():
                    return
                self._screen(block, share)
                for grasp in block:
                    fitted = self._fitted(grasp, share)
                    if fitted is not None:
                        found += 1
                        yield fitted
            if found >= ENOUGH:
                return

    def _screen(self, grasps: list[Grasp], share: float) -> None:
        """Those grasps at which the open hand touches something before the container moves are ruled out."""
        new = [one for one in grasps if (share, one.index) not in self._known]
        if not new:
            return
        r, p = self.problem.handle_r[0], self.problem.handle_p[0]
        tools = (
            r @ np.stack([one.rotation for one in new]),
            np.stack([one.translation for one in new]) @ r.T + p,
        )
        found = np.empty((len(new), 2), np.int64)
        seen, margins = self.hand.shapes_seen(share), self._margins[1]
        hands.touching_many(self.hand.shapes, seen, tools, self.room.near, *self._rest, margins, found)
        for grasp, pair in zip(new, found.tolist(), strict=True):
            if pair[0] >= 0:
                self._rule_out(grasp, share, (pair[0], pair[1]))

    def _rule_out(self, grasp: Grasp, share: float, pair: Pair) -> None:
        self.unfit[pair] += 1
        self._known[share, grasp.index] = None

    def _fitted(self, grasp: Grasp, share: float) -> Fitted | None:
        """The grasp with its fingers closed on the handle, if they can be and the hand can stay."""
        key = share, grasp.index
        if key not in self._known:
            self._known[key] = None
            self._close(grasp, share)
        return self._known[key]

    def _close(self, grasp: Grasp, share: float) -> None:
        hand, scene = self.hand, (self._rest[2], TOUCH, ROUNDS)
        handle_r, handle_p = self.problem.handle_r[0], self.problem.handle_p[0]
        tool = grasp.tool(handle_r, handle_p)
        shares = np.zeros(len(hand.closing[1]))
        if not hands.closed(
            tool,
            shares,
            hand.sides,
            hand.parts,
            hand.closing,
            self.room.handle,
            *scene,
            self._work,
            *self._begin,
        ):
            return
        start = np.full(len(shares), share)
        held = hand.parts, hand.closing, self.room.always, self._rest, self._margins, self._work
        pair = hands.kept(tool, shares, start, SWING, *held)
        if pair[0] >= 0:
            self._rule_out(grasp, share, pair)
            return
        centred = replace(
            grasp,
            translation=handle_r.T @ (tool[1] - handle_p),
            fingers=hand.positions(shares),
            opened=hand.opening(share),
        )
        self._known[share, grasp.index] = centred, hand.configuration(dict(centred.fingers))
