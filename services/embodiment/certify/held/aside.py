"""What moves besides the arms that hold: a head or another arm, brought out of the way."""

from collections.abc import Iterator, Sequence
from itertools import chain
from typing import Final

import numpy as np

from sdt_kg.iri import local_name
from services.embodiment.certify.held.hold import Hold
from services.embodiment.certify.sweep.pieces import Pieces
from services.physics.model import Scene

MOVES: Final = 1e-3
"""[rad or m] A joint that stays within this stands, as far as is told: robots measure no less."""


def moved_aside(scene: Scene, pieces: Pieces, holds: Sequence[Hold]) -> Iterator[str]:
    """Which joints of the robot move that neither carry a gripper that holds nor hang on it, if any do."""
    of_holding = {joint for hold in holds for joint in _arm(scene, hold)}
    every = range(scene.robot.first, scene.robot.first + len(scene.robot.joints))
    free = (k for k in every if scene.coupling.source[k] == k and k + 1 not in of_holding)
    moving = [local_name(scene.names[k]) for k in free if float(np.ptp(pieces.of(k))) > MOVES]
    if moving:
        grippers = " and ".join(dict.fromkeys(hold.gripper.name for hold in holds))
        yield f"besides gripper {grippers} and what carries it these joints move: {', '.join(moving)}"


def _arm(scene: Scene, hold: Hold) -> Iterator[int]:
    """Joints of the model from the base to the one that carries the tool, and all that hang on that."""
    tool = scene.model.frames[scene.model.getFrameId(scene.tool_frame(hold.gripper.name))].parentJoint
    return chain(scene.model.supports[tool], scene.model.subtrees[tool])
