"""A robot whose joints stand still on a base that drives, among a kitchen that stands still."""

import numpy as np
from numpy.typing import NDArray

from services.embodiment.body import kernels
from services.embodiment.body.standing import driving, extents, standing, turned
from services.embodiment.body.world import STRIDES, Rules, World

Array = NDArray[np.float64]

HEADINGS = 256  # that are kept; of a lattice, 16
CLEAR = 0.15  # [m] clearance beyond which it is not looked for more closely


class Parked:
    """Which base poses are free of contact between robot and kitchen; its own pairs are not looked at.

    Args:
        world: The scene.
        q: Scene configuration with the base at the origin, shape (nq,).
        rules: Distances demanded.
    """

    def __init__(self, world: World, q: Array, rules: Rules) -> None:
        assert not q[world.scene.base].any(), "the base is at the origin"
        r, c = np.empty((len(world.body), 3, 3)), np.empty((len(world.body), 3))
        kernels.place_boxes(*world.frames(q), world.boxes, r, c)
        split = world.split
        low, high = np.empty((split, 3)), np.empty((split, 3))
        extents(r[:split], c[:split], world.shapes, 0, low, high)
        self._own = r[split:].copy(), c[split:].copy()
        there = r[:split].copy(), c[:split].copy(), low, high
        rest = world.shapes, rules.environment, rules.largest
        self._scene = there, (0, world.scene.floor), *rest
        self._headings, self._robot, self._way = dict[float, int](), self._rows(HEADINGS), self._rows(1)
        # The floor is a plane: it is as far away wherever the robot stands.
        off, floor = np.empty(1, np.bool_), (world.scene.floor, split)
        start = np.zeros((1, 2)), np.array([self._heading(0.0)]), self._robot
        standing(*start, there, floor, *rest, off)
        self._off_floor = bool(off[0])
        away = np.linalg.norm(self._own[1][:, :2], axis=1)
        self._reach = float((away + world.radius[split:]).max(initial=0.0))

    def _rows(self, count: int) -> tuple[Array, Array, Array, Array]:
        """What `turned` writes to, for so many headings."""
        shapes = len(self._own[0])
        corners = np.empty((count, shapes + 1, 3)), np.empty((count, shapes + 1, 3))
        return np.empty((count, shapes, 3, 3)), np.empty((count, shapes, 3)), *corners

    def _heading(self, yaw: float) -> int:
        """The row that has the robot turned so; a lattice asks for a few of them many times."""
        row = self._headings.get(yaw)
        if row is None:
            row = self._headings[yaw] = len(self._headings)
            turned(yaw, self._own, self._scene[2], len(self._scene[0][0]), row, self._robot)
        return row

    def stands(self, poses: Array) -> NDArray[np.bool_]:
        """Whether the robot is free at each base pose, shape (K, 3)."""
        free = np.empty(len(poses), np.bool_)
        for k in range(0, len(poses), HEADINGS):
            some = poses[k : k + HEADINGS]
            if len(self._headings) + len(some) > HEADINGS:
                self._headings.clear()
            rows = np.array([self._heading(yaw) for yaw in some[:, 2].tolist()])
            places = np.ascontiguousarray(some[:, :2])
            standing(places, rows, self._robot, *self._scene, free[k : k + HEADINGS])
        return free & self._off_floor

    def drives(self, poses: Array) -> bool:
        """Whether the robot is free at all base poses, shape (K, 3); a few are looked at first."""
        few, poses = self.stands(poses[:: STRIDES[0]]), np.ascontiguousarray(poses)
        along = self._own, self._way, *self._scene, self._reach, CLEAR
        return bool(few.all()) and driving(poses, *along)
