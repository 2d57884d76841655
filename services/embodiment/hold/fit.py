"""Which grasps the kitchen leaves room for, by the hand alone."""

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import chain, islice, repeat

import numpy as np
from numpy.typing import NDArray

from services.embodiment.body import hands
from services.embodiment.body.world import Rules, World
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.hold.grasp import TOUCH, Grasp, Hand, grasp_set, steepness, wide_set
from services.embodiment.hold.handle import Bar
from services.embodiment.hold.holding import Problem

Array = NDArray[np.float64]
Pair = tuple[int, int]
Fitted = tuple[Grasp, Array]
Opened = tuple[Grasp, float]

OPENINGS = (0.0, 0.55, 0.75)  # [1] shares by which the fingers are closed when the hand comes near
SWING = 6  # steps at which closing fingers are checked
BLOCKS = (10, 45)  # grasps that are looked at together: at first, and then
ENOUGH = 6  # grasps with which no narrower opening is tried
CHECKED = 7  # values of the container at which the hand alone is checked
BESIDE = 0.05  # [m] that a grasp's tool may lie beside the bar
REACH = Tolerances().engaged  # [m] by which fingers reach over a handle
INWARD = REACH * float(np.tan(Tolerances().facing))  # [m] that they then move on until they meet it
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
        at_c = (_moved(frames, joint, local_c) - (now[1] - turn @ first[1])) @ turn
        away = np.linalg.norm(middle - at_c, axis=1) - self.world.radius[kitchen]
        near = np.flatnonzero(away < reach)
        at_r = turn.T @ (frames[0][joint[near]] @ local_r[near])
        beyond = np.abs(((middle - at_c[near])[:, None] @ at_r)[:, 0]) - self.world.half[near]
        boxed = np.linalg.norm(np.maximum(beyond, 0.0), axis=1) < reach
        near, at_r = near[boxed], at_r[boxed]
        return near, np.ascontiguousarray(at_r), np.ascontiguousarray(at_c[near])


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
        self._closed: dict[int, tuple[Array, Array] | None] = {}
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
        for share in OPENINGS:
            for grasp in self.screened(grasp_set(self.bar, steep), share, late):
                fitted = self.fitted((grasp, share))
                if fitted is not None:
                    found.append(fitted)
                    yield fitted
            if len(found) >= ENOUGH or late():
                break
        if not late():
            self._all = found

    def wide(self, late: Callable[[], bool]) -> list[Opened]:
        """Grasps of the wide set that may fit, the fingers no narrower than needed; `fitted` tells."""
        found: list[Opened] = []
        for share in OPENINGS:
            some = [(grasp, share) for grasp in self.screened(wide_set(self.bar), share, late)]
            found += islice((one for one in some if self.fitted(one) is not None), ENOUGH - len(found))
            if len(found) == ENOUGH:
                return [*dict.fromkeys((*found, *(one for one in some if not self._out(*one))))]
        return found

    def screened(self, grasps: Iterator[Grasp], share: float, late: Callable[[], bool]) -> Iterator[Grasp]:
        """Those at which the open hand touches nothing before the container moves."""
        sizes = chain(BLOCKS, repeat(BLOCKS[-1]))
        while block := list(islice(grasps, next(sizes))):
            if late():
                return
            new = [one for one in block if (share, one.index) not in self._known]
            new = [one for one in new if not self._out(one, share)]
            if new:
                self._screen(new, share)
            yield from (one for one in block if not self._out(one, share))

    def _out(self, grasp: Grasp, share: float) -> bool:
        """Whether it is known that a grasp does not fit."""
        never = self._closed.get(grasp.index, self._begin) is None
        return never or self._known.get((share, grasp.index), self._begin) is None

    def _screen(self, grasps: list[Grasp], share: float) -> None:
        """Those grasps at which the open hand touches something before the container moves are ruled out."""
        r, p = self.problem.handle_r[0], self.problem.handle_p[0]
        tools = (
            r @ np.stack([one.rotation for one in grasps]),
            np.stack([self._beside(one) for one in grasps]) @ r.T + p,
        )
        found = np.empty((len(grasps), 2), np.int64)
        seen, margins = self.hand.shapes_seen(share), self._margins[1]
        hands.touching_many(self.hand.shapes, seen, tools, self.room.near, *self._rest, margins, found)
        for grasp, (one, other) in zip(grasps, found.tolist(), strict=True):
            if one >= 0:
                self.unfit[one, other] += 1
                self._known[share, grasp.index] = None
                if one in self.hand.still:
                    self._closed[grasp.index] = None

    def fitted(self, opened: Opened) -> Fitted | None:
        """The grasp with its fingers closed on the handle, if they can be and the hand can stay."""
        grasp, share = opened
        key = share, grasp.index
        if key not in self._known:
            if grasp.index not in self._closed:
                self._closed[grasp.index] = self._close(grasp)
            self._known[key] = self._swung(grasp, share)
        return self._known[key]

    def engaged(self, fitted: Fitted) -> bool:
        """Whether fingers that have closed reach over the handle all around, as certification demands."""
        grasp, hand = fitted[0], self.hand
        closed = self._closed[grasp.index]
        assert closed is not None, "its fingers were closed"
        tool = self.problem.handle_r[0] @ grasp.rotation, closed[0]
        about = hand.pads, hand.parts, hand.closing, self.room.handle, self._rest[2]
        return hands.engaged(tool, closed[1], *about, REACH, INWARD, self._work)

    def known(self, opened: Opened) -> Fitted | None:
        """The same, if it is known."""
        return self._known.get((opened[1], opened[0].index))

    def _close(self, grasp: Grasp) -> tuple[Array, Array] | None:
        """Where the tool is when the hand has closed on the handle, and how far its joints are then.

        None if they cannot be closed, or if the hand could not stay there as the container moves.
        """
        hand, scene = self.hand, (self._rest[2], TOUCH, ROUNDS)
        r, p = self.problem.handle_r[0], self.problem.handle_p[0]
        tool = r @ grasp.rotation, r @ self._beside(grasp) + p
        shares = np.zeros(len(hand.closing[1]))
        bar = self.room.handle
        if not hands.closed(
            tool, shares, hand.sides, hand.parts, hand.closing, bar, *scene, self._work, *self._begin
        ):
            return None
        at = [position for _, position in hand.positions(shares)]
        if max(at) - min(at) > hand.limb.gripper.difference:
            return None
        held = hand.parts, hand.closing, self.room.always, self._rest, self._margins[0], self._work
        pair = hands.stays(tool, shares, *held)
        if pair[0] >= 0:
            self.unfit[pair] += 1
            return None
        return tool[1], shares

    def _beside(self, grasp: Grasp) -> Array:
        """Where the tool of the open hand is, in the handle's frame: the bar has room between its fingers."""
        return (
            grasp.translation - self.hand.amid * grasp.rotation[:, 1] if self.hand.amid else grasp.translation
        )

    def _swung(self, grasp: Grasp, share: float) -> Fitted | None:
        """The closed grasp, if the fingers can swing there from where they are closed by a share."""
        closed, hand = self._closed[grasp.index], self.hand
        if closed is None:
            return None
        handle_r, handle_p = self.problem.handle_r[0], self.problem.handle_p[0]
        (place, shares), start = closed, np.full(len(closed[1]), share)
        margins = self._margins if not hand.amid else (self._margins[0],) * 2
        held = hand.parts, hand.closing, self.room.near, self._rest, margins, self._work
        pair = hands.swings((handle_r @ grasp.rotation, place), shares, start, SWING, *held)
        if pair[0] >= 0:
            self.unfit[pair] += 1
            return None
        there = handle_r.T @ (place - handle_p)
        centred = replace(
            grasp,
            translation=there,
            aside=self._beside(grasp) - there if hand.amid else None,
            fingers=hand.positions(shares),
            opened=hand.opening(share),
        )
        return centred, hand.configuration(dict(centred.fingers))
