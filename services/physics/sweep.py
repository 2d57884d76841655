"""Where a moving part of the kitchen meets the rest of it.

The container stops where it meets another body. Each pair of a moved and a resting shape is followed
from the present state outwards: while apart, by steps no longer than their distance allows, so that
nothing is jumped over; while touching, by steps shorter than the allowance.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # found through a .pth file

from sdt_kg.iri import Iri, body_iri
from sdt_kg.mechanism import JointType, Limits, Mechanism
from sdt_kg.state import State
from services.physics.geometry.pieces import pieces
from services.physics.tree import Array, Model, se3

ALLOWANCE = 0.01
"""[m] How much deeper than in the present state a moved shape may sink into another: the doors of
the bundled kitchens and of their sources turn up to 9 mm into the edges of their neighbours."""

THIN_SHARE = 0.25
"""[1] Share of the two shapes' summed thickness that the allowance never exceeds: half of it is all the
depth that a thin shape reaches when it passes right through another."""

REST_FACTOR = 2.0
"""[1] How many times their depth at rest two shapes may have which overlap with every joint at its start
position: the model made them so. The bottom drawer of kitchen `a` lies 17 mm deep in a bar below it
and 34 mm when pulled."""

KEPT = 4096
"""[1] Answers that are kept."""

LEAST_STEP = 5e-4
"""[m] Shortest step of a shape's fastest point."""

GRID = 17
"""[1] Positions at which boxes around the shapes are compared first."""


@dataclass(frozen=True, slots=True)
class Block:
    """The first position of the actuated joint at which two bodies are too deep in each other.

    Attributes:
        position: Of the actuated joint [rad or m].
        depth: [m] How deep they are there.
        allowed: [m] How deep they may be.
    """

    position: float
    depth: float
    allowed: float
    moved: Iri
    other: Iri


@dataclass(frozen=True, slots=True, eq=False)
class _Shape:
    body: Iri
    parent: Iri | None
    mount: frozenset[Iri]
    joint: int
    pose: pin.SE3
    shape: coal.CollisionGeometry
    rotation: Array
    centre: Array
    half: Array
    radius: float
    thickness: float


class Sweep:
    """The kitchen's shapes, for questions about what moves into what."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self._shapes = tuple(_shapes(model))
        self._rest = _Rest(model, self._shapes)
        self._known: dict[tuple[State, Iri, float], Block | None] = {}

    def first_block(self, state: State, active: Iri, end: float) -> Block | None:
        """Where the actuated joint is stopped on its way from the state to `end`, or None.

        Bodies that one joint joins are left out: rails lie in their own cabinets. So are those
        that move with the joint.
        """
        key = (state, active, end)
        if key not in self._known:
            if len(self._known) >= KEPT:
                self._known.clear()
            self._known[key] = self._searched(state, active, end)
        return self._known[key]

    def _searched(self, state: State, active: Iri, end: float) -> Block | None:
        path = _Path(self._model, self._rest, state, active, end)
        found: Block | None = None
        for one, other in path.near(self._shapes):
            block = path.followed(one, other, end if found is None else found.position)
            found = block or found
        return found


class _Rest:
    """The kitchen with every joint at its start position, in which its parts were fitted together."""

    def __init__(self, model: Model, shapes: Sequence[_Shape]) -> None:
        q = np.array([_start(joint.limits) for joint in model.part.joints])
        pin.forwardKinematics(model.model, model.data, model.coupling.positions(q))
        self._placed = {id(each): _placed(model.data.oMi[each.joint] * each.pose) for each in shapes}
        self._bodies: dict[Iri, list[_Shape]] = {}
        for each in shapes:
            self._bodies.setdefault(each.body, []).append(each)
        self._known: dict[tuple[Iri, Iri], bool] = {}

    def depth(self, one: _Shape, other: _Shape) -> float:
        """[m] How deep the shapes are in each other, 0 where they are apart."""
        return max(0.0, -_gap(one, self._placed[id(one)], other, self._placed[id(other)]))

    def bears(self, one: _Shape, other: _Shape) -> bool:
        """One moves in or on the other: its joint's parent, or what is fixed to that and encloses it."""
        key = (one.body, other.body)
        if key not in self._known:
            mounted = other.body in one.mount or one.body in other.mount
            self._known[key] = one.parent == other.body or (mounted and self._overlap(*key))
        return self._known[key]

    def _overlap(self, one: Iri, other: Iri) -> bool:
        return any(self.depth(a, b) > 0 for a in self._bodies[one] for b in self._bodies[other])


class _Path:
    """One actuated joint on its way, all others resting."""

    def __init__(self, model: Model, rest: "_Rest", state: State, active: Iri, end: float) -> None:
        self._rest = rest
        self._model, self._k = model, model.coordinate[active]
        self._speeds: dict[int, float] = {}
        self._q = np.zeros(model.model.nq)
        for joint, value in state.positions:
            if joint in model.coordinate:
                self._q[model.coordinate[joint]] = value
        self._begin, self._end = float(self._q[self._k]), end
        pinocchio = model.model
        follows = {
            i for i in range(1, pinocchio.njoints) if model.coupling.source[pinocchio.idx_qs[i]] == self._k
        }
        self._moving = {
            i for i in range(1, pinocchio.njoints) if follows & set(pinocchio.supports[i].tolist())
        }
        self._follows = follows

    def _frames(self, position: float) -> list[pin.SE3]:
        """world_T_joint of every joint: Pinocchio's own list, valid until the next call."""
        q = self._q.copy()
        q[self._k] = position
        pin.forwardKinematics(self._model.model, self._model.data, self._model.coupling.positions(q))
        return self._model.data.oMi

    def near(self, shapes: Sequence[_Shape]) -> Iterator[tuple[_Shape, _Shape]]:
        """Pairs of a moved and a resting shape whose surrounding boxes meet on the way."""
        moved = [each for each in shapes if each.joint in self._moving]
        resting = [each for each in shapes if each.joint not in self._moving]
        if not moved or not resting:
            return
        low, high = self._boxes(resting, self._begin)
        reach = np.zeros((len(moved), len(resting)), dtype=bool)
        step = abs(self._end - self._begin) / (GRID - 1)
        pad = np.array([self._speed(each) for each in moved])[:, None] * step
        for position in np.linspace(self._begin, self._end, GRID):
            below, above = self._boxes(moved, float(position))
            reach |= ((below - pad)[:, None] <= high).all(2) & ((above + pad)[:, None] >= low).all(2)
        for i, j in np.argwhere(reach):
            one, other = moved[i], resting[j]
            if not self._rest.bears(one, other):
                yield one, other

    def _boxes(self, shapes: Sequence[_Shape], position: float) -> tuple[Array, Array]:
        frames = self._frames(position)
        turns, at = np.array([one.rotation for one in frames]), np.array([one.translation for one in frames])
        joint = np.array([each.joint for each in shapes])
        middle = (turns[joint] @ np.array([each.centre for each in shapes])[:, :, None])[:, :, 0] + at[joint]
        rotation = turns[joint] @ np.array([each.rotation for each in shapes])
        reach = (np.abs(rotation) @ np.array([each.half for each in shapes])[:, :, None])[:, :, 0]
        return middle - reach, middle + reach

    def _speed(self, one: _Shape) -> float:
        """Bound of the speed of the shape's points [m per unit of the actuated joint], kept."""
        if id(one) not in self._speeds:
            self._speeds[id(one)] = self._fastest(one)
        return self._speeds[id(one)]

    def _fastest(self, one: _Shape) -> float:
        total, slid = 0.0, 0.0
        pinocchio, frames = self._model.model, self._frames(self._begin)
        supports = [i for i in pinocchio.supports[one.joint].tolist() if i in self._follows]
        points = [frames[i].translation.copy() for i in supports] + [frames[one.joint].act(one.centre)]
        arm = one.radius
        for i, (a, b) in reversed(list(zip(supports, pairwise(points), strict=True))):
            coordinate = pinocchio.idx_qs[i]
            rate = abs(float(self._model.coupling.multiplier[coordinate]))
            arm += float(np.linalg.norm(b - a))
            if self._joint_type(coordinate) is JointType.PRISMATIC:
                total, slid = total + rate, slid + rate * abs(self._end - self._begin)
            else:
                total += rate * (arm + slid)
        return total

    def _joint_type(self, coordinate: int) -> JointType:
        part = self._model.part
        return part.joints[coordinate - part.first].type

    def followed(self, one: _Shape, other: _Shape, end: float) -> Block | None:
        """The first position up to `end` at which the two are too deep in each other."""
        direction, speed = np.sign(end - self._begin), self._speed(one)
        resting = _placed(self._frames(self._begin)[other.joint] * other.pose)
        least = min(ALLOWANCE, THIN_SHARE * (one.thickness + other.thickness))
        position, allowed = self._begin, least
        while speed > 0:
            placed = _placed(self._frames(position)[one.joint] * one.pose)
            gap = _gap(one, placed, other, resting)
            if position == self._begin:
                allowed += max(0.0, -gap, REST_FACTOR * self._rest.depth(one, other))
            if gap < -allowed:
                return Block(position, -gap, allowed, one.body, other.body)
            if position == end:
                return None
            step = max(gap, least / 2, LEAST_STEP) / speed
            ahead = position + direction * step
            position = end if (end - ahead) * direction <= 0 else float(ahead)
        return None


def _gap(one: _Shape, one_at: coal.Transform3s, other: _Shape, other_at: coal.Transform3s) -> float:
    """Distance of two shapes [m], negative where they penetrate."""
    # Request and result of its own for each call: a cached guess gives wrong answers.
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    return float(coal.distance(one.shape, one_at, other.shape, other_at, request, result))


def _start(limits: Limits) -> float:
    return 0.0 if limits.lower <= 0 <= limits.upper else limits.lower


def _placed(pose: pin.SE3) -> coal.Transform3s:
    return coal.Transform3s(pose.rotation, pose.translation)


def _shapes(model: Model) -> Iterator[_Shape]:
    part = model.part
    name, carried, mounts = part.mechanism.name, _carriers(part.mechanism), _mounts(part.mechanism)
    for body in part.mechanism.bodies:
        index, joint_T_body = part.attached[body.name]
        parent = carried[body.name]
        for geometry in body.collision:
            pose = joint_T_body * se3(geometry.pose)
            for shape in pieces(geometry):
                box = shape.aabb_local
                size = box.max_ - box.min_
                yield _Shape(
                    body=body_iri(name, body.name),
                    parent=body_iri(name, parent) if parent else None,
                    mount=frozenset(body_iri(name, each) for each in mounts.get(parent, ())),
                    joint=index,
                    pose=pose,
                    shape=shape,
                    rotation=pose.rotation.copy(),
                    half=size / 2,
                    centre=pose.act((box.min_ + box.max_) / 2),
                    radius=float(np.linalg.norm(size)) / 2,
                    thickness=float(size.min()),
                )


def _carriers(mechanism: Mechanism) -> dict[str, str]:
    """Body → parent of the joint that moves it, empty where none does."""
    carriers = {mechanism.root: ""}
    for joint in mechanism.joints:
        carriers[joint.child] = carriers[joint.parent] if joint.type is JointType.FIXED else joint.parent
    return carriers


def _mounts(mechanism: Mechanism) -> dict[str, set[str]]:
    """Body → the bodies which a single fixed joint joins to it."""
    mounts: dict[str, set[str]] = {}
    for joint in mechanism.joints:
        if joint.type is JointType.FIXED:
            mounts.setdefault(joint.parent, set()).add(joint.child)
            mounts.setdefault(joint.child, set()).add(joint.parent)
    return mounts
