"""A view on paper: shaded triangles by a depth buffer, edges and paths as an engineer draws them."""

import math

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from services.reports.scene.clip import Clip
from services.reports.scene.colors import COLORS
from services.reports.scene.raster import fill, stroke
from services.reports.scene.view import View

Array = NDArray[np.float64]

LIGHT = np.array([0.36, 0.48, 0.80])
AMBIENT, DIRECT, UPWARD = 0.64, 0.20, 0.16
"""[1] As in viewer.js."""

NEAR_EDGE = 0.01
"""[1] By how much of its depth an edge may lie behind the surface that it bounds."""

EDGE = np.array([0.25, 0.25, 0.27])


def draw(axes: Axes, view: View, clip: Clip, time: float | None = None, width: int = 1400) -> None:
    """A moment of a clip, as it is seen at first in a page.

    Args:
        axes: Filled by the picture.
        view: What is shown.
        clip: One of its clips.
        time: Along the clip [s]; None: its end.
        width: Of the picture [px].
    """
    camera = clip.camera or view.camera
    height = width // 2
    near, scale = camera.distance - camera.reach, height / 2 / math.tan(camera.angle / 2)
    color, depth = np.full((height, width, 3), 1.0), np.full((height, width), np.inf)
    for tree in view.trees:
        if tree.is_robot and tree.name != clip.robot:
            continue
        frames = tree.frames(clip.positions(tree, time))
        for body in tree.bodies:
            mesh = body.mesh.placed(frames[body.joint])
            kind = "red" if body.iri in clip.red else view.kind(tree, body.iri)
            seen = camera.seen(mesh.vertices)
            shades = _shaded(mesh.vertices[mesh.faces], COLORS[kind])
            fill(color, depth, seen[mesh.faces], shades, near, scale)
            stroke(color, depth, seen[mesh.edges], EDGE, near, scale, NEAR_EDGE)
    axes.imshow(color, extent=(-2.0, 2.0, -1.0, 1.0), interpolation="antialiased", aspect="equal")
    for line in (*view.lines, *clip.lines):
        right, up, depth = camera.screen(line.points).T
        right, up = (np.where(depth > near, each, np.nan) for each in (right, up))
        axes.plot(right, up, color=COLORS[line.color], linewidth=1.0, solid_capstyle="round")
    axes.set(xlim=(-2.0, 2.0), ylim=(-1.0, 1.0))
    axes.set_axis_off()


def _shaded(corners: Array, color: tuple[float, float, float]) -> Array:
    """Colour of each triangle, shape (F, 3)."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    light = AMBIENT + DIRECT * np.abs(normal @ LIGHT) + UPWARD * np.abs(normal[:, 2])
    return light[:, None] * np.array(color)
