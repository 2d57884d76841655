"""What one person can drag in the scene: the base's start pose, and a box that stands in the way."""

import math
from collections.abc import Callable
from typing import Final

import viser

from services.viewer.choice import Obstacle

BROWN: Final = (150, 104, 62)
BASE: Final = "/gizmo/base"
BOX: Final = "/gizmo/box"

Told = Callable[[str], None]


class Gizmos:
    """Handles in the scene of one person.

    Args:
        scene: Of that person.
        tell: Called with `base dragged` or `box dragged` when one was let go.
    """

    def __init__(self, scene: viser.SceneApi, tell: Told) -> None:
        self._scene, self._tell = scene, tell
        self._base: viser.TransformControlsHandle | None = None
        self._box: viser.TransformControlsHandle | None = None
        self._size = (0.0, 0.0, 0.0)

    def base(self, pose: tuple[float, float, float] | None) -> None:
        """The base can be dragged from this pose; None: it cannot be dragged."""
        if pose is None:
            if self._base is not None:
                self._base.remove()
                self._base = None
            return
        if self._base is None:
            self._base = self._added(BASE, "base dragged")
        self._base.position = (pose[0], pose[1], 0.05)
        self._base.wxyz = (math.cos(pose[2] / 2), 0.0, 0.0, math.sin(pose[2] / 2))

    def base_pose(self) -> tuple[float, float, float]:
        """Where the base was dragged to: x, y [m], yaw [rad]."""
        assert self._base is not None, "it was dragged"
        return _planar(self._base)

    def box(self, obstacle: Obstacle | None) -> None:
        """The box stands there and can be dragged; None: there is none."""
        if self._box is not None and (obstacle is None or obstacle.size != self._size):
            self._box.remove()
            self._box = None
        if obstacle is None:
            return
        if self._box is None:
            self._box, self._size = self._added(BOX, "box dragged"), obstacle.size
            self._scene.add_box(f"{BOX}/body", color=BROWN, dimensions=obstacle.size, opacity=0.9)
        self._box.position = (obstacle.x, obstacle.y, obstacle.bottom + obstacle.size[2] / 2)
        self._box.wxyz = (math.cos(obstacle.yaw / 2), 0.0, 0.0, math.sin(obstacle.yaw / 2))

    def box_pose(self) -> tuple[float, float, float]:
        """Where the box was dragged to: x, y [m], yaw [rad]."""
        assert self._box is not None, "it was dragged"
        return _planar(self._box)

    def _added(self, name: str, event: str) -> viser.TransformControlsHandle:
        gizmo = self._scene.add_transform_controls(
            name, scale=0.5, active_axes=(True, True, False), depth_test=False
        )

        async def tell(dragged: viser.TransformControlsEvent) -> None:
            if dragged.phase == "end":
                self._tell(event)

        gizmo.on_update(tell)
        return gizmo


def _planar(gizmo: viser.TransformControlsHandle) -> tuple[float, float, float]:
    w, _, _, z = map(float, gizmo.wxyz)
    return (
        round(float(gizmo.position[0]), 4),
        round(float(gizmo.position[1]), 4),
        round(2 * math.atan2(z, w), 4),
    )
