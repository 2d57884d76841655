"""Kinematics from the twin's mechanisms alone, in interval arithmetic: chains from the world to a frame."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import RobotAnnotation
from sdt_kg.mechanism import Joint, JointType, Mechanism, Pose
from services.embodiment.proof_check.geometry.interval import Interval, apply, cross, exact, times, turning

Array = NDArray[np.float64]

TURN = 1e-12  # [rad] more than sums of angles are off by
SHORTER = 1 - 1e-12  # [1] so that no direction is longer than 1


@dataclass(frozen=True, slots=True, eq=False)
class Placement:
    """a_T_b as intervals: rotation (…, 3, 3), translation (…, 3) [m]."""

    rotation: Interval
    translation: Interval

    def __matmul__(self, other: "Placement") -> "Placement":
        return Placement(
            times(self.rotation, other.rotation),
            apply(self.rotation, other.translation) + self.translation,
        )

    def some(self, chosen: NDArray[np.intp]) -> "Placement":
        """Those of several."""
        return Placement(self.rotation[chosen], self.translation[chosen])

    def inverse(self) -> "Placement":
        """b_T_a."""
        back = self.rotation.T
        moved = apply(back, self.translation)
        return Placement(back, Interval(-moved.hi, -moved.lo))


HERE = Placement(exact(np.eye(3)), exact(np.zeros(3)))


@lru_cache(maxsize=4096)
def placement(pose: Pose) -> Placement:
    """A pose of the graph; its quaternion is taken as it is written."""
    x, y, z, w = (exact(each) for each in pose.orientation)
    one, two = exact(1.0), exact(2.0)
    rows = (
        (one - two * (y * y + z * z), two * (x * y - z * w), two * (x * z + y * w)),
        (two * (x * y + z * w), one - two * (x * x + z * z), two * (y * z - x * w)),
        (two * (x * z - y * w), two * (y * z + x * w), one - two * (x * x + y * y)),
    )
    rotation = Interval(
        np.array([[each.lo for each in row] for row in rows]),
        np.array([[each.hi for each in row] for row in rows]),
    )
    return Placement(rotation, exact(pose.position))


@dataclass(frozen=True, slots=True, eq=False)
class Link:
    """A movable joint of a chain.

    Attributes:
        name: Of the joint.
        before: Where the joint's frame sits in that of the one before, at position 0.
        axis: Unit vector, in its own frame.
        turns: Whether it is a hinge.
        lower, upper: Positions that certification lets it have [rad or m].
    """

    name: str
    before: Placement
    axis: Array
    turns: bool
    lower: float
    upper: float


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """Joints from the world to a frame, and where that frame sits in the last of them."""

    links: tuple[Link, ...]
    end: Placement

    def ranges(self) -> tuple[Array, Array]:
        """Lower and upper ends of all positions of its joints [rad or m], shape (n,) each."""
        return np.array([link.lower for link in self.links]), np.array([link.upper for link in self.links])

    def frames(self, q: Array) -> tuple[Interval, Interval, Placement]:
        """Origins and axes of the joints at exact positions q (L, n), shapes (L, n, 3), and the frame.

        The origin is that of the joint's frame after its own motion.
        """
        count = len(q)
        at = Placement(exact(np.tile(np.eye(3), (count, 1, 1))), exact(np.zeros((count, 3))))
        origins: list[Interval] = []
        axes: list[Interval] = []
        for k, link in enumerate(self.links):
            at = at @ link.before
            axis = apply(at.rotation, exact(link.axis))
            if link.turns:
                at = Placement(times(at.rotation, turning(link.axis, q[:, k])), at.translation)
            else:
                at = Placement(at.rotation, at.translation + axis * exact(q[:, k, None]))
            origins.append(at.translation)
            axes.append(axis)
        return _stacked(origins, count), _stacked(axes, count), at @ self.end

    def swing(self, middle: Array, half: Array) -> "tuple[Placement, Swing]":
        """Where the end is in the middles of boxes of positions, and how the joints carry it from there.

        Args:
            middle: Of the boxes, shape (L, n).
            half: From the middle to the ends of a box [rad or m], shape (L, n).
        """
        origins, axes, at = self.frames(middle)
        turns = np.array([link.turns for link in self.links], dtype=np.bool_)
        return at, Swing(origins, axes, half, turns)


@dataclass(frozen=True, slots=True, eq=False)
class Swing:
    r"""L boxes of positions of n joints, and where these are in the boxes' middles.

    Along a fixed unit direction d, from the middle of a box of joint positions, with joint j moved by at most
    :math:`h_j`, a point p moves by at most the sum over the joints of

    .. math:: h_j \min(l_j,\; |d \cdot (a_j \times (p - o_j))| + l_j (h_j / 2 + \sum_{i < j} h_i)),

    where :math:`a_j` and :math:`o_j` are the joint's axis and origin in the middle,
    :math:`l_j = |a_j \times (p - o_j)|`, and i are the hinges before j: a turn by h is its first-order part
    to within :math:`l_j h^2 / 2`, and what is before the joint has turned the whole of it by no more than
    the sum of these angles.

    Attributes:
        origins, axes: Of the joints, shape (L, n, 3).
        half: From the middle to the ends of a box [rad or m], shape (L, n).
        turns: Which joints are hinges, shape (n,).
        upright: How many of the first joints only lift and turn about the vertical, where heights count.
    """

    origins: Interval
    axes: Interval
    half: Array
    turns: NDArray[np.bool_]
    upright: int = 0

    def some(self, chosen: NDArray[np.intp]) -> "Swing":
        """Those boxes of several."""
        return Swing(self.origins[chosen], self.axes[chosen], self.half[chosen], self.turns, self.upright)

    def of(self, joints: slice, upright: int = 0) -> "Swing":
        """Some of the joints, of which so many are first ones that only lift and turn about the vertical."""
        parts = self.origins[:, joints], self.axes[:, joints], self.half[:, joints]
        return Swing(*parts, self.turns[joints], upright)

    def along(self, d: Array, at: Placement, own: Array) -> Array:
        """How far points of boxes, which all joints carry, move along directions at most [m], shape (L,).

        Args:
            d: Directions no longer than 1, shape (L, 3).
            at: Where the boxes are, L of them.
            own: Their half extents [m], shape (3,).
        """
        ways = exact(d)[:, None]
        moves, whole = self._levers(at, own)
        first = (ways * moves).total().magnitude().hi
        if own.any():
            across = apply(at.rotation.T[:, None], cross(ways, self.axes)).magnitude()
            first = (exact(first) + (across * exact(own)).total()).hi
        slid = (ways * self.axes).total().magnitude().hi
        arms = np.minimum(whole, np.where(self.turns, first, slid) + self._second(whole))
        lifts = np.where(self.turns, 0.0, self.axes[..., 2].magnitude().hi)
        arms = np.where(np.arange(len(self.turns)) < self.upright, lifts, arms)
        return (arms * self.half).sum(axis=1) * (1 + 1e-12)

    def turned(self, d: Array, u: Interval) -> Array:
        """How much products of u, which all joints turn, and d change at most [1], shape (L,).

        As `along` of a point that is one unit from each hinge.

        Args:
            d: Directions no longer than 1, shape (L, 3).
            u: Directions, shape (L, 3).
        """
        moves = cross(self.axes, u[:, None])
        whole, first = moves.norm().hi, (exact(d)[:, None] * moves).total().magnitude().hi
        angles = np.where(self.turns, self.half, 0.0)
        return (np.minimum(whole, first + self._second(whole)) * angles).sum(axis=1) * (1 + 1e-12)

    def _second(self, whole: Array) -> Array:
        """What is beyond first order for a unit of each joint, that moves something by `whole`, (L, n)."""
        angles = np.where(self.turns, self.half, 0.0)
        before = np.cumsum(angles, axis=1) - angles
        return whole * (angles / 2 + before + TURN) * (1 + 1e-12)

    def whole(self, at: Placement, own: Array) -> Array:
        """How far points of boxes, which all joints carry, move at most, wherever to [m], shape (L,)."""
        _, levers = self._levers(at, own)
        return (levers * self.half).sum(axis=1) * (1 + 1e-12)

    def _levers(self, at: Placement, own: Array) -> tuple[Interval, Array]:
        """How middles of boxes move for a unit of each hinge, and how far all of them for one of each joint.

        Shapes (L, n, 3) and (L, n).
        """
        moves, radius = cross(self.axes, at.translation[:, None] - self.origins), float(np.linalg.norm(own))
        return moves, np.where(self.turns, moves.norm().hi + radius * (1 + 1e-12), 1.0)

    def seen(self, points: Interval, at: Placement) -> Array:
        """How far points of the world move at most, as what all joints carry sees them [m], shape (L, 3).

        Each joint's share is then turned by what the joints behind it turn.

        Args:
            points: Shape (L, 3).
            at: Where what sees them is, L placements; its axes are those along which is told.
        """
        arms, turns = cross(self.axes, points[:, None] - self.origins), self.turns[:, None]
        whole = np.where(self.turns, arms.norm().hi, 1.0)
        back = at.rotation.T[:, None]
        first = np.where(turns, apply(back, arms).magnitude().hi, apply(back, self.axes).magnitude().hi)
        angles = np.where(self.turns, self.half, 0.0)
        behind = np.cumsum(angles[:, ::-1], axis=1)[:, ::-1] - angles
        second = whole * (angles / 2 + behind + TURN) * (1 + 1e-12)
        ways = np.minimum(whole[:, :, None], first + second[:, :, None])
        return (ways * self.half[:, :, None]).sum(axis=1) * (1 + 1e-12)


def _stacked(parts: list[Interval], count: int) -> Interval:
    if not parts:
        return exact(np.zeros((count, 0, 3)))
    return Interval(np.stack([one.lo for one in parts], axis=1), np.stack([one.hi for one in parts], axis=1))


class Tree:
    """A mechanism by body: the joint above each."""

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism
        self.above: dict[str, Joint] = {joint.child: joint for joint in mechanism.joints}

    def path(self, body: str, ancestor: str | None = None) -> list[Joint]:
        """Joints from an ancestor (the root) to the body, in order."""
        joints: list[Joint] = []
        while body in self.above and body != ancestor:
            joints.append(self.above[body])
            body = self.above[body].parent
        return joints[::-1]

    def carrier(self, body: str) -> str:
        """The nearest body above that is moved by a joint, or the root: this one is fixed to it."""
        while body in self.above and self.above[body].type is JointType.FIXED:
            body = self.above[body].parent
        return body

    def chain(self, joints: list[Joint], first: Placement, slack: float) -> Chain:
        """The joints as a chain behind a placement, each anywhere in its limits, widened by slack."""
        links: list[Link] = []
        at = first
        for joint in joints:
            at = at @ placement(joint.origin)
            if joint.type is JointType.FIXED:
                continue
            lower, upper = self.limits(joint)
            turns = joint.type is not JointType.PRISMATIC
            if not math.isfinite(lower) or not math.isfinite(upper):
                lower, upper = (-ROUND, ROUND) if turns else (-math.inf, math.inf)
            links.append(Link(joint.name, at, np.array(joint.axis), turns, lower - slack, upper + slack))
            at = HERE
        return Chain(tuple(links), at)

    def limits(self, joint: Joint) -> tuple[float, float]:
        """Position limits of a joint [rad or m]; infinite where it has none."""
        if joint.type is JointType.CONTINUOUS:
            return -math.inf, math.inf
        return joint.limits.lower, joint.limits.upper


ROUND = 3.1416  # [rad] a little more than half a turn: a joint without limits repeats itself


def base_T_root(tree: Tree, annotation: RobotAnnotation) -> Placement:
    """Where the robot's root sits in the base's frame."""
    root_T_base = HERE
    for joint in tree.path(annotation.base_body):
        root_T_base = root_T_base @ placement(joint.origin)
    return root_T_base.inverse()
