"""Grasps: how a hand may hold a bar, and which of them the kitchen leaves room for.

A grasp is data, a tool pose in the handle's frame: no robot pose is needed to say that a palm runs
into the worktop or a fingertip into the front.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import AnnotationError
from sdt_kg.iri import joint_iri
from services.embodiment.body.hand import placing
from services.embodiment.body.limb import Limb
from services.embodiment.body.world import World
from services.physics.model import Scene

Array = NDArray[np.float64]
Positions = tuple[tuple[str, float], ...]
"""Of finger joints, by their names [rad or m]."""

TOUCH = 0.0003  # [m] distance from which a finger counts as touching: certify allows 2 mm


@dataclass(frozen=True, slots=True, eq=False)
class Grasp:
    """A way to hold a bar.

    Attributes:
        rotation, translation: Tool pose in the frame of the bar's joint.
        fingers: Positions of the gripper's finger joints when closed on the bar, by joint name.
        opened: Their positions while the hand comes near.
        index: Its number in the grasp set, for reports.
        aside: From there the open hand comes with a finger that stands still, in the same frame [m].
    """

    rotation: Array
    translation: Array
    index: int
    fingers: Positions = ()
    opened: Positions = ()
    aside: Array | None = None

    def tool(self, handle_r: Array, handle_p: Array) -> tuple[Array, Array]:
        """World tool poses for handle poses (T, 3, 3), (T, 3)."""
        return handle_r @ self.rotation, handle_r @ self.translation + handle_p


class Hand:
    """A gripper without its arm, to be put anywhere.

    Attributes:
        parts, closing, sides, pads: What `fingers.closed`, `placing.stays` and `fingers.engaged` take.
        shapes: Indices of its shapes, fingers last.
        fingers: Indices of those of its fingers.
        still: Indices of those that closing does not move.
        reach: Of any of them from the tool frame [m].
        amid: Where the middle between its open fingers is along y of the tool, if those of one side stand
            still: a bar has room there [m].
    """

    def __init__(self, world: World, limb: Limb) -> None:
        self.world, self.limb = world, limb
        palm, self.fingers = world.shapes_of(limb.palm), world.shapes_of(limb.fingers)
        self.shapes = np.concatenate([palm, self.fingers])
        if not len(self.fingers):
            raise AnnotationError(
                f"gripper '{limb.gripper.name}' has no collision shape to hold a handle with",
                allowed="<collision> in the URDF's links of its fingers",
            )
        joints = limb.gripper.finger_joints
        self._joints = tuple(one.joint for one in joints)
        self._ends = np.array([(one.open, one.closed - one.open) for one in joints]).T
        self._opened: dict[float, Positions] = {}
        self._tool = limb.tool(np.zeros(len(limb.lower)))
        self.closing = self._closings()
        moved = np.array([j for j in range(1, len(world.tree[0])) if self._follows(j)], np.int64)
        frames = world.frames(self.closing[0])
        self.parts = (self.shapes, len(palm), moved, world.tree, world.boxes, self._tool, frames)
        self.still = frozenset(self.shapes[~np.isin(world.boxes[0][self.shapes], moved)].tolist())
        self._seen: dict[float, tuple[Array, Array]] = {}
        self.sides, self.pads = self._sides(), self._pads()
        open_at, closed_at = (self.shapes_seen(share)[1] for share in (0.0, 1.0))
        away = np.maximum(np.linalg.norm(open_at, axis=1), np.linalg.norm(closed_at, axis=1))
        self.reach = float((away + world.radius[self.shapes]).max())
        self.amid = self._amid()

    def _sides(self) -> NDArray[np.bool_]:
        """Finger shapes that each finger joint brings to a bar from two sides, shape (F, 2, fingers).

        One joint alone closes both sides, as seen along +y of the tool frame; of several each closes its own.
        """
        joints = self.limb.gripper.finger_joints
        if len(joints) == 1:
            left = self._left_side()
            return np.stack([left, ~left])[None]
        return np.stack([[self._moved_by(k)] * 2 for k in range(len(joints))])

    def _pads(self) -> tuple[NDArray[np.bool_], Array]:
        """Finger shapes of each body (B, fingers), and on which side of the tool it is along y (B,)."""
        bodies, left = [self.world.body[one] for one in self.fingers], self._left_side()
        own = np.array([[one == body for one in bodies] for body in dict.fromkeys(bodies)])
        return own, np.where((own & left).any(axis=1), 1.0, -1.0)

    def _amid(self) -> float:
        """The middle between the open fingers along y of the tool [m]; 0 where those of both sides move."""
        left, moves = self._left_side(), self._moving()
        if len(self.limb.gripper.finger_joints) > 1 or moves.all() or not moves.any():
            return 0.0
        turns, middles = (part[-len(self.fingers) :] for part in self.shapes_seen(0.0))
        reach = (np.abs(turns[:, 1]) * self.world.half[self.fingers]).sum(axis=1)
        return float((middles[left, 1] - reach[left]).min() + (middles[~left, 1] + reach[~left]).max()) / 2

    def _moving(self) -> NDArray[np.bool_]:
        """Which finger shapes closing moves."""
        return np.isin(self.world.boxes[0][self.fingers], self.parts[2])

    def _left_side(self) -> NDArray[np.bool_]:
        """Which finger shapes lie on the +y side of the tool frame when open.

        Of fingers of which some stand still, these lie on one side and those that close on the other.
        """
        at, moves = self.shapes_seen(0.0)[1][-len(self.fingers) :, 1], self._moving()
        if len(self.limb.gripper.finger_joints) == 1 and moves.any() and not moves.all():
            return moves if at[moves].mean() > at[~moves].mean() else ~moves
        return at > 0

    def _closings(self) -> tuple[Array, Array]:
        """The open configuration (nq,), and what closing each finger joint adds (F, nq)."""
        opened = self.configuration(0.0)
        joints = self.limb.gripper.finger_joints
        shut = [{one.joint: _between(one, float(one is each)) for one in joints} for each in joints]
        return opened, np.stack([self.configuration(one) - opened for one in shut])

    def _follows(self, joint: int) -> bool:
        """Whether closing moves a model joint."""
        while joint > 0 and not self.closing[1][:, joint - 1].any():
            joint = self.world.scene.model.parents[joint]
        return joint > 0

    def configuration(self, share: float | dict[str, float]) -> Array:
        """Scene configuration at x = 0 with the fingers closed by a share (0 open, 1 closed) or as given."""
        scene, gripper = self.world.scene, self.limb.gripper
        q = self.limb.q(np.zeros(len(self.limb.lower)))
        for finger in gripper.finger_joints:
            value = share[finger.joint] if isinstance(share, dict) else _between(finger, share)
            q[scene.coordinate[joint_iri(scene.robot.mechanism.name, finger.joint)]] = value
        return scene.coupling.positions(q)

    def closed(self, shares: Array) -> Array:
        """The same with its finger joints closed by shares (F,)."""
        return self.closing[0] + shares @ self.closing[1]

    def shapes_seen(self, share: float) -> tuple[Array, Array]:
        """Poses of its shapes in the tool frame, fingers closed by a share; kept: grasps open alike."""
        if share not in self._seen:
            at = self.room()[0]
            placing.posed(self.configuration(share), self.parts, at)
            self._seen[share] = at
        return self._seen[share]

    def room(self) -> tuple:
        """What compiled loops write to; first poses of its shapes."""
        return placing.room(len(self.shapes), len(self.closing[0]))

    def opening(self, share: float) -> Positions:
        """Positions of the finger joints, closed by a share; kept, as grasps open alike."""
        if share not in self._opened:
            self._opened[share] = self.positions(np.full(len(self._joints), share))
        return self._opened[share]

    def positions(self, shares: Array) -> Positions:
        """Positions of the finger joints, each closed by its share, shape (F,)."""
        return tuple(zip(self._joints, (self._ends[0] + shares * self._ends[1]).tolist(), strict=True))

    def _moved_by(self, k: int) -> NDArray[np.bool_]:
        """Which finger shapes finger joint k moves."""
        scene = self.world.scene
        name = self.limb.gripper.finger_joints[k].joint
        source = scene.coordinate[joint_iri(scene.robot.mechanism.name, name)]
        return np.array([_carried(scene, int(self.world.boxes[0][one]), source) for one in self.fingers])


def _carried(scene: Scene, joint: int, source: int) -> bool:
    """Whether the coordinate `source`, or one that follows it, moves the joint."""
    while joint > 0:
        if scene.coupling.source[joint - 1] == source:
            return True
        joint = scene.model.parents[joint]
    return False


def _between(finger, share: float) -> float:  # noqa: ANN001 - FingerJoint
    return finger.open + share * (finger.closed - finger.open)
