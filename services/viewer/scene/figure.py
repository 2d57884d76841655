"""One mechanism in the scene of one person: nodes that move with its joints."""

from collections.abc import Iterable, Mapping

import numpy as np
import viser
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from services.viewer.picture.looks import Colour, Looks
from services.viewer.picture.shapes import Surface, joined

Array = NDArray[np.float64]

STILL = 1e-9
"""[m, 1] A frame that moved by less is not sent again."""

SWELL = 0.002
"""[m] By so much a body that is painted stands out."""


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
        self._scene, self._opacity = scene, opacity
        self._painted: list[viser.MeshHandle] = []
        self._last: tuple[frozenset[str], Colour] = (frozenset(), (0, 0, 0))
        self._collision: list[tuple[bool, viser.MeshHandle]] = []
        self._visual: list[viser.MeshHandle] = []
        self._build()

    def _build(self) -> None:
        """One node for all that moves together and has one colour: a browser is slow with many."""
        groups: dict[tuple[int, Colour, bool], list[str]] = {}
        for body in self.looks.collision:
            frame, _ = self.looks.skeleton.carried[body]
            groups.setdefault((frame, self._colours[body], body in self.looks.visual), []).append(body)
        for number, ((frame, colour, covered), bodies) in enumerate(groups.items()):
            surface = joined(self._in_frame(self.looks.collision[body], body) for body in bodies)
            node = self._mesh(f"{self._frames[frame].name}/c{number}", surface, colour, flat=True)
            self._collision.append((covered, node))
        for number, (body, surface) in enumerate(self.looks.visual.items()):
            if body in self.looks.skeleton.carried:
                name = f"{self._frames[self.looks.skeleton.carried[body][0]].name}/v{number}"
                node = self._mesh(name, self._in_frame(surface, body), self._colours[body], flat=False)
                node.visible = False
                self._visual.append(node)

    def _in_frame(self, surface: Surface, body: str) -> Surface:
        _, frame_T_body = self.looks.skeleton.carried[body]
        return Surface(surface.vertices @ frame_T_body[:3, :3].T + frame_T_body[:3, 3], surface.faces)

    def _mesh(
        self, name: str, surface: Surface, colour: Colour, *, flat: bool, opacity: float | None = None
    ) -> viser.MeshHandle:
        return self._scene.add_mesh_simple(
            name,
            surface.vertices.astype(np.float32),
            surface.faces,
            color=colour,
            opacity=self._opacity if opacity is None else opacity,
            flat_shading=flat,
            side="front" if flat else "double",
            cast_shadow=False,
            receive_shadow=False,
        )

    def move(self, positions: Mapping[str, float], world_T_root: Array) -> None:
        """The mechanism stands there, in that posture."""
        for k, pose in enumerate((world_T_root, *self.looks.skeleton.local(positions))):
            if np.abs(pose - self._poses[k]).max() > STILL:
                self._poses[k] = pose
                self._frames[k].position, self._frames[k].wxyz = _pose(pose)

    def paint(self, bodies: Iterable[str], colour: Colour) -> None:
        """These bodies have that colour, and the others their own."""
        wanted = frozenset(bodies) & self.looks.collision.keys(), colour
        if wanted == self._last:
            return
        self._last = wanted
        for node in self._painted:
            node.remove()
        self._painted = []
        for number, body in enumerate(sorted(wanted[0])):
            name = f"{self._frames[self.looks.skeleton.carried[body][0]].name}/p{number}"
            surface = self._in_frame(_swollen(self.looks.collision[body]), body)
            self._painted.append(self._mesh(name, surface, colour, flat=True, opacity=1.0))

    def show(self, *, collision: bool, visual: bool) -> None:
        """Show what is judged, or what bodies look like; a body without looks shows what is judged."""
        for node in self._visual:
            node.visible = visual
        for covered, node in self._collision:
            node.visible = collision or (visual and not covered)

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


def _swollen(surface: Surface) -> Surface:
    """The surface, a little larger, so that it is seen over what it covers."""
    centre = surface.centre
    away = surface.vertices - centre
    return Surface(centre + away + SWELL * np.sign(away), surface.faces)


def _pose(matrix: Array) -> tuple[tuple[float, float, float], tuple[float, float, float, float]]:
    x, y, z, w = map(float, Rotation.from_matrix(matrix[:3, :3]).as_quat())
    a, b, c = map(float, matrix[:3, 3])
    return (a, b, c), (w, x, y, z)
