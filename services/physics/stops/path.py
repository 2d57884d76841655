"""One container on its way: which shapes it may meet, and where it is too deep in one of them.

Each pair of shapes is followed from the present state outwards, by steps no longer than they may come nearer,
so that nothing is jumped over; where they are nearly too deep, by steps shorter than the allowance.
"""

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations, pairwise

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # found through a .pth file

from sdt_kg.iri import Iri
from sdt_kg.mechanism import Joint, JointType
from sdt_kg.state import State
from services.physics.geometry.bodies import BodyShape
from services.physics.stops.bearing import Bearing
from services.physics.stops.block import Block
from services.physics.stops.course import Course, seen
from services.physics.stops.passing import Boxes, Way, may_meet
from services.physics.stops.rest import ALLOWANCE, gap_between, placed
from services.physics.stops.shapes import Shapes
from services.physics.stops.slide import Meshes, Placed, free_way
from services.physics.tree import Array, Indices, Model

THIN_SHARE = 0.25
"""[1] Share of the two shapes' summed thickness that the allowance never exceeds: half of it is all the
depth that a thin shape reaches when it passes right through another. Triangles have no thickness."""

THROUGH = 0.45
"""[1] Share of that at which one has nearly passed right through the other."""

TOUCH = -1e-5
"""[m] What is allowed of two meshes of triangles, which have no depth in each other: they may not come so
near. It is their shortest step, too, on which neither passes through the other."""

GRAZES = 1e-6
"""[m] By how much more than is allowed shapes are in each other that are too deep: more than rounding. A
drawer may slide all along as deep as it was drawn."""

REST_FACTOR = 2.0
"""[1] How many times their depth at rest two shapes may have which overlap with every joint at its start
position: the model made them so. The bottom drawer of kitchen `a` lies 17 mm deep in a bar below it
and 34 mm when pulled."""

LEAST_STEP = 5e-4
"""[m] Shortest step of a shape's fastest point."""

STEP_SHARE = 0.05
"""[1] Of two thin shapes' summed thickness that this step never exceeds: on no more than a tenth of it is one
deeper in the other than `THROUGH` when it passes right through."""

PARTS = 16
"""[1] Of a way, on each of which boxes around the shapes are compared first."""


class Path:
    """One actuated joint on its way, all others resting.

    Attributes:
        passed: Pairs that were followed to the end, deeper in each other than they may be that were not drawn
            so; where they are deepest, as far as it was looked at.
    """

    def __init__(self, model: Model, bearing: Bearing, state: State, active: Iri, end: float) -> None:
        self._bearing, self._rest = bearing, bearing.rest
        self._model, self._k = model, model.coordinate[active]
        self._speeds: dict[int, float] = {}
        self.passed: list[Block] = []
        q = np.zeros(model.model.nq)
        for joint, value in state.positions:
            if joint in model.coordinate:
                q[model.coordinate[joint]] = value
        self._begin, self._end = float(q[self._k]), end
        q[self._k] = 0.0
        self._still = model.coupling.positions(q)
        self._rate = model.coupling.rates(np.eye(model.model.nq)[self._k])
        joints, sources = range(1, model.model.njoints), model.coupling.source.tolist()
        self._follows = {i for i in joints if sources[model.model.idx_qs[i]] == self._k}
        self._moving = {i for i in joints if not self._follows.isdisjoint(model.model.supports[i].tolist())}
        self._way = self._only_way() if len(self._follows) == 1 else None

    def _frames(self, position: float) -> list[pin.SE3]:
        """world_T_joint of every joint: one list, valid until the next call."""
        return self._model.placements.move(self._still + position * self._rate)

    def near(self, shapes: Shapes) -> Iterator[tuple[BodyShape, BodyShape, float]]:
        """Pairs of a moved and a resting shape whose boxes may meet on the way, and until where they may."""
        moves = np.isin(shapes.joint, list(self._moving))
        moved, resting = np.flatnonzero(moves), np.flatnonzero(~moves)
        if not len(moved) or not len(resting):
            return
        step = (self._end - self._begin) / PARTS
        middles = np.linspace(self._begin + step / 2, self._end - step / 2, PARTS)
        boxes, still = self._boxes(shapes, moved, middles), self._boxes(shapes, resting, middles[:1])
        (below, above), (low, high) = boxes.corners(), still.corners()
        pad = np.array([self._speed(shapes.all[k]) for k in moved.tolist()])[:, None] * abs(step) / 2
        reach = ((below.min(axis=0) - pad)[:, None] <= high).all(2)
        reach &= ((above.max(axis=0) + pad)[:, None] >= low).all(2)
        one, other = np.nonzero(reach)
        least = np.full(len(one), TOUCH)  # at least: which are triangles is known once they are made
        meet = np.ones((PARTS, len(one)), dtype=bool)
        if self._way is not None:
            meet = may_meet(self._way, abs(step) / 2, boxes.where(one), still.where(other), least)
        for n in np.flatnonzero(meet.any(axis=0)):
            pair = shapes.all[int(moved[one[n]])], shapes.all[int(resting[other[n]])]
            last = int(np.flatnonzero(meet[:, n])[-1]) + 1
            until = self._end if last == PARTS else self._begin + step * last
            yield from ((*each, until) for each in self._stopping(*pair))

    def _stopping(self, one: BodyShape, other: BodyShape) -> Iterator[tuple[BodyShape, BodyShape]]:
        """What of a moved and a resting shape may not meet."""
        stopping = self._bearing.stopping(one, other)
        if stopping is not None:
            yield one, stopping
        if stopping is not other:
            yield from ((core, other) for core in self._bearing.cores(one, other))

    def together(self, shapes: Shapes) -> Iterator[tuple[BodyShape, BodyShape]]:
        """Pairs of shapes that move, each in its own way, as two leaves do of which one follows the other."""
        if len(self._follows) == 1:
            return
        supports = self._model.model.supports
        ways = [frozenset(self._follows.intersection(supports[each.joint].tolist())) for each in shapes.all]
        moved = [(each, way) for each, way in zip(shapes.all, ways, strict=True) if way]
        for (one, way), (other, another) in combinations(moved, 2):
            if way != another:
                pair = self._bearing.stopping(other, one), self._bearing.stopping(one, other)
                if pair[0] is not None and pair[1] is not None:
                    yield pair[0], pair[1]
                if pair[1] is not other:
                    yield from ((core, other) for core in self._bearing.cores(one, other))
                if pair[0] is not one:
                    yield from ((one, core) for core in self._bearing.cores(other, one))

    def _only_way(self) -> Way:
        """The way of the only joint that moves, whose axis rests."""
        (joint,) = self._follows
        coordinate = self._model.model.idx_qs[joint]
        own, frame = self._joint(coordinate), self._frames(self._begin)[joint]
        axis = np.array(own.axis)
        ratio = float(self._model.coupling.multiplier[coordinate])
        return Way(
            frame.rotation @ (axis / np.linalg.norm(axis)),
            frame.translation.copy(),
            own.type is JointType.PRISMATIC,
            ratio * float(np.sign(self._end - self._begin)),
        )

    def _course(self, one: BodyShape, other: BodyShape) -> Course | None:
        """The moved shape's on its way past the resting one; None where it is not told by their corners."""
        corners, against = one.piece.corners, other.piece.corners
        if self._way is None or not len(corners) or not len(against):
            return None
        frames = self._frames(self._begin)
        corners = seen(frames[one.joint] * one.pose, corners)
        return Course(self._way, corners, seen(frames[other.joint] * other.pose, against))

    def _boxes(self, shapes: Shapes, some: Indices, positions: Array) -> Boxes:
        """Those about some shapes with the actuated joint at each position, shape (N, S)."""
        joints, index = np.unique(shapes.joint[some], return_inverse=True)
        turns, at = np.empty((len(positions), len(joints), 3, 3)), np.empty((len(positions), len(joints), 3))
        for n, position in enumerate(positions):
            frames = self._frames(float(position))
            for k, joint in enumerate(joints.tolist()):
                turns[n, k], at[n, k] = frames[joint].rotation, frames[joint].translation
        turn = turns[:, index]
        middle = (turn @ shapes.centre[some][:, :, None])[..., 0] + at[:, index]
        return Boxes(turn @ shapes.rotation[some], middle, np.broadcast_to(shapes.half[some], middle.shape))

    def _speed(self, one: BodyShape) -> float:
        """Bound of the speed of the shape's points [m per unit of the actuated joint], kept."""
        if id(one) not in self._speeds:
            self._speeds[id(one)] = self._fastest(one)
        return self._speeds[id(one)]

    def _fastest(self, one: BodyShape) -> float:
        total, slid = 0.0, 0.0
        pinocchio, frames = self._model.model, self._frames(self._begin)
        supports = [i for i in pinocchio.supports[one.joint].tolist() if i in self._follows]
        points = [frames[i].translation.copy() for i in supports] + [frames[one.joint].act(one.centre)]
        arm = one.radius
        for i, (a, b) in reversed(list(zip(supports, pairwise(points), strict=True))):
            coordinate = pinocchio.idx_qs[i]
            rate = abs(float(self._model.coupling.multiplier[coordinate]))
            arm += float(np.linalg.norm(b - a))
            if self._joint(coordinate).type is JointType.PRISMATIC:
                total, slid = total + rate, slid + rate * abs(self._end - self._begin)
            else:
                total += rate * (arm + slid)
        return total

    def _joint(self, coordinate: int) -> Joint:
        part = self._model.part
        return part.joints[coordinate - part.first]

    def _placed(self, one: BodyShape, position: float) -> coal.Transform3s:
        """Where a shape is with the actuated joint at a position."""
        return placed(self._frames(position)[one.joint] * one.pose)

    def followed(self, one: BodyShape, other: BodyShape, end: float, until: float) -> Block | None:
        """The first position up to `end` at which the two are too deep in each other; none after `until`.

        Two meshes of triangles that touch where they were fitted together do not tell how deep they are: of
        the second what is farther away there is followed. Where they touch elsewhere at the beginning they
        have to come apart at once; they stop before they do, not to go on from there through each other.
        """
        least = _least(one, other)
        if least == TOUCH and self._rest.touch(one, other, -TOUCH):
            away = self._bearing.away(other, one)
            if away is None:
                return None
            other = away
        direction, speed = np.sign(end - self._begin), self._speed(one) + self._speed(other)
        moves, against = other.joint in self._moving, self._placed(other, self._begin)
        drawn = self._rest.depth(one, other) if least != TOUCH else 0.0
        allowed, shortest = self._allowed(one, other, least, drawn)
        position = before = self._begin
        deepest = Block(position, least, allowed, one.body, other.body, drawn)
        course, grazes = (None, 0.0) if least == TOUCH else (self._course(one, other), GRAZES)
        while speed > 0:
            against = self._placed(other, position) if moves else against
            at = self._placed(one, position)
            gap, toward = gap_between(one, at, other, against)
            deep = gap < -allowed - grazes
            if deep and not (least == TOUCH and position == self._begin):
                return replace(deepest, position=before if least == TOUCH else position, depth=-gap)
            deepest = self._deeper(deepest, position, -gap)
            if position == end or (until - position) * direction <= 0:
                self.passed += [deepest] if deepest.depth > least else []
                return None
            # On a way of this length they do not come to be too deep, however fast they come nearer.
            room = gap + allowed
            if least == TOUCH:
                shapes = one.piece.shape, other.piece.shape
                room = self._apart(shapes, (at, against), gap, abs(end - position))
            step = max(room, shortest) / speed
            if course is not None:
                step = max(step, course.free(abs(position - self._begin), toward, allowed + 2 * grazes))
            ahead = position + direction * step
            before, position = position, end if (end - ahead) * direction <= 0 else float(ahead)
        return None

    def _deeper(self, deepest: Block, position: float, depth: float) -> Block:
        """The deeper one of two places on the way, of which its beginning is none."""
        if position == self._begin or depth <= deepest.depth:
            return deepest
        return replace(deepest, position=position, depth=depth)

    def _apart(self, meshes: Meshes, at: Placed, gap: float, far: float) -> float:
        """How far the first goes on [m] before it comes too near the second, or is apart from it again."""
        if gap < -TOUCH:
            return 2 * LEAST_STEP
        if gap > LEAST_STEP or self._way is None or not self._way.slides:
            return gap + 2 * TOUCH
        return free_way(meshes, at, far * self._way.rate * self._way.axis, -TOUCH)

    def _allowed(self, one: BodyShape, other: BodyShape, least: float, deep: float) -> tuple[float, float]:
        """[m] How deep shapes may be that were fitted so `deep` in each other, and the step by which they go.

        Where one is ahead of the other, never so deep as to pass right through.
        """
        if least == TOUCH:
            return least, -least
        thickness = _thickness(one, other)
        allowed, through = least + REST_FACTOR * deep, THROUGH * thickness
        shortest = min(LEAST_STEP, STEP_SHARE * thickness)
        if deep and allowed > through and self._rest.is_ahead(one, other):
            return max(through, deep + shortest), shortest
        return allowed, max(least / 2, shortest)


def _least(one: BodyShape, other: BodyShape) -> float:
    """[m] How deep the shapes may be in each other, wherever they are."""
    thickness = _thickness(one, other)
    return min(ALLOWANCE, THIN_SHARE * thickness) if thickness else TOUCH


def _thickness(one: BodyShape, other: BodyShape) -> float:
    """[m] Of both together; 0 of two that are triangles."""
    pieces = (each.piece for each in (one, other))
    return sum(each.thickness for each in pieces if not isinstance(each.shape, coal.BVHModelBase))
