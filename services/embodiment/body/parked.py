"""A robot whose joints stand still on a base that drives, among a kitchen that stands still."""

import numpy as np
from numpy.typing import NDArray

from services.embodiment.body import kernels
from services.embodiment.body.standing import driving, extents, standing
from services.embodiment.body.world import COARSE, Rules, World

Array = NDArray[np.float64]

CLEAR = 0.5  # [m] clearance beyond which it is not looked for more closely


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
        own, there = (r[split:].copy(), c[split:].copy()), (r[:split].copy(), c[:split].copy(), low, high)
        rest = world.shapes, rules.environment, rules.largest
        self._scene = own, there, (0, world.scene.floor), *rest
        # The floor is a plane: it is as far away wherever the robot stands.
        off, floor = np.empty(1, np.bool_), (world.scene.floor, split)
        standing(np.zeros((1, 3)), own, there, floor, *rest, off)
        self._off_floor = bool(off[0])
        self._reach = float((np.linalg.norm(own[1][:, :2], axis=1) + world.radius[split:]).max(initial=0.0))

    def stands(self, poses: Array) -> NDArray[np.bool_]:
        """Whether the robot is free at each base pose, shape (K, 3)."""
        free = np.empty(len(poses), np.bool_)
        standing(np.ascontiguousarray(poses), *self._scene, free)
        return free & self._off_floor

    def drives(self, poses: Array) -> bool:
        """Whether the robot is free at all base poses, shape (K, 3); a few are looked at first."""
        few, poses = self.stands(poses[:: COARSE[0]]), np.ascontiguousarray(poses)
        return bool(few.all()) and driving(poses, *self._scene, self._reach, CLEAR)
