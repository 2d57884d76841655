"""Heights that two fingers of a hand do not both come to: boxes of arm and finger joints, many at once.

Plain floats: what is found is a tree that `proof_check/pinch` verifies.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.embodiment.proof_check.pinch.fingers import Hand, Part, handle_span
from services.embodiment.proof_check.proof.content import LEAF, Refutation
from services.embodiment.proof_check.statement import Statement
from services.embodiment.prove.arrays import joints

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

FIRST = 40  # postures that are tried first: mostly they tell
POSTURES, LOOKS = 400, 12  # that are tried then, and how often
NEARER, AT_ENDS = 0.6, 0.15  # [1] by which they are nearer each time, and joints that are at a limit
TOGETHER = 1024  # boxes that are looked at at once
SLACK = 1e-7  # [m] by which fingers are apart so that the check finds so too
MOST = 24_000  # nodes of a tree
NARROW, LESS = 1e-3, 1e-3  # [m] a finger so near to reaching is looked at last: [1] it counts as much
TINY = 1e-300  # in place of 0, by which nothing can be divided
FINEST = 1e-5  # [m] a box in which a finger moves by no more is not halved


@dataclass(frozen=True, slots=True, eq=False)
class _Arrays:
    """Part of a finger as plain arrays: pieces are rotations, middles, half extents, and which are round."""

    part: Part
    rotations: Array
    translations: Array
    axes: Array
    turns: NDArray[np.bool_]
    pieces: tuple[Array, Array, Array, NDArray[np.bool_]]


class Search:
    """Boxes of one hand that are refuted, or halved, until none is left.

    Args:
        hand: Whose fingers they are.
        span: Heights that two fingers have to come to, the least and the most [m].
    """

    def __init__(self, hand: Hand, span: tuple[float, float]) -> None:
        self._hand, self._span = hand, span
        self._driven = np.isin(np.arange(len(hand.names)), hand.driven[0])
        self._fingers = [[_arrays(part) for part in finger] for finger in hand.fingers]
        self.low, self.high = hand.low[None], hand.high[None]
        self._below: list[tuple[int, int]] = [(0, 0)]
        self._node: list[int] = [0]

    def tree(self) -> bytes | None:
        """The tree in preorder; None if two fingers come there, or nodes are spent."""
        if self._reached():
            return None
        stack = [(self.low, self.high, np.zeros(1, dtype=np.intp))]
        while stack:
            low, high, at = stack.pop()
            if len(at) > TOGETHER:
                stack.append((low[TOGETHER:], high[TOGETHER:], at[TOGETHER:]))
                low, high, at = low[:TOGETHER], high[:TOGETHER], at[:TOGETHER]
            named, split = self._look(low, high)
            if (split < -1).any() or len(self._node) + 2 * (split >= 0).sum() > MOST:
                return None
            for one, name in zip(at[named >= 0].tolist(), named[named >= 0].tolist(), strict=True):
                self._node[one] = LEAF + name
            if (further := split >= 0).any():
                stack.append(self._halved(low[further], high[further], at[further], split[further]))
        return self._written()

    def _reached(self) -> bool:
        """Whether two fingers come there in some posture: random ones, then nearer to the best of them."""
        rng, (low, high) = np.random.default_rng(0), (self._hand.low, self._hand.high)
        best, still = (low + high) / 2, np.zeros(len(low))
        for k, count in enumerate((FIRST, *[POSTURES] * LOOKS)):
            shape = count, len(low)
            drawn = best + rng.normal(size=shape) * (high - low) * NEARER ** max(k - 1, 0)
            ends = np.where(rng.random(shape) < 0.5, low, high)
            drawn = np.where(rng.random(shape) < AT_ENDS, ends, drawn).clip(low, high)
            drawn[0] = best
            apart = np.stack([self._nearest(one, drawn, still[None])[1] for one in self._fingers])
            second = np.where(self._hand.differ(drawn, drawn) > 0, np.inf, np.sort(apart, axis=0)[1])
            best = drawn[np.argmin(second)]
            if second.min() <= SLACK:
                return True
        return False

    def _halved(self, low: Array, high: Array, at: Indices, split: Indices) -> tuple[Array, Array, Indices]:
        """Both halves of boxes, the nodes of which name the joint and where these come."""
        every, count = np.arange(len(at)), len(self._node)
        middles = (low[every, split] + high[every, split]) / 2
        upper_low, lower_high = low.copy(), high.copy()
        upper_low[every, split], lower_high[every, split] = middles, middles
        for k, (one, joint) in enumerate(zip(at.tolist(), split.tolist(), strict=True)):
            self._node[one] = joint
            self._below[one] = count + k, count + len(at) + k
        self._node += [0] * (2 * len(at))
        self._below += [(0, 0)] * (2 * len(at))
        return np.vstack((low, upper_low)), np.vstack((lower_high, high)), count + np.arange(2 * len(at))

    def _written(self) -> bytes:
        """Nodes in preorder, the lower half first."""
        stack, written = [0], bytearray()
        while stack:
            one = stack.pop()
            written.append(self._node[one])
            if self._node[one] < LEAF:
                stack += self._below[one][::-1]
        return bytes(written)

    def _look(self, low: Array, high: Array) -> tuple[Indices, Indices]:
        """What a box names or −1; the joint to halve, −1 for none, −2 where two fingers reach."""
        at, half = (low + high) / 2, (high - low) / 2
        found = [self._nearest(finger, at, half) for finger in self._fingers]
        apart, there, ways = (np.stack([one[k] for one in found]) for k in range(3))
        every = np.arange(len(at))
        nearly = np.where(ways.max(axis=2) > FINEST, _nearly(there, apart), -np.inf)
        nearly = np.where(there < NARROW, LESS * nearly, nearly)
        second = np.argsort(nearly, axis=0, kind="stable")[1]
        even, uneven = self._hand.differ(at, at), self._hand.differ(low, high)
        named = np.where(np.sort(apart, axis=0)[1] > SLACK, np.argmin(apart, axis=0), -1)
        named = np.where(uneven > 0, len(self._fingers), named)
        nearest, motor = nearly[second, every], _nearly(even, uneven)
        way = np.where((motor > nearest)[:, None], half * self._driven, ways[second, every])
        split = np.where(np.maximum(motor, nearest) > 0, np.argmax(way, axis=1), -2)
        return named, np.where(named >= 0, -1, split)

    def _nearest(self, finger: list[_Arrays], at: Array, half: Array) -> tuple[Array, Array, Array]:
        """The same as of a part, of that which comes nearest."""
        found = [self._apart(part, at, half) for part in finger]
        apart, there, ways = (np.stack([one[k] for one in found]) for k in range(3))
        worst, every = np.argmin(apart, axis=0), np.arange(len(at))
        return apart[worst, every], there.min(axis=0), ways[worst, every]

    def _apart(self, one: _Arrays, at: Array, half: Array) -> tuple[Array, Array, Array]:
        """How far a part is from the span in all of a box, in its middle, and what each variable adds.

        That is told of the piece that comes nearest, shapes (L,), (L,) and (L, m) [m].
        """
        q, widths = one.part.joints(at, half)
        origins, axes, turn, place = _frames(one, q)
        turns, placed, sizes, round_ = one.pieces
        heights = turn[:, 2] @ placed.T + place[:, None, 2]
        up = np.einsum("li,pij->lpj", turn[:, 2], turns)
        boxes = (np.abs(up) * sizes).sum(axis=2)
        disc = np.hypot(up[..., 0], up[..., 1]) * sizes[:, 0] + np.abs(up[..., 2]) * sizes[:, 2]
        reach = np.where(round_, disc, boxes)
        points = np.einsum("lij,pj->lpi", turn, placed) + place[:, None]
        low, high = heights - reach, heights + reach
        there = np.maximum(self._span[0] - high, low - self._span[1])
        if half.any():
            moved = self._moved(one, (origins, axes, widths), points, (turn, turns, sizes))
        else:  # of single postures
            moved = np.zeros((*points.shape[:2], len(one.turns)))
        total = there - moved.sum(axis=2)
        worst, every = np.argmin(total, axis=1), np.arange(len(at))
        ways = moved[every, worst] @ np.abs(one.part.rates)
        return total[every, worst], there.min(axis=1), ways

    def _moved(
        self,
        one: _Arrays,
        joints: tuple[Array, Array, Array],
        points: Array,
        boxes: tuple[Array, Array, Array],
    ) -> Array:
        """How far each joint moves each piece up or down at most, shape (L, P, n) [m]; as `Swing.along`."""
        origins, axes, widths = joints
        turn, turns, sizes = boxes
        arms = points[:, :, None] - origins[:, None]
        moves = np.cross(axes[:, None], arms)
        radius = np.linalg.norm(sizes, axis=1)[None, :, None]
        across = np.cross([0.0, 0.0, 1.0], axes) @ turn
        seen = np.abs(np.einsum("lni,pij->lnpj", across, turns))
        first = np.abs(moves[..., 2]) + np.einsum("lnpj,pj->lpn", seen, sizes)
        whole = np.where(one.turns, np.linalg.norm(moves, axis=3) + radius, 1.0)
        behind = np.arange(len(one.turns)) >= self._hand.upright
        angles = np.where(one.turns & behind, widths, 0.0)
        before = np.cumsum(angles, axis=1) - angles
        second = whole * (angles / 2 + before)[:, None]
        ways = np.minimum(whole, np.where(one.turns, first, np.abs(axes[:, None, :, 2])) + second)
        lifts = np.where(one.turns, 0.0, np.abs(axes[..., 2]))[:, None]
        ways = np.where(behind, ways, lifts)
        return ways * widths[:, None]


def _nearly(amid: Array, all_along: Array) -> Array:
    """How nearly boxes are refuted by what is so much apart amid them and so much in all of them [1]."""
    gap, least = (np.where(amid > 0, one, 0.0) for one in (amid, all_along))
    return np.where(amid > 0, gap / np.maximum(gap - least, TINY), -np.inf)


def _frames(one: _Arrays, q: Array) -> tuple[Array, Array, Array, Array]:
    """Origins and axes of the joints (L, n, 3), rotation and place of the finger, in the middles of boxes."""
    count, n = q.shape
    origins, axes = np.empty((2, count, n, 3))
    turn, place = np.tile(np.eye(3), (count, 1, 1)), np.zeros((count, 3))
    for k in range(n):
        place = place + turn @ one.translations[k]
        turn = turn @ one.rotations[k]
        axes[:, k] = turn @ one.axes[k]
        if one.turns[k]:
            turn = turn @ _turned(one.axes[k], q[:, k])
        else:
            place = place + axes[:, k] * q[:, k, None]
        origins[:, k] = place
    end = one.part.chain.end
    return origins, axes, turn @ end.rotation.middle, place + turn @ end.translation.middle


def _turned(axis: Array, angle: Array) -> Array:
    """Rotations about a unit axis, shape (L, 3, 3)."""
    x, y, z = axis
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sine, versine = np.sin(angle)[:, None, None], (1 - np.cos(angle))[:, None, None]
    return np.eye(3) + sine * skew + versine * (skew @ skew)


def _arrays(part: Part) -> _Arrays:
    pieces = part.pieces
    return _Arrays(
        part,
        *joints(part.chain),
        (
            np.array([one.box.middle.rotation.middle for one in pieces]),
            np.array([one.box.middle.translation.middle for one in pieces]),
            np.array([one.box.half for one in pieces]),
            np.array([one.round for one in pieces]),
        ),
    )


def by_fingers(statement: Statement, hand: Hand, value: float) -> Refutation | None:
    """A refutation of one gripper at a value of the container: no two fingers come to the handle together."""
    target = statement.target(value)
    if not len(target.boxes):
        return None
    near, (lowest, highest) = statement.near(hand, value), handle_span(target)
    tree = Search(hand, (lowest - near, highest + near)).tree()
    if tree is None:
        return None
    box = tuple(zip(hand.low.tolist(), hand.high.tolist(), strict=True))
    return Refutation(hand.gripper, value, hand.names, box, tree, pinched=True)
