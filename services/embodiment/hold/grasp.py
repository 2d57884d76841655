"""Grasps: how a hand may hold a bar, and which of them the kitchen leaves room for.

A grasp is data, a tool pose in the handle's frame: no robot pose is needed to say that a palm runs
into the worktop or a fingertip into the front.
"""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import AnnotationError
from sdt_kg.iri import joint_iri
from services.embodiment.body import hands
from services.embodiment.body.kernels import rotation
from services.embodiment.body.limb import Limb
from services.embodiment.body.world import World
from services.embodiment.hold.handle import Bar
from services.physics.model import Scene

Array = NDArray[np.float64]

PITCHES = np.radians([0, -20, 20, -40, 40, -60, 60, -80, 80])  # [rad] about the bar
TILTS = np.radians([0, -25, 25, -50, 50])  # [rad] along the bar, the fingers still closing across it
PLACES = (0.0, 0.5, -0.5)  # [1] along the bar, as a share of what of it leaves the fingers on the bar
DEPTHS = (0.0, -0.008, 0.008, -0.016, 0.016)  # [m] the tool frame beyond the bar's middle, along the approach
WIDE_PITCHES = np.radians([0, -10, 10, -20, 20, -30, 30, -40, 40, -50, 50, -60, 60, -80, 80])
WIDE_TILTS = np.radians([0, -25, 25, -50, 50, -65, 65, -80, 80])
WIDE_DEPTHS = (0.0, -0.012, 0.012)  # [m]
"""The same of a set that is more than single paths have the time for."""
FREE_MOST = np.array([1.75, 1.57, 0.6, 1.0, 0.026])
"""[rad, rad, rad, 1, m] Pitch, tilt, roll about the approach, place and offset of any grasp, at most."""
ANY_MOST = np.array([np.pi, np.pi / 2, np.pi / 2, 1.0, 0.04])
"""The same of grasps of any part of a handle, turned anyhow."""
BEYOND = 0.02  # [m] that its tool may be beyond the end of the bar: half a finger's width, and more
FIRST_WIDE = 10_000  # number of the first grasp of that set
FINGER_HALF = 0.015  # [m] kept from the ends of a bar, half a finger's width
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
    fingers: tuple[tuple[str, float], ...] = ()
    opened: tuple[tuple[str, float], ...] = ()
    aside: Array | None = None

    def tool(self, handle_r: Array, handle_p: Array) -> tuple[Array, Array]:
        """World tool poses for handle poses (T, 3, 3), (T, 3)."""
        return handle_r @ self.rotation, handle_r @ self.translation + handle_p


def _turned(axis: Array, angle: float, vector: Array) -> Array:
    turn = np.empty((3, 3))
    rotation(axis, angle, turn)
    return turn @ vector


def grasp_settings() -> str:
    """What the grasp set depends on, as text."""
    wide = (
        WIDE_PITCHES.tolist(),
        WIDE_TILTS.tolist(),
        WIDE_DEPTHS,
        FREE_MOST.tolist(),
        ANY_MOST.tolist(),
        BEYOND,
    )
    return repr((PITCHES.tolist(), TILTS.tolist(), PLACES, DEPTHS, wide, FINGER_HALF, TOUCH))


def grasp_set(bar: Bar, steep: bool = False) -> Iterator[Grasp]:
    """All grasps of a bar, straight ones first, or those that come from far above or below."""
    room = max(bar.length / 2 - FINGER_HALF, 0.0)
    places = [bar.centre + place * room * bar.along for place in PLACES]
    turns = dict[tuple[int, int, int], Array]()
    for index, (pitch, tilt, flip, place, depth) in _choices(steep):
        key = pitch, tilt, flip
        if key not in turns:
            turns[key] = _turn(bar, float(PITCHES[pitch]), float(TILTS[tilt]), flip)
        rotation = turns[key]
        yield Grasp(rotation, places[place] + DEPTHS[depth] * rotation[:, 0], index)


def wide_set(bar: Bar) -> Iterator[Grasp]:
    """Grasps of a bar from more directions, also from beside it, nearly along the bar."""
    room = max(bar.length / 2 - FINGER_HALF, 0.0)
    turns = itertools.product(WIDE_PITCHES.tolist(), WIDE_TILTS.tolist(), (1, -1))
    numbers, places = itertools.count(FIRST_WIDE), np.array(PLACES)[:, None, None] * room * bar.along
    for turn in (_turn(bar, *one) for one in turns):
        there = bar.centre + places + np.array(WIDE_DEPTHS)[:, None] * turn[:, 0]
        for translation in there.reshape(-1, 3):
            yield Grasp(turn, translation, next(numbers))


def free_grasp(bar: Bar, genes: Array, flip: int, number: int) -> Grasp:
    """A grasp with any pitch, tilt, roll about its approach, place and offset from the bar, shape (5,).

    The tool is off the bar along the approach as it is before the tilt: so it may lie beside the hand too.
    """
    pitch, tilt, roll, place, offset = genes.tolist()
    turn, rolled = _turn(bar, pitch, tilt, flip), np.empty((3, 3))
    rotation(turn[:, 0].copy(), roll, rolled)
    straight = _turned(bar.along, pitch, -bar.outward)
    at = bar.centre + place * (bar.length / 2 + BEYOND) * bar.along + offset * straight
    return Grasp(rolled @ turn, at, number)


@lru_cache(maxsize=2)
def _choices(steep: bool) -> tuple[tuple[int, tuple[int, int, int, int, int]], ...]:
    """Number, and indices of pitch, tilt, flip, place and depth; the straightest has the first number."""
    counts = range(len(PITCHES)), range(len(TILTS)), (1, -1), range(len(PLACES)), range(len(DEPTHS))
    straight = sorted(
        itertools.product(*counts),
        key=lambda choice: (choice[0] + choice[1] * 2 + choice[3] + choice[4], choice),
    )
    numbered = enumerate(straight)
    if not steep:
        return tuple(numbered)
    return tuple(sorted(numbered, key=lambda one: (one[1][3] + one[1][4], one[1][1], -one[1][0], one[0])))


@lru_cache(maxsize=1)
def _steep_ranks() -> dict[int, int]:
    return {index: rank for rank, (index, _) in enumerate(_choices(steep=True))}


def steepness(index: int) -> int:
    """Where the grasp of this number comes among those that come from far above or below first."""
    return _steep_ranks()[index]


def _turn(bar: Bar, pitch: float, tilt: float, flip: int) -> Array:
    """Rotation of the tool in the frame of the bar's joint."""
    approach = _turned(bar.along, pitch, -bar.outward)
    closing = flip * cross(bar.along, approach)
    approach = _turned(closing, tilt, approach)
    return np.stack([approach, closing, cross(approach, closing)], axis=1)


def cross(one: Array, other: Array) -> Array:
    """Cross product of two vectors (3,); numpy's own spends most of its time on moving axes."""
    (a, b, c), (x, y, z) = one.tolist(), other.tolist()
    return np.array([b * z - c * y, c * x - a * z, a * y - b * x])


class Hand:
    """A gripper without its arm, to be put anywhere.

    Attributes:
        parts, closing, sides, pads: What `hands.closed`, `hands.stays` and `hands.engaged` take.
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
        if not len(self.shapes):
            raise AnnotationError(
                f"gripper '{limb.gripper.name}' has no collision shape to hold a handle with",
                allowed="<collision> in the URDF's links of its fingers",
            )
        self._tool = limb.tool(np.zeros(len(limb.lower)))
        self.closing = self._closings()
        joints = np.array([j for j in range(1, len(world.tree[0])) if self._follows(j)], np.int64)
        frames = world.frames(self.closing[0])
        self.parts = (self.shapes, len(palm), joints, world.tree, world.boxes, self._tool, frames)
        self.still = frozenset(self.shapes[~np.isin(world.boxes[0][self.shapes], joints)].tolist())
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

    def shapes_seen(self, share: float) -> tuple[Array, Array]:
        """Poses of its shapes in the tool frame, fingers closed by a share; kept: grasps open alike."""
        if share not in self._seen:
            at = self.room()[0]
            hands.posed(self.configuration(share), self.parts, at)
            self._seen[share] = at
        return self._seen[share]

    def room(self) -> tuple:
        """What compiled loops write to; first poses of its shapes."""
        return hands.room(len(self.shapes), len(self.closing[0]))

    def opening(self, share: float) -> tuple[tuple[str, float], ...]:
        """Positions of the finger joints, closed by a share."""
        return tuple((one.joint, _between(one, share)) for one in self.limb.gripper.finger_joints)

    def positions(self, shares: Array) -> tuple[tuple[str, float], ...]:
        """Positions of the finger joints, each closed by its share, shape (F,)."""
        each = zip(self.limb.gripper.finger_joints, shares.tolist(), strict=True)
        return tuple((one.joint, _between(one, share)) for one, share in each)

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
