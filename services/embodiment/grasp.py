"""Grasps: how a hand may hold a bar, and which of them the kitchen leaves room for.

A grasp is data, a tool pose in the handle's frame: no robot pose is needed to say that a palm runs
into the worktop or a fingertip into the front.
"""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sdt_kg.iri import joint_iri
from services.embodiment.handle import Bar
from services.embodiment.limb import Limb
from services.embodiment.world import World

Array = NDArray[np.float64]

PITCHES = np.radians([0, -20, 20, -40, 40, -60, 60, -80, 80])  # [rad] about the bar
TILTS = np.radians([0, -25, 25, -50, 50])  # [rad] along the bar, the fingers still closing across it
PLACES = (0.0, 0.5, -0.5)  # [1] along the bar, as a share of what of it leaves the fingers on the bar
DEPTHS = (0.0, -0.008, 0.008, -0.016, 0.016)  # [m] the tool frame beyond the bar's middle, along the approach
FINGER_HALF = 0.015  # [m] kept from the ends of a bar, half a finger's width
TOUCH = 0.0003  # [m] distance from which a finger counts as touching: certify allows 2 mm
BISECTIONS = 16


@dataclass(frozen=True, slots=True, eq=False)
class Grasp:
    """A way to hold a bar.

    Attributes:
        rotation, translation: Tool pose in the frame of the bar's joint.
        fingers: Positions of the gripper's finger joints when closed on the bar, by joint name.
        index: Its number in the grasp set, for reports.
    """

    rotation: Array
    translation: Array
    index: int
    fingers: tuple[tuple[str, float], ...] = ()

    def tool(self, handle_r: Array, handle_p: Array) -> tuple[Array, Array]:
        """World tool poses for handle poses (T, 3, 3), (T, 3)."""
        return handle_r @ self.rotation, handle_r @ self.translation + handle_p


def _turned(axis: Array, angle: float, vector: Array) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return c * vector + s * np.cross(axis, vector) + (1 - c) * (axis @ vector) * axis


def grasp_set(bar: Bar) -> Iterator[Grasp]:
    """All grasps of a bar, straight ones first."""
    choices = sorted(
        itertools.product(range(len(PITCHES)), range(len(TILTS)), (1, -1), range(len(PLACES)), range(len(DEPTHS))),
        key=lambda choice: (choice[0] + choice[1] * 2 + choice[3] + choice[4], choice),
    )
    room = max(bar.length / 2 - FINGER_HALF, 0.0)
    for index, (pitch, tilt, flip, place, depth) in enumerate(choices):
        approach = _turned(bar.along, PITCHES[pitch], -bar.outward)
        closing = flip * np.cross(bar.along, approach)
        approach = _turned(closing, TILTS[tilt], approach)
        rotation = np.stack([approach, closing, np.cross(approach, closing)], axis=1)
        translation = bar.centre + PLACES[place] * room * bar.along + DEPTHS[depth] * approach
        yield Grasp(rotation, translation, index)


class Hand:
    """A gripper without its arm, to be put anywhere.

    Attributes:
        shapes: Indices of its shapes, fingers last.
    """

    def __init__(self, world: World, limb: Limb) -> None:
        self.world, self.limb = world, limb
        palm, fingers = world.shapes_of(limb.palm), world.shapes_of(limb.fingers)
        self.shapes = np.concatenate([palm, fingers])
        self.fingers = fingers
        self._tool = limb.tool(np.zeros(len(limb.lower)))

    def configuration(self, share: float | dict[str, float]) -> Array:
        """Scene configuration at x = 0 with the fingers closed by a share (0 open, 1 closed) or as given."""
        scene, gripper = self.world.scene, self.limb.gripper
        q = self.limb.q(np.zeros(len(self.limb.lower)))
        for finger in gripper.finger_joints:
            value = share[finger.joint] if isinstance(share, dict) else _between(finger, share)
            q[scene.coordinate[joint_iri(scene.robot.mechanism.name, finger.joint)]] = value
        return scene.coupling.positions(q)

    def placed(self, q: Array, tool_r: Array, tool_p: Array) -> tuple[Array, Array]:
        """Joint frames of the whole scene at q, the robot's moved so that its tool is at the pose."""
        r, p = self.world.frames(q)
        turn = tool_r @ self._tool[0].T
        own = slice(self.world.scene.base[0] + 1, None)
        r[own] = turn @ r[own]
        p[own] = (p[own] - self._tool[1]) @ turn.T + tool_p
        return r, p

    def closed_on(self, grasp: Grasp, handle: NDArray[np.int64], handle_r: Array, handle_p: Array) -> Grasp | None:
        """The grasp, centred across the bar, with both sides' fingers on it; None if they cannot be."""
        for _ in range(2):
            tool_r, tool_p = grasp.tool(handle_r, handle_p)
            closed = self._close(handle, tool_r, tool_p)
            if closed is None:
                return None
            share, left, right = closed
            if len(self.limb.gripper.finger_joints) > 1 or abs(left - right) < TOUCH:
                break
            # The side that is farther (its distance larger) tells where the bar lies.
            grasp = replace(grasp, translation=grasp.translation + (right - left) / 2 * grasp.rotation[:, 1])
        fingers = tuple(
            (one.joint, _between(one, one_share))
            for one, one_share in zip(self.limb.gripper.finger_joints, share, strict=True)
        )
        return replace(grasp, fingers=fingers)

    def _close(
        self, handle: NDArray[np.int64], tool_r: Array, tool_p: Array
    ) -> tuple[list[float], float, float] | None:
        """Shares at which the fingers touch, and distances of the +y and −y sides there."""
        count = len(self.limb.gripper.finger_joints)
        if max(self._sides([0.0] * count, handle, tool_r, tool_p)) <= 0:
            return None
        if count == 1:
            share = self._bisect(lambda s: max(self._sides([s], handle, tool_r, tool_p)))
            if share is None:
                return None
            return [share], *self._sides([share], handle, tool_r, tool_p)
        shares = []
        for k in range(count):
            share = self._bisect(lambda s, k=k: self._one(k, s, count, handle, tool_r, tool_p))
            if share is None:
                return None
            shares.append(share)
        return shares, *self._sides(shares, handle, tool_r, tool_p)

    def _bisect(self, gap) -> float | None:  # noqa: ANN001 - share → distance, two kinds of lambda
        if gap(1.0) > TOUCH:
            return None
        low, high = 0.0, 1.0
        for _ in range(BISECTIONS):
            middle = (low + high) / 2
            if gap(middle) > TOUCH:
                low = middle
            else:
                high = middle
        return high

    def _one(
        self, k: int, share: float, count: int, handle: NDArray[np.int64], tool_r: Array, tool_p: Array
    ) -> float:
        """Distance to the handle of those fingers that joint k moves."""
        shares = [0.0] * count
        shares[k] = share
        scene = self.world.scene
        joint = self.limb.gripper.finger_joints[k].joint
        source = scene.coordinate[joint_iri(scene.robot.mechanism.name, joint)]
        r, p = self.placed(self._shares(shares), tool_r, tool_p)
        mine = [one for one in self.fingers if self._moved_by(int(self.world.boxes[0][one]), source)]
        return min(self.world.distance((int(f), int(h)), r, p) for f in mine for h in handle)

    def _moved_by(self, joint: int, source: int) -> bool:
        scene = self.world.scene
        while joint > 0:
            if scene.coupling.source[joint - 1] == source:
                return True
            joint = scene.model.parents[joint]
        return False

    def _shares(self, shares: list[float]) -> Array:
        joints = self.limb.gripper.finger_joints
        return self.configuration({one.joint: _between(one, s) for one, s in zip(joints, shares, strict=True)})

    def _sides(
        self, shares: list[float], handle: NDArray[np.int64], tool_r: Array, tool_p: Array
    ) -> tuple[float, float]:
        """Distances of the fingers on the +y and the −y side of the tool frame from the handle."""
        r, p = self.placed(self._shares(shares), tool_r, tool_p)
        joint, _, centre = self.world.boxes
        sides: list[list[float]] = [[], []]
        for f in self.fingers:
            at = tool_r.T @ (r[joint[f]] @ centre[f] + p[joint[f]] - tool_p)
            sides[0 if at[1] > 0 else 1].append(min(self.world.distance((int(f), int(h)), r, p) for h in handle))
        return min(sides[0], default=np.inf), min(sides[1], default=np.inf)


def _between(finger, share: float) -> float:  # noqa: ANN001 - FingerJoint
    return finger.open + share * (finger.closed - finger.open)
