"""What moves, when: a body motion as positions of the joints of the trees that are drawn."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from sdt_kg.iri import Iri
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.twin import Twin
from services.embodiment.certify.motion import whole_motion
from services.embodiment.certify.tolerances import Tolerances
from services.physics.chain import follower
from services.physics.model import Scene
from services.physics.replay import state_with, velocities_of
from services.physics.tree import Model
from services.reports.scene.camera import Camera, beside
from services.reports.scene.tree import Tree

Array = NDArray[np.float64]

FRAMES = 120
"""[1] Pictures of a motion; a page draws those between them on a straight line."""


@dataclass(frozen=True, slots=True, eq=False)
class Line:
    """A path or a gap.

    Attributes:
        points: Shape (P, 3), in the kitchen's root frame [m].
        label: What it is.
        color: Name in `colors.COLORS`.
    """

    points: Array
    label: str
    color: str = "path"


@dataclass(frozen=True, slots=True, eq=False)
class Clip:
    """One motion, or one posture.

    Attributes:
        name: As people choose it.
        robot: Name of the robot's tree; empty where no robot is shown.
        times: Shape (T,) [s]; one for a posture.
        joints: IRIs of the joints that are not at rest.
        values: Their positions, shape (T, n).
        phases: (name, begin [s]).
        red: IRIs of bodies that are to be seen first.
        ghost: Whether the robot is drawn see-through, for a posture that was not certified.
        lines: What is drawn besides.
        note: One sentence below the picture.
        camera: From where it is seen at first; None: all of the kitchen.
    """

    name: str
    robot: str
    times: Array
    joints: tuple[Iri, ...] = ()
    values: Array = field(default_factory=lambda: np.zeros((1, 0)))
    phases: tuple[tuple[str, float], ...] = ()
    red: frozenset[Iri] = frozenset()
    ghost: bool = False
    lines: tuple[Line, ...] = ()
    note: str = ""
    camera: Camera | None = None

    def positions(self, tree: Tree, time: float | None = None) -> Array:
        """Positions of a tree's joints at a time [s], its end where none is given; shape (J,)."""
        q = tree.rest.copy()
        at = self.times[-1] if time is None else time
        for column, joint in enumerate(self.joints):
            if joint in tree.joints:
                q[tree.joints.index(joint)] = np.interp(at, self.times, self.values[:, column])
        return q


def body_clip(name: str, scene: Scene, motion: BodyMotion, note: str = "", frames: int = FRAMES) -> Clip:
    """A robot's motion with what it moves, between its samples too.

    Raises:
        MotionError: It is no motion.
        UnknownEntityError: The robot or the kitchen has no such movable joint.
    """
    pieces, _ = whole_motion(scene, motion, Tolerances())
    times = np.linspace(motion.times[0], motion.times[-1], frames)
    at = np.clip(np.searchsorted(pieces.start, times, side="right") - 1, 0, len(pieces.start) - 1)
    q = scene.coupling.positions(pieces.at(at, times - pieces.start[at])[0])
    rest = scene.q(scene.twin.kitchen().start, {})
    moving = np.flatnonzero(np.abs(q - rest).max(axis=0) > 0)
    return Clip(
        name,
        scene.robot.mechanism.name,
        times - times[0],
        tuple(scene.names[k] for k in moving),
        q[:, moving],
        tuple((phase, float(motion.times[first] - motion.times[0])) for phase, first in motion.phases),
        note=note,
        camera=_camera(scene, motion, q, times),
    )


def _camera(scene: Scene, motion: BodyMotion, q: Array, times: Array) -> Camera:
    """From beside the robot, where it is once it has driven."""
    begin = next((motion.times[first] for phase, first in motion.phases if phase != "drive"), times[0])
    names = [each.name for each in scene.annotation.grippers]
    frame = scene.tool_frame(motion.gripper or names[0])
    work = q[times >= begin] if (times >= begin).any() else q[-1:]
    tool = np.array([scene.placement(each, frame).translation for each in work[:: max(1, len(work) // 8)]])
    start = scene.twin.kitchen().start
    return beside(tool, q[-1, scene.base[:2]], (start[0], start[1]))


def container_clip(name: str, model: Model, twin: Twin, motion: Motion, note: str = "") -> Clip:
    """A container's motion alone: nobody is there who would move it."""
    times = np.linspace(motion.times[0], motion.times[-1], FRAMES // 2)
    own = CubicHermiteSpline(motion.times, motion.values[:, 0], velocities_of(motion)[:, 0])(times)
    followed = follower(model, motion.of)
    states = [
        state_with(model, twin, followed.active, (value - followed.offset) / followed.multiplier)
        for value in own
    ]
    moving = tuple(joint for joint in states[0] if any(each[joint] != twin.state[joint] for each in states))
    positions = np.array([[state[joint] for joint in moving] for state in states]).reshape(len(times), -1)
    return Clip(name, "", times - times[0], moving, positions, note=note)


def posture_clip(name: str, scene: Scene, q: Array, note: str = "") -> Clip:
    """One posture of robot and kitchen, q of shape (nq,)."""
    return Clip(name, scene.robot.mechanism.name, np.zeros(1), scene.names, q[None], note=note)
