"""One mechanism in the scene of one person: nodes that move with its joints."""

from collections.abc import Iterable, Mapping

import numpy as np
import viser
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from services.viewer.picture.looks import Colour, Looks

Array = NDArray[np.float64]

STILL = 1e-9
"""[m, 1] A frame that moved by less is not sent again."""


class Figure:
    """A mechanism, drawn.

    Args:
        scene: Of one person.
        name: Of its root node, `/robot` say.
        looks: What it looks like.
        one_colour: For all bodies, in place of their own.
        opacity: None: opaque.
    """

    def __init__(
        self,
        scene: viser.SceneApi,
        name: str,
        looks: Looks,
        *,
        one_colour: Colour | None = None,
        opacity: float | None = None,
    ) -> None:
        self.looks = looks
        self._colours = {body: one_colour or colour for body, colour in looks.colours.items()}
        root = scene.add_frame(name, show_axes=False)
        self._frames = [root]
        self._poses = [np.eye(4)]
        for k, frame in enumerate(looks.skeleton.frames, 1):
            path = f"{self._frames[frame.parent].name}/{k}"
            self._frames.append(scene.add_frame(path, show_axes=False))
            self._poses.append(np.eye(4))
        self.collision = self._meshes(scene, looks.collision, "collision", opacity)
        self.visual = self._meshes(scene, looks.visual, "visual", opacity)
        for mesh in self.visual.values():
            mesh.visible = False

    def _meshes(
        self, scene: viser.SceneApi, surfaces: Mapping, kind: str, opacity: float | None
    ) -> dict[str, viser.MeshHandle]:
        found: dict[str, viser.MeshHandle] = {}
        for number, (body, surface) in enumerate(surfaces.items()):
            if body not in self.looks.skeleton.carried:
                continue
            frame, frame_T_body = self.looks.skeleton.carried[body]
            position, wxyz = _pose(frame_T_body)
            found[body] = scene.add_mesh_simple(
                f"{self._frames[frame].name}/{kind}{number}",
                surface.vertices.astype(np.float32),
                surface.faces,
                color=self._colours[body],
                opacity=opacity,
                flat_shading=kind == "collision",
                side="front" if kind == "collision" else "double",
                cast_shadow=opacity is None,
                position=position,
                wxyz=wxyz,
            )
        return found

    def move(self, positions: Mapping[str, float], world_T_root: Array) -> None:
        """The mechanism stands there, in that posture."""
        for k, pose in enumerate((world_T_root, *self.looks.skeleton.local(positions))):
            if np.abs(pose - self._poses[k]).max() > STILL:
                self._poses[k] = pose
                self._frames[k].position, self._frames[k].wxyz = _pose(pose)

    def paint(self, bodies: Iterable[str], colour: Colour) -> None:
        """These bodies have that colour, and the others their own."""
        painted = set(bodies)
        for meshes in (self.collision, self.visual):
            for body, mesh in meshes.items():
                mesh.color = colour if body in painted else self._colours[body]

    def show(self, *, collision: bool, visual: bool) -> None:
        """Show what is judged, or what bodies look like; a body without looks shows what is judged."""
        for body, mesh in self.visual.items():
            mesh.visible = visual
            del body
        for body, mesh in self.collision.items():
            mesh.visible = collision or (visual and body not in self.visual)

    @property
    def visible(self) -> bool:
        """Whether any of it can be seen."""
        return bool(self._frames[0].visible)

    @visible.setter
    def visible(self, seen: bool) -> None:
        self._frames[0].visible = seen

    def remove(self) -> None:
        """Nothing of it is in the scene."""
        self._frames[0].remove()


def _pose(matrix: Array) -> tuple[tuple[float, float, float], tuple[float, float, float, float]]:
    x, y, z, w = map(float, Rotation.from_matrix(matrix[:3, :3]).as_quat())
    a, b, c = map(float, matrix[:3, 3])
    return (a, b, c), (w, x, y, z)
