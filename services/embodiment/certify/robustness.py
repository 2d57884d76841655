r"""Which errors of the base's pose and of the handle's place a certified motion tolerates.

A constant error moves the robot, or the handle, rigidly by at most e, wherever it points. What keeps a
distance keeps it then less e. Two convex shapes that touch when moved to four corners of a square touch
when moved anywhere within it, so a finger that presses on the handle from the four corners
:math:`\pm(\sqrt 2 e + engaged)` along x and z of the tool, on a way of at most `contact` - e, still does
after any error e. A tool whose way is displaced by e slips at most 2 e on a handle that turns, also as it
leaves it once the container rests. An error of yaw moves no point by more than itself times the point's
distance from the base; half of the room is left for that it also turns the hand. A base on wheels then
moves sideways by as much of its velocity more, if it drives where it did. Each figure is for its error
alone, and none says more than is shown.
"""

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sdt_kg.mechanism import JointType
from services.embodiment.certify.drive import DRIFT, SIDEWAYS
from services.embodiment.certify.findings import Findings
from services.embodiment.certify.held.hold import TURN, Hold
from services.embodiment.certify.sweep.pieces import velocities
from services.embodiment.certify.sweep.subject import Subject
from services.physics.model import Scene

PARTED = 3
"""[1] Halvings of a piece on which the tool's error is bounded."""

Array = NDArray[np.float64]
Figures = dict[str, tuple[float, str]]


def tolerated(holds: Sequence[Hold], found: Findings, reach: float) -> Figures:
    """Errors of handle [m] and base [m, rad] under which every check would still hold; see `reach_of`."""
    slips, turns = (min(most) for most in zip(*(hold.most for hold in holds), strict=True))
    left = np.min([_left(hold) for hold in holds], axis=0)
    room = min(*(hold.room for hold in holds), *found.slack.values())
    slip = min(slips - found.figures["tool slip"][0], float(left[0]))
    turn = min(turns - found.figures[TURN][0], float(left[1]))
    base = min(room, slip / 2)
    yaw = min(base / (2 * reach), turn / 2, _rolling(holds[0].checked, found.figures))
    return {
        "handle error tolerated": (max(room, 0.0), "m"),
        "base error tolerated": (max(base, 0.0), "m"),
        "base turn tolerated": (max(float(yaw), 0.0), "rad"),
    }


def _left(hold: Hold) -> tuple[float, float]:
    """By how much more the tool may be off [m, rad] as it leaves; else fingers had to be clear sooner."""
    after, tolerances = np.arange(hold.last + 1, hold.left), hold.tolerances
    if not len(after):
        return np.inf, np.inf
    parts = (after[:, None] << PARTED) + np.arange(1 << PARTED)
    away, turned = hold.slip.on(hold.timeline.depth + PARTED, parts.ravel())[2].max(axis=1).tolist()
    return tolerances.tool_position - away, tolerances.tool_angle - 2 * math.asin(min(turned / 2, 1.0))


def _rolling(checked: Subject, figures: Figures) -> float:
    """Error of yaw under which wheels still roll ahead [rad]; infinite where they roll to all sides."""
    if SIDEWAYS not in figures:
        return np.inf
    base, tolerances = checked.pieces.columns(checked.scene.base[:2]), checked.tolerances
    speed = np.linalg.norm(np.abs(velocities(base)[0]).max(axis=0), axis=1)
    room = tolerances.sideways - figures[SIDEWAYS][0], tolerances.drift - figures[DRIFT][0]
    most = float(speed.max()), float(speed @ base.duration)
    return min((left / gone for left, gone in zip(room, most, strict=True) if gone > 0), default=np.inf)


def reach_of(checked: Subject) -> float:
    """No point of the robot is farther from the base than this all along the motion [m]."""
    farthest = checked.pieces.farthest.tolist()
    links, joint, size = _lengths(checked.scene)
    away = np.zeros(checked.scene.model.njoints)
    for number, parent, step, slides in links:
        away[number] = away[parent] + step + (farthest[number - 1] if slides else 0.0)
    return float((away[joint] + size).max(initial=0.0))


@lru_cache(maxsize=8)
def _lengths(scene: Scene) -> tuple[list[tuple[int, int, float, bool]], NDArray[np.intp], Array]:
    """What is known of the robot's joints, and of its shapes; kept, so not to be changed.

    Number, parent, length of the link between [m] and whether it slides; then the joint of each shape, and
    the distance of its farthest point from that [m].
    """
    links = [
        (
            number,
            int(scene.model.parents[number]),
            float(np.linalg.norm(scene.model.jointPlacements[number].translation)),
            joint.type is JointType.PRISMATIC,
        )
        for number, joint in enumerate(scene.robot.joints, scene.robot.first + 1)
    ]
    robot = [one for one in scene.solids if one.joint >= scene.base[-1] + 1]
    sizes = [float(np.linalg.norm(one.centre)) + one.radius for one in robot]
    return links, np.array([one.joint for one in robot], dtype=np.intp), np.array(sizes)
