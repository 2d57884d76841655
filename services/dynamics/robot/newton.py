r"""Newton and Euler for a whole robot over spans of time: joint forces and what the floor gives, in balls.

In the world's frame, joints before their children: for each joint the turn of its frame since the middle of
the span is at most the sum of :math:`|\Delta q|` of the turning joints up to it, so that a vector of length l
that is fixed in it moves by at most that times l. Everything else follows by products and sums.
"""

from dataclasses import dataclass

import numpy as np

from services.dynamics.model import Array
from services.dynamics.robot.balls import Numbers, Vectors, fixed
from services.embodiment.certify.sweep.kinematics import joint_axes
from services.embodiment.certify.sweep.pieces import Pieces
from services.physics.model import Scene

GRAVITY = np.array([0.0, 0.0, 9.81])
"""[m/s2] What standing still accelerates upwards against falling; Pinocchio's."""


@dataclass(frozen=True, slots=True, eq=False)
class Coordinates:
    """What C spans of a motion say of one coordinate: position, speed, acceleration."""

    q: Numbers
    v: Numbers
    a: Numbers


class Along:
    """The scene's coordinates over spans of cubic pieces.

    Args:
        pieces: Of all coordinates.
        piece: Of which piece each span is a part, shape (C,).
        begin, end: Of the spans, shape (C,) [s].
    """

    def __init__(
        self, pieces: Pieces, piece: "np.ndarray[tuple[int], np.dtype[np.intp]]", begin: Array, end: Array
    ) -> None:
        self._half = ((end - begin) / 2)[:, None]
        self._q, self._v, self._a = pieces.at(piece, (begin + end) / 2 - pieces.start[piece])
        self._jerk = 6 * np.abs(pieces.c[3, piece])

    def __len__(self) -> int:
        return len(self._q)

    def of(self, k: int) -> Coordinates:
        """The k-th coordinate: Taylor's formula about the middle, acceleration being linear."""
        half, q, v, a = self._half[:, 0], self._q[:, k], self._v[:, k], self._a[:, k]
        of_a = self._jerk[:, k] * half
        of_v = (np.abs(a) + of_a) * half
        of_q = np.abs(v) * half + (np.abs(a) + of_a) * half**2 / 2
        return Coordinates(Numbers(q, of_q), Numbers(v, of_v), Numbers(a, of_a))


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """Where a joint's frame is, and how it moves.

    Attributes:
        rotation: In the middle of each span, shape (C, 3, 3).
        turn: By how much it turns away from that, shape (C,) [rad].
        origin: In the world [m].
        axis: Of the joint, in the world.
        omega, alpha: Angular velocity and acceleration.
        acceleration: Of the origin, gravity included [m/s2].
    """

    rotation: Array
    turn: Array
    origin: Vectors
    axis: Vectors
    omega: Vectors
    alpha: Vectors
    acceleration: Vectors

    def carried(self, local: Array) -> Vectors:
        """A vector of the joint's frame, shape (3,), in the world."""
        return Vectors(self.rotation @ local, float(np.linalg.norm(local)) * self.turn)


@dataclass(frozen=True, slots=True, eq=False)
class Wrench:
    """What a joint has to give its body and all that hangs on it: force, and moment about its origin."""

    force: Vectors
    moment: Vectors


class Robot:
    """A scene's robot with its base, as links and joints of the world's frame."""

    def __init__(self, scene: Scene) -> None:
        self._model, (self._axes, self._turns) = scene.model, joint_axes(scene)
        first = int(scene.base[0])
        self.coordinates = (
            *scene.base.tolist(),
            *(scene.robot.first + k for k in range(len(scene.robot.joints))),
        )
        self._root = int(scene.model.parents[first + 1])
        self.yaw = int(scene.base[2])

    def placed(self, along: Along, gravity: Array = GRAVITY) -> dict[int, Placed]:
        """Every joint's frame by its coordinate, parents first."""
        count = len(along)
        still = fixed(np.zeros(3), count)
        world = Placed(
            np.tile(np.eye(3), (count, 1, 1)),
            np.zeros(count),
            still,
            still,
            still,
            still,
            fixed(gravity, count),
        )
        found = {self._root - 1: world}
        for k in self.coordinates:
            parent = found[int(self._model.parents[k + 1]) - 1]
            found[k] = self._next(parent, k, along.of(k))
        return found

    def _next(self, parent: Placed, k: int, at: Coordinates) -> Placed:
        placement, local = self._model.jointPlacements[k + 1], self._axes[k]
        before = parent.rotation @ placement.rotation
        axis = Vectors(before @ local, parent.turn)
        arm = parent.carried(placement.translation)
        around, along = fixed(np.zeros(3), len(arm.radius)), fixed(np.zeros(3), len(arm.radius))
        rotation, turn = before, parent.turn
        omega, alpha = parent.omega, parent.alpha
        if self._turns[k]:
            rotation, turn = before @ _rotations(local, at.q.centre), parent.turn + at.q.radius
            spin = axis.times(at.v)
            omega, alpha = omega + spin, alpha + axis.times(at.a) + parent.omega.cross(spin)
        else:
            arm = arm + axis.times(at.q)
            along, around = axis.times(at.a), parent.omega.cross(axis.times(at.v)).scaled(2.0)
        centripetal = parent.omega.cross(parent.omega.cross(arm))
        acceleration = parent.acceleration + parent.alpha.cross(arm) + centripetal + along + around
        return Placed(rotation, turn, parent.origin + arm, axis, omega, alpha, acceleration)

    def wrenches(self, placed: dict[int, Placed]) -> dict[int, Wrench]:
        """What every joint has to give, by its coordinate; children are added to their parents."""
        found = {k: self._own(placed[k], k) for k in self.coordinates}
        for k in reversed(self.coordinates):
            parent = int(self._model.parents[k + 1]) - 1
            if parent in found:
                arm = placed[k].origin - placed[parent].origin
                force, own = found[k].force, found[parent]
                moment = own.moment + found[k].moment + arm.cross(force)
                found[parent] = Wrench(own.force + force, moment)
        return found

    def _own(self, at: Placed, k: int) -> Wrench:
        """Mass times acceleration of the body, and its change of spin, about the joint's origin."""
        inertia = self._model.inertias[k + 1]
        arm = at.carried(inertia.lever)
        acceleration = at.acceleration + at.alpha.cross(arm) + at.omega.cross(at.omega.cross(arm))
        force = acceleration.scaled(float(inertia.mass))
        spin = _turned(inertia.inertia, at, at.alpha) + at.omega.cross(_turned(inertia.inertia, at, at.omega))
        return Wrench(force, spin + arm.cross(force))

    def efforts(self, placed: dict[int, Placed], wrenches: dict[int, Wrench]) -> dict[int, Numbers]:
        """The part of each wrench along its joint, N m or N."""
        return {
            k: placed[k].axis.dot(wrench.moment if self._turns[k] else wrench.force)
            for k, wrench in wrenches.items()
        }

    def pulled(
        self, placed: dict[int, Placed], tool: int, point: Vectors, along: Vectors
    ) -> dict[int, Numbers]:
        """Force of each joint that carries the hand, for one newton of the hand along a direction."""
        found = dict[int, Numbers]()
        while tool in placed and tool in self.coordinates:
            axis = placed[tool].axis
            arm = axis.cross(point - placed[tool].origin) if self._turns[tool] else axis
            found[tool] = arm.dot(along)
            tool = int(self._model.parents[tool + 1]) - 1
        return found


def _turned(inertia: Array, at: Placed, vector: Vectors) -> Vectors:
    """I x with the body's inertia in the world; a turn by t changes I by at most 2 t |I|."""
    size = float(np.linalg.norm(inertia, 2))
    world = at.rotation @ inertia @ at.rotation.transpose(0, 2, 1)
    centre = np.einsum("cij,cj->ci", world, vector.centre)
    return Vectors(centre, size * (vector.radius + 2 * at.turn * (vector.size + vector.radius)))


def _rotations(axis: Array, angle: Array) -> Array:
    x, y, z = axis
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turn = angle[:, None, None]
    return np.eye(3) + np.sin(turn) * skew + (1 - np.cos(turn)) * (skew @ skew)
