"""Placements and motion bounds of all bodies for many configurations at once.

Plain numpy, apart from the forward kinematics that planning uses: what Pinocchio or its glue gets
wrong is not repeated here. Joints that stand still during the whole motion are merged.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sdt_kg.mechanism import JointType
from services.embodiment.certify.sweep import compiled
from services.embodiment.certify.sweep.pieces import Spans
from services.physics.model import Scene

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """Carriers at U configurations; K carriers, the world first, then one for each moving joint.

    Attributes:
        rotation, origin: world_T_carrier, shapes (U, K, 3, 3) and (U, K, 3).
        axis: Axis of the carrier's joint in the world, shape (U, K, 3).
        omega, linear: Angular velocity, and velocity of the carrier's point at the world's origin,
            shape (U, K, 3).
    """

    rotation: Array
    origin: Array
    axis: Array
    omega: Array
    linear: Array

    @property
    def arrays(self) -> tuple[Array, ...]:
        """What compiled loops take."""
        return self.rotation, self.origin, self.axis, self.omega, self.linear


class Kinematics:
    """The scene with all coordinates fixed but those that move.

    Attributes:
        moving: The coordinates that move, shape (K - 1,); carrier k + 1 belongs to moving[k].
        path: path[i, k]: carrier k is carrier i or one of its ancestors; the world counts for none.
        carrier: Pinocchio's joint index → carrier, shape (njoints,).
        revolute: Whether a carrier's joint turns, shape (K,).
        fixed: carrier_T_joint for each of Pinocchio's joints, shape (njoints, 4, 4).
    """

    def __init__(self, scene: Scene, q: Array, moving: Indices) -> None:
        self.moving = moving
        axes, revolute = joint_axes(scene)
        self._axis = np.vstack((np.zeros((1, 3)), axes[moving]))
        self.revolute = np.concatenate(([False], revolute[moving]))
        count, (parents, placements) = len(moving) + 1, _links(scene)
        own, links = np.zeros(len(parents), dtype=np.intp), placements.copy()
        own[moving + 1] = np.arange(1, count)
        still = np.flatnonzero(own[1:] == 0)
        links[still + 1] = placements[still + 1] @ _displacements(axes[still], revolute[still], q[still])
        self._parent, self._offset = np.zeros(count, dtype=np.intp), np.tile(np.eye(4), (count, 1, 1))
        self.path = np.zeros((count, count), dtype=bool)
        self.carrier = np.zeros(len(parents), dtype=np.intp)
        self.fixed = np.tile(np.eye(4), (len(parents), 1, 1))
        tree = self._parent, self._offset, self.path
        compiled.merge(parents, links, own, self.carrier, self.fixed, *tree)

    def place(self, q: Array, v: Array) -> Placed:
        """Carriers at positions and velocities of the moving coordinates, shape (U, K - 1)."""
        count = len(self._parent)
        rotation = np.empty((len(q), count, 3, 3))
        origin, axis, omega, linear = np.empty((4, len(q), count, 3))
        tree = self._parent, self._offset, self._axis, self.revolute
        compiled.place(q, v, *tree, rotation, origin, axis, omega, linear)
        return Placed(rotation, origin, axis, omega, linear)

    def levers(self, placed: Placed, point: Array) -> Array:
        """Distance of a point from each carrier's axis at the first configuration, shape (K,) [m]."""
        return np.linalg.norm(cross(point - placed.origin[0], placed.axis[0]), axis=1)

    def bounds(self, spans: Spans, placed: Placed, of: "Of") -> tuple[Array, Array]:
        r"""How far the points of a ball can move, and turn, against another carrier.

        Both bounds are against the middle of the span and hold for all of it. With
        :math:`\rho_k` the largest distance of the ball's points from axis k (1 for a prismatic
        joint), over the joints between the two carriers: moving the joints one after the other from
        the other carrier outwards, every :math:`\rho_k` is that of the middle, so that the shift is
        at most :math:`D = \sum \rho_k |\Delta q_k|`. For a short span, Taylor's formula of second
        order with the relative velocity at the middle is sharper, and keeps small what moves along
        with the other carrier: :math:`|v_{rel}| \tau + M \tau^2 / 2`,
        :math:`M = \sum (\rho_k + D) |\ddot q_k| + 2 \sum |\omega_k| \sum (\rho_k + D) |\dot q_k|`.

        Returns:
            Shift [m] and turn [rad; of the operator norm of the rotation's change], shape (U,).
        """
        moved, turned = np.empty((2, len(of.centre)))
        between = of.carrier, of.against, of.centre, of.radius, self.path, self.revolute
        compiled.bounds(*between, placed.arrays, spans.arrays, np.empty(len(self.path)), moved, turned)
        return moved, turned


@dataclass(frozen=True, slots=True, eq=False)
class Of:
    """Balls of one size whose motion is to be bounded, one for each of U spans.

    Attributes:
        carrier: What carries the balls.
        against: Carrier against which they move.
        centre: In the world at the span's middle, shape (U, 3) [m].
        radius: [m].
    """

    carrier: int
    against: int
    centre: Array
    radius: float


def cross(one: Array, other: Array) -> Array:
    """Cross products, shape (…, 3); numpy's own spends most of its time on moving axes."""
    x, y, z = one[..., 0], one[..., 1], one[..., 2]
    u, v, w = other[..., 0], other[..., 1], other[..., 2]
    return np.stack((y * w - z * v, z * u - x * w, x * v - y * u), axis=-1)


@lru_cache(maxsize=8)
def joint_axes(scene: Scene) -> tuple[Array, NDArray[np.bool_]]:
    """Axis of each coordinate's joint in its own frame, shape (nq, 3), and whether it turns.

    Kept, so not to be changed.
    """
    axes, revolute = np.zeros((scene.model.nq, 3)), np.zeros(scene.model.nq, dtype=bool)
    axes[scene.base] = np.eye(3)
    revolute[scene.base[2]] = True
    for part in (scene.kitchen, scene.robot):
        for k, joint in enumerate(part.joints, part.first):
            axes[k], revolute[k] = joint.axis, joint.type is not JointType.PRISMATIC
    return axes, revolute


def farther(scene: Scene, k: int) -> float:
    """How far a container that moves with a joint goes for each rad or m of that; at least 1."""
    source, multiplier = scene.coupling.source, np.abs(scene.coupling.multiplier)
    every = [scene.coordinate[each.joint] for each in scene.twin.containers()]
    along = [each for each in every if source[each] == source[k] and multiplier[k] > 0]
    return max([1.0, *(float(multiplier[each] / multiplier[k]) for each in along)])


def unit_of(scene: Scene, k: int) -> str:
    """Unit of a coordinate: rad where its joint turns, else m."""
    return "rad" if joint_axes(scene)[1][k] else "m"


@lru_cache(maxsize=8)
def _links(scene: Scene) -> tuple[Indices, Array]:
    """Parent of each of Pinocchio's joints and parent_T_joint, shape (J, 4, 4); not to be changed."""
    placements = np.array([one.homogeneous for one in scene.model.jointPlacements])
    return np.array(list(scene.model.parents), dtype=np.intp), placements


def _displacements(axes: Array, revolute: NDArray[np.bool_], q: Array) -> Array:
    """What each joint at its position does, shape (nq, 4, 4); the axes are of length 1."""
    moved = np.tile(np.eye(4), (len(q), 1, 1))
    moved[~revolute, :3, 3] = (q[:, None] * axes)[~revolute]
    turn, skew = q[revolute, None, None], np.zeros((int(revolute.sum()), 3, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        skew[:, j, i], skew[:, i, j] = axes[revolute, k], -axes[revolute, k]
    moved[revolute, :3, :3] += np.sin(turn) * skew + (1 - np.cos(turn)) * (skew @ skew)
    return moved
