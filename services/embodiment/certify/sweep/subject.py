"""What is being checked: a scene, one motion in it, and everything derived from both."""

from dataclasses import dataclass

from services.embodiment.certify.sweep.kinematics import Kinematics
from services.embodiment.certify.sweep.pieces import Pieces, Timeline
from services.embodiment.certify.sweep.shapes import Shapes
from services.embodiment.certify.tolerances import Tolerances
from services.physics.model import Scene


@dataclass(frozen=True, slots=True, eq=False)
class Subject:
    """A motion under certification.

    Attributes:
        pieces: Of all coordinates.
        timeline: Of the moving coordinates, those of `kinematics`.
    """

    scene: Scene
    tolerances: Tolerances
    pieces: Pieces
    kinematics: Kinematics
    shapes: Shapes
    timeline: Timeline


def subject(scene: Scene, pieces: Pieces, tolerances: Tolerances) -> Subject:
    """Kinematics, shapes and timeline of the coordinates that this motion moves."""
    moving = pieces.moving
    kinematics = Kinematics(scene, pieces.c[0, 0], moving)
    shapes, timeline = Shapes(scene, kinematics), Timeline(pieces.moved)
    return Subject(scene, tolerances, pieces, kinematics, shapes, timeline)
