"""The scene of one person: kitchen, robot, ghost, paths and marks."""

from collections.abc import Iterable, Sequence
from textwrap import fill

import numpy as np
import viser
from numpy.typing import NDArray

from sdt_kg.annotation import RobotAnnotation
from sdt_kg.iri import Iri, body_iri, joint_iri, local_name
from services.viewer.judging.question import Opening
from services.viewer.picture.looks import (
    CLOSEST,
    OFFENDING,
    PATH,
    REGION,
    Colour,
    Looks,
    handle_path,
    limit_line,
    segments,
)
from services.viewer.picture.marks import Box, Mark, What
from services.viewer.picture.skeleton import base_pose
from services.viewer.picture.standing import Pose2, kitchen_positions, parked
from services.viewer.picture.timeline import Posture
from services.viewer.scene.figure import Figure

Array = NDArray[np.float64]

THICK = 0.012
"""[m] Of a line."""
GHOST = 0.35
"""[1] Opacity of a ghost."""
BELOW = -0.002
"""[m] Height of the grid, so that it does not show through the floor."""
LABEL = 40
"""[1] Letters in a line of a label: what is looked at is in the middle, so it fits between the panels."""


class Stage:
    """What one person sees."""

    def __init__(self, client: viser.ClientHandle) -> None:
        self._client, self._scene = client, client.scene
        self._kitchen: Figure | None = None
        self._robot: Figure | None = None
        self._ghost: Figure | None = None
        self._annotation: RobotAnnotation | None = None
        self._paths: list[viser.SceneNodeHandle] = []
        self._marks: list[viser.SceneNodeHandle] = []
        self._seen = (True, False)
        self._stood: Pose2 = (0.0, 0.0, 0.0)

    def furnish(self, kitchen: Looks, robot: Looks, annotation: RobotAnnotation) -> bool:
        """Whether the kitchen is another one; kitchen and robot are these now, and what is the same stays."""
        other = self._kitchen is None or self._kitchen.looks is not kitchen
        with self._client.atomic():
            if other:
                self._kitchen = self._replaced(self._kitchen, "/kitchen", kitchen)
                self._lay_floor(kitchen)
            if self._robot is None or self._robot.looks is not robot:
                self._robot = self._replaced(self._robot, "/robot", robot)
                self._annotation = annotation
                if self._ghost is not None:
                    self._ghost.remove()
                    self._ghost = None
            self.show(*self._seen)
        return other

    def _replaced(self, old: Figure | None, name: str, looks: Looks) -> Figure:
        if old is not None:
            old.remove()
        return Figure(self._scene, name, looks)

    def _lay_floor(self, kitchen: Looks) -> None:
        low, high = kitchen.box()
        middle, side = (low + high) / 2, 2 * float(np.ceil(max(high[0] - low[0], high[1] - low[1], 2.0)))
        self._scene.add_grid("/floor", side, side, plane="xy", position=(middle[0], middle[1], BELOW))

    def look(self, place: Array, thing: Array) -> None:
        """The camera stands at a point (3,) [m] and looks at another."""
        camera = self._client.camera
        camera.position = (float(place[0]), float(place[1]), float(place[2]))
        camera.look_at = (float(thing[0]), float(thing[1]), float(thing[2]))

    def show(self, collision: bool, visual: bool) -> None:
        """Show what is judged, what bodies look like, or both."""
        self._seen = collision, visual
        for figure in (self._kitchen, self._robot):
            if figure is not None:
                figure.show(collision=collision, visual=visual)

    def pose(self, posture: Posture) -> None:
        """Everything is where the posture says; a robot that it does not speak of stays where it stood."""
        if self._kitchen is None or self._robot is None:
            return
        self._stood = posture.base or self._stood
        with self._client.atomic():
            joints = kitchen_positions(self._kitchen.looks.skeleton, posture.kitchen)
            self._kitchen.move(joints, np.eye(4))
            self._move(self._robot, self._stood, posture.robot)

    def _move(self, figure: Figure, base: Pose2, joints: dict[str, float]) -> None:
        assert self._annotation is not None, "furnished"
        world_T_root = base_pose(figure.looks.skeleton, self._annotation, base)
        figure.move(parked(self._annotation, joints), world_T_root)

    def ghost(self, posture: Posture | None, bodies: Iterable[Iri] = ()) -> None:
        """A posture stays to be seen, the offending links red in it; None: none does."""
        if posture is None or posture.base is None:
            if self._ghost is not None:
                self._ghost.visible = False
            return
        if self._robot is None:
            return
        if self._ghost is None:
            self._ghost = Figure(
                self._scene, "/ghost", self._robot.looks, one_colour=(224, 120, 110), opacity=GHOST
            )
        self._ghost.visible = True
        self._move(self._ghost, posture.base, posture.robot)
        self._ghost.paint(_own(self._ghost, bodies), OFFENDING)

    def paint(self, bodies: Sequence[Iri], colour: Colour = OFFENDING) -> None:
        """These bodies stand out, and no others."""
        for figure in (self._kitchen, self._robot):
            if figure is not None:
                figure.paint(_own(figure, bodies), colour)

    def paths(self, openings: Sequence[Opening], positions: dict[Iri, float], *, seen: bool) -> None:
        """The handle of each container that can be opened has its way drawn in red."""
        for node in self._paths:
            node.remove()
        self._paths = []
        if self._kitchen is None or not seen:
            return
        looks = self._kitchen.looks
        joints = kitchen_positions(looks.skeleton, positions)
        lines = [
            segments(handle_path(looks, joints, local_name(each.handle), local_name(each.joint), each.values))
            for each in openings
        ]
        if lines:
            points = np.concatenate(lines).astype(np.float32)
            self._paths.append(self._scene.add_line_segments("/paths", points, PATH, thickness=THICK))

    def marks(self, marks: Sequence[Mark], posture: Posture) -> None:
        """What is to be looked at is drawn: nearest points, limits, regions; nothing else."""
        for node in self._marks:
            node.remove()
        self._marks = []
        for number, mark in enumerate(marks):
            points = self._line(mark, posture)
            colour = CLOSEST if mark.what is What.NEAREST else OFFENDING
            if len(points) > 1:
                self._draw(f"/marks/{number}", points, colour)
            place = points[len(points) // 2] if len(points) else None
            for k, box in enumerate(mark.boxes):
                self._marks.append(self._boxed(f"/marks/{number}_{k}", box))
                place = np.array(box.middle)
            if place is not None:
                text = self._scene.add_label(
                    f"/marks/{number}/label",
                    fill(mark.text, LABEL),
                    position=place,
                    font_screen_scale=0.9,
                    anchor="bottom-center",
                )
                self._marks.append(text)

    def _line(self, mark: Mark, posture: Posture) -> Array:
        if mark.ends is not None:
            return np.array(mark.ends)
        if mark.joint is None or self._robot is None or self._kitchen is None or self._annotation is None:
            return np.zeros((0, 3))
        skeleton = self._robot.looks.skeleton
        if mark.joint.startswith(joint_iri(skeleton.mechanism.name, "")):
            at = base_pose(skeleton, self._annotation, posture.base or self._stood)
            joints = parked(self._annotation, posture.robot)
            return limit_line(skeleton, joints, at, mark.joint, mark.bound)
        skeleton = self._kitchen.looks.skeleton
        joints = kitchen_positions(skeleton, posture.kitchen)
        return limit_line(skeleton, joints, np.eye(4), mark.joint, mark.bound)

    def _draw(self, name: str, points: Array, colour: Colour) -> None:
        apart = float(np.linalg.norm(points[-1] - points[0]))
        if len(points) == 2 and apart < THICK:  # a line too short to be seen
            ball = self._scene.add_icosphere(f"{name}/ball", THICK, color=colour, position=points[0])
            self._marks.append(ball)
        lines = segments(points).astype(np.float32)
        self._marks.append(self._scene.add_line_segments(f"{name}/line", lines, colour, thickness=THICK))

    def _boxed(self, name: str, box: Box) -> viser.SceneNodeHandle:
        x, y, z, w = box.orientation
        return self._scene.add_box(
            name, color=REGION, dimensions=box.sides, opacity=0.5, position=box.middle, wxyz=(w, x, y, z)
        )


def _own(figure: Figure, bodies: Iterable[Iri]) -> list[str]:
    """Names of those bodies that the figure has."""
    stem = body_iri(figure.looks.skeleton.mechanism.name, "")
    return [local_name(body) for body in bodies if body.startswith(stem)]
