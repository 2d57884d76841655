"""A kitchen's shapes as arrays, for those that compare all of them at once."""

from collections.abc import Sequence

import numpy as np

from services.physics.geometry.bodies import BodyShape


class Shapes:
    """A kitchen's shapes, and where their boxes are in their joints' frames as arrays.

    Attributes:
        joint: Shape (S,).
        rotation, centre, half: Shape (S, 3, 3), (S, 3), (S, 3); see `BodyShape`.
    """

    def __init__(self, every: Sequence[BodyShape]) -> None:
        self.all = every
        self.joint = np.array([each.joint for each in every], np.intp)
        self.rotation = np.array([each.rotation for each in every]).reshape(-1, 3, 3)
        self.centre = np.array([each.centre for each in every]).reshape(-1, 3)
        self.half = np.array([each.half for each in every]).reshape(-1, 3)
