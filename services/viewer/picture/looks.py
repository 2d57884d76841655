"""What a twin looks like: surfaces and colours of its bodies, and lines to draw in it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from sdt_kg.iri import Iri, body_iri, local_name
from sdt_kg.mechanism import JointType
from sdt_kg.twin import Twin
from services.viewer.picture.shapes import Surface
from services.viewer.picture.skeleton import Skeleton

Array = NDArray[np.float64]
Colour = tuple[int, int, int]

WALL: Final = (201, 203, 207)
FRONT: Final = (222, 206, 176)
HANDLE: Final = (92, 84, 74)
ROBOT: Final = (112, 140, 176)
HAND: Final = (58, 88, 130)
OFFENDING: Final = (205, 28, 28)
PATH: Final = (214, 32, 32)
REGION: Final = (226, 118, 0)
CLOSEST: Final = (232, 128, 0)

PATH_POINTS: Final = 33
ARC: Final = 0.18
"""[m] Radius of the arc that shows how far a hinge went beyond its limit."""


@dataclass(frozen=True, slots=True, eq=False)
class Looks:
    """One mechanism, ready to be drawn.

    Attributes:
        skeleton: How it moves.
        collision: Body name → what is judged.
        visual: Body name → what its URDF says that it looks like.
        colours: Body name → colour.
        note: What cannot be shown, and why; empty where all can.
    """

    skeleton: Skeleton
    collision: Mapping[str, Surface]
    visual: Mapping[str, Surface]
    colours: Mapping[str, Colour]
    note: str = ""

    def box(self) -> tuple[Array, Array]:
        """Lower and upper corner of its bodies with every joint at rest [m], in the root's frame."""
        placed = self.skeleton.placed({}, np.eye(4))
        corners = [
            surface.vertices @ at[:3, :3].T + at[:3, 3]
            for name, surface in self.collision.items()
            for frame, frame_T_body in (self.skeleton.carried[name],)
            for at in (placed[frame] @ frame_T_body,)
        ]
        points = np.concatenate(corners) if corners else np.zeros((1, 3))
        return points.min(axis=0), points.max(axis=0)


def kitchen_colours(twin: Twin) -> dict[str, Colour]:
    """Fronts that move, their handles, and the rest."""
    mechanism = twin.mechanism(twin.environment)
    fronts = {each.iri for each in twin.containers()}
    handles = {each.handle for each in twin.containers()}

    def colour(body: Iri) -> Colour:
        return HANDLE if body in handles else FRONT if body in fronts else WALL

    return {body.name: colour(body_iri(mechanism.name, body.name)) for body in mechanism.bodies}


def robot_colours(twin: Twin, robot: Iri) -> dict[str, Colour]:
    """Hands, and the rest."""
    hands = {body for gripper in twin.robot(robot).grippers for body in (*gripper.fingers, gripper.tool_body)}
    return {body.name: HAND if body.name in hands else ROBOT for body in twin.mechanism(robot).bodies}


def handle_path(  # noqa: PLR0913, PLR0917  # what moves, where and how finely
    looks: Looks,
    positions: Mapping[str, float],
    handle: str,
    joint: str,
    values: Array,
    points: int = PATH_POINTS,
) -> Array:
    """Where the middle of a handle goes as its container opens: points, shape (N, 3) [m].

    Args:
        looks: The kitchen's.
        positions: Joint name → position in the present state.
        handle: Name of the handle's body.
        joint: Name of the joint that the motion is of.
        values: Of that joint along the motion, shape (T,).
        points: N.
    """
    surface = looks.collision.get(handle)
    middle = np.append(np.zeros(3) if surface is None else surface.centre, 1.0)
    ways = np.interp(np.linspace(0, 1, points), np.linspace(0, 1, len(values)), values)
    frames = {frame.joint.name: frame.joint for frame in looks.skeleton.frames}
    mimic = frames[joint].mimic  # a joint that is listed moves the one that it follows, unless that is listed
    free = {
        name: at
        for name, at in positions.items()
        if frames[name].mimic is None and (mimic is None or name != mimic.joint)
    }
    found = [looks.skeleton.body(handle, {**free, joint: float(value)}, np.eye(4)) @ middle for value in ways]
    return np.array(found)[:, :3]


def segments(points: Array) -> Array:
    """A line through points (N, 3) as pieces, shape (N - 1, 2, 3)."""
    return np.stack((points[:-1], points[1:]), axis=1)


def limit_line(
    skeleton: Skeleton, positions: Mapping[str, float], world_T_root: Array, joint: Iri, bound: float
) -> Array:
    """From where a joint is to the limit that it passed: an arc about a hinge, a line along a slide.

    Returns:
        Points in the world, shape (N, 3) [m]; none where the joint is fixed or has no such frame.
    """
    name = local_name(joint)
    whole = skeleton.complete(positions)
    index = next((k for k, frame in enumerate(skeleton.frames, 1) if frame.joint.name == name), None)
    if index is None or math.isnan(bound):
        return np.zeros((0, 3))
    frame = skeleton.frames[index - 1]
    parent = skeleton.placed(positions, world_T_root)[frame.parent] @ frame.parent_T_joint
    axis = np.array(frame.joint.axis)
    ways = np.linspace(whole[name], bound, PATH_POINTS)
    if frame.joint.type is JointType.PRISMATIC:
        local = ways[:, None] * axis
    else:
        aside = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
        aside = aside / np.linalg.norm(aside)
        other = np.cross(axis, aside)
        local = ARC * (np.cos(ways)[:, None] * aside + np.sin(ways)[:, None] * other)
    return local @ parent[:3, :3].T + parent[:3, 3]
