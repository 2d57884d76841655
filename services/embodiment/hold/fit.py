"""Which grasps the kitchen leaves room for, by the hand alone."""

from collections import Counter
from collections.abc import Callable, Iterator
from itertools import chain, islice, repeat

import numpy as np
from numpy.typing import NDArray

from services.embodiment.body.hand import fingers, placing
from services.embodiment.body.world import Rules, World
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.hold.grasp import TOUCH, Grasp, Hand, Positions
from services.embodiment.hold.handle import Bar
from services.embodiment.hold.holding import Problem
from services.embodiment.hold.sets import Grasps, grasp_set, steepness, wide_set

Array = NDArray[np.float64]
Pair = tuple[int, int]
Fitted = tuple[Grasp, Array]
Opened = tuple[Grasp, float]

OPENINGS = (0.0, 0.55, 0.75)  # [1] shares by which the fingers are closed when the hand comes near
SWING = 6  # steps at which closing fingers are checked
BLOCKS = (10, 20, 45)  # listed grasps that are looked at together: at first, then, and from then on
ENOUGH = 6  # grasps with which no narrower opening is tried
CHECKED = 7  # values of the container at which the hand alone is checked
BESIDE = 0.05  # [m] that a grasp's tool may lie beside the bar
REACH = Tolerances().engaged  # [m] by which fingers reach over a handle
FACING = Tolerances().facing  # [rad]
FLAT = np.radians(20.0)  # [rad] from the way in which they close faces look that are tried first
ROUNDS = 12  # of regula falsi; three or four are usual


def inward(facing: float) -> float:
    """How far fingers that reach over a handle move on until they meet it there [m], by such faces."""
    return REACH * float(np.tan(facing))


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
        self.near, self.always = self._near(q, (r[at], p[at]), middle, reach)
        own = self.world.shapes_of((problem.mechanics.container.handle,))
        frames, (joint, local_r, local_c) = self.world.frames(hand.configuration(0.0)), self.world.boxes
        self.handle = own, frames[0][joint[own]] @ local_r[own], _moved(frames, joint[own], local_c[own])

    def _near(self, qs: Array, handle: tuple[Array, Array], middle: Array, reach: float) -> tuple:
        """Kitchen shapes near the handle at the first of qs, and at all, as if it stayed at the first."""
        kitchen, (joint, local_r, local_c) = slice(self.world.split), self.world.boxes
        joint, local_r, local_c = joint[kitchen], local_r[kitchen], local_c[kitchen]
        r, p = (np.stack(part)[:, joint] for part in zip(*map(self.world.frames, qs), strict=True))
        turn = handle[0] @ handle[0][0].T
        shift = handle[1] - turn @ handle[1][0]
        at_c = ((r @ local_c[:, :, None])[..., 0] + p - shift[:, None]) @ turn
        away = np.linalg.norm(middle - at_c, axis=2) - self.world.radius[kitchen]
        when, near = np.nonzero(away < reach)
        at_r, at_c = turn[when].transpose(0, 2, 1) @ (r[when, near] @ local_r[near]), at_c[when, near]
        beyond = np.abs(((middle - at_c)[:, None] @ at_r)[:, 0]) - self.world.half[near]
        boxed = np.linalg.norm(np.maximum(beyond, 0.0), axis=1) < reach
        found = near[boxed], at_r[boxed], at_c[boxed]
        ends = np.searchsorted(when[boxed], np.arange(len(qs)), side="right")
        first = slice(ends[0])
        return tuple(part[first] for part in found), (*found, ends)


def _moved(frames: tuple[Array, Array], joint: NDArray[np.int64], local: Array) -> Array:
    """World positions of points (N, 3) of joints."""
    return (frames[0][joint] @ local[:, :, None])[:, :, 0] + frames[1][joint]


class Fitter:
    """Finds the grasps that the hand alone can take and keep, each with its scene at x = 0, fingers closed.

    What is known of a grasp is kept: it may be asked for in more than one order.

    Attributes:
        has_room: Whether the hand can close somewhere and stay there, whether that holds the handle or not.

    Args:
        hand: Whose fingers close.
        problem: What is held.
        bar: Where.
        demands: The distances demanded while it holds, and of the open hand.
        unfit: Counts the pairs of shapes whose contact rules a grasp out.
        facing: How far faces that hold may look away from the way in which fingers close [rad].
    """

    def __init__(  # noqa: PLR0913, PLR0917  # a hand, what it holds, and what is demanded of both
        self,
        hand: Hand,
        problem: Problem,
        bar: Bar,
        demands: tuple[Rules, Rules],
        unfit: Counter[Pair],
        facing: float = FACING,
    ) -> None:
        self.hand, self.problem, self.bar, self.demands, self.unfit = hand, problem, bar, demands, unfit
        self.facing, self._flat = facing, min(facing, FLAT)
        self.room = Room(hand, problem, bar)
        world = hand.world
        self._margins = demands[0].environment, demands[1].environment
        self._rest = world.split, world.radius, world.shapes
        self._closed: dict[int, tuple[Array, Array]] = {}
        self._never, self.has_room = set[int](), False
        self._screened: dict[float, tuple[set[int], set[int]]] = {share: (set(), set()) for share in OPENINGS}
        self._known: dict[tuple[float, int], Fitted | None] = {}
        self._all: list[tuple[bool, Fitted]] | None = None
        self._work = hand.room()
        joints = len(hand.closing[1])
        self._begin = np.zeros((joints, 2)), np.zeros((joints, 2), np.int64)

    def fitting(self, late: Callable[[], bool] = lambda: False, steep: bool = False) -> Iterator[Fitted]:
        """Those grasps; those that come from far above or below are first if `steep`.

        Of all, those by faces that look nearly along the way in which fingers close come first: they take
        less friction. Those that certification refuses for how faces look are left out.
        """
        if self._all is not None:
            known = sorted(self._all, key=lambda one: (one[0], steepness(one[1][0].index)))
            yield from (fitted for _, fitted in (known if steep else self._all))
            return
        found = list[tuple[bool, Fitted]]()
        grasps = grasp_set(self.bar, steep)
        for share in OPENINGS:
            for slanted, grasp in self._flat_first(self._in_blocks(grasps, share, late)):
                held = not slanted or self.engaged(grasp)
                fitted = self.fitted((grasp, share)) if held or not self.has_room else None
                if held and fitted is not None:
                    found.append((slanted, fitted))
                    yield fitted
            if len(found) >= ENOUGH or late():
                break
        if not late():
            self._all = found

    def _flat_first(self, grasps: Iterator[Grasp]) -> Iterator[tuple[bool, Grasp]]:
        """Those that close, and whether by faces that look far away, or by none: these come last."""
        slanted = list[Grasp]()
        for grasp in filter(self._closes, grasps):
            if self._reaches(grasp, self._flat):
                yield False, grasp
            else:
                slanted.append(grasp)
        yield from ((True, grasp) for grasp in slanted)

    def _in_blocks(self, grasps: Grasps, share: float, late: Callable[[], bool]) -> Iterator[Grasp]:
        """What is `screened` of them, as far as it is asked for."""
        first, sizes = 0, chain(BLOCKS, repeat(BLOCKS[-1]))
        while first < len(grasps) and not late():
            end = first + next(sizes)
            yield from self.screened(grasps.some(slice(first, end)), share)
            first = end

    def wide(self, late: Callable[[], bool]) -> list[Opened]:
        """Grasps of the wide set that may fit, the fingers no narrower than needed; `fitted` tells."""
        found: list[Opened] = []
        grasps = wide_set(self.bar)
        for share in OPENINGS:
            if late():
                break
            some = [(grasp, share) for grasp in self.screened(grasps, share)]
            found += islice((one for one in some if self.fitted(one) is not None), ENOUGH - len(found))
            if len(found) == ENOUGH:
                return [*dict.fromkeys((*found, *(one for one in some if not self._out(one))))]
        return found

    def screened(self, grasps: Grasps, share: float) -> Iterator[Grasp]:
        """Those at which the open hand touches nothing before the container moves, and that may close."""
        numbers, (looked_at, touching) = grasps.numbers.tolist(), self._screened[share]
        if new := [k for k, one in enumerate(numbers) if one not in looked_at and one not in self._never]:
            self._screen(grasps.some(new), share)
        clear = [k for k, one in enumerate(numbers) if one not in touching and one not in self._never]
        return iter(grasps.some(clear)) if clear else iter(())

    def _out(self, opened: Opened) -> bool:
        """Whether it is known that a grasp cannot be closed so."""
        return self._known.get((opened[1], opened[0].index), self._begin) is None

    def _screen(self, grasps: Grasps, share: float) -> None:
        """It is known at which of them the open hand touches something before the container moves."""
        r, p = self.problem.handle_r[0], self.problem.handle_p[0]
        beside = grasps.translations - self.hand.amid * grasps.rotations[:, :, 1]
        tools, found = (r @ grasps.rotations, beside @ r.T + p), np.empty((len(grasps), 2), np.int64)
        seen, margins = self.hand.shapes_seen(share), self._margins[1]
        placing.touching_many(self.hand.shapes, seen, tools, self.room.near, *self._rest, margins, found)
        numbers, (looked_at, touching) = grasps.numbers.tolist(), self._screened[share]
        met = [
            (number, one, other)
            for number, (one, other) in zip(numbers, found.tolist(), strict=True)
            if one >= 0
        ]
        looked_at.update(numbers)
        touching.update(number for number, _, _ in met)
        self.unfit.update((one, other) for _, one, other in met)
        self._never.update(number for number, one, _ in met if one in self.hand.still)

    def fitted(self, opened: Opened) -> Fitted | None:
        """The grasp with its fingers closed on the handle, if they can be and the hand can stay."""
        grasp, share = opened
        key = share, grasp.index
        if key not in self._known:
            self._known[key] = self._swung(grasp, share) if self._closes(grasp) else None
            self.has_room |= self._known[key] is not None
        return self._known[key]

    def _closes(self, grasp: Grasp) -> bool:
        """Whether the hand can be closed on the handle so, and stay there."""
        if grasp.index not in self._closed and grasp.index not in self._never:
            self._close(grasp)
        return grasp.index not in self._never

    def engaged(self, grasp: Grasp) -> bool:
        """Whether fingers that have closed reach over the handle all around, as certification demands."""
        return self._reaches(grasp, self.facing)

    def _reaches(self, grasp: Grasp, facing: float) -> bool:
        """The same, and by faces that look at most so far away from the way in which they close [rad]."""
        hand, closed = self.hand, self._closed[grasp.index]
        tool = self.problem.handle_r[0] @ grasp.rotation, closed[0]
        about = hand.pads, hand.parts, hand.closing, self.room.handle, self._rest[2]
        return fingers.engaged(tool, closed[1], *about, REACH, inward(facing), self._work)

    def known(self, opened: Opened) -> Fitted | None:
        """The same, if it is known."""
        return self._known.get((opened[1], opened[0].index))

    def _close(self, grasp: Grasp) -> None:
        """It is known where the tool is when the hand has closed on the handle, and how far its joints are.

        Or that they can never be closed so, or that the hand could not stay there as the container moves.
        """
        self._never.add(grasp.index)
        hand, scene = self.hand, (self._rest[2], TOUCH, ROUNDS)
        r, p = self.problem.handle_r[0], self.problem.handle_p[0]
        tool = r @ grasp.rotation, r @ self._beside(grasp) + p
        shares = np.zeros(len(hand.closing[1]))
        bar = self.room.handle
        if not fingers.closed(
            tool, shares, hand.sides, hand.parts, hand.closing, bar, *scene, self._work, *self._begin
        ):
            return
        if len(shares) > 1 and _spread(hand.positions(shares)) > hand.limb.gripper.difference:
            return
        held = hand.parts, hand.closing, self.room.always, self._rest, self._margins[0], self._work
        pair = placing.stays(tool, shares, *held)
        if pair[0] >= 0:
            self.unfit[pair] += 1
            return
        self._never.remove(grasp.index)
        self._closed[grasp.index] = tool[1], shares

    def _beside(self, grasp: Grasp) -> Array:
        """Where the tool of the open hand is, in the handle's frame: the bar has room between its fingers."""
        return (
            grasp.translation - self.hand.amid * grasp.rotation[:, 1] if self.hand.amid else grasp.translation
        )

    def _swung(self, grasp: Grasp, share: float) -> Fitted | None:
        """The closed grasp, if the fingers can swing there from where they are closed by a share."""
        hand = self.hand
        handle_r, handle_p = self.problem.handle_r[0], self.problem.handle_p[0]
        place, shares = self._closed[grasp.index]
        start = np.full(len(shares), share)
        margins = self._margins if not hand.amid else (self._margins[0],) * 2
        held = hand.parts, hand.closing, self.room.near, self._rest, margins, self._work
        pair = placing.swings((handle_r @ grasp.rotation, place), shares, start, SWING, *held)
        if pair[0] >= 0:
            self.unfit[pair] += 1
            return None
        there = handle_r.T @ (place - handle_p)
        aside = self._beside(grasp) - there if hand.amid else None
        fingers = hand.positions(shares), hand.opening(share)
        return Grasp(grasp.rotation, there, grasp.index, *fingers, aside), hand.closed(shares)


def _spread(positions: Positions) -> float:
    """By how much positions of finger joints differ at most [rad or m]."""
    at = [each for _, each in positions]
    return max(at) - min(at)
