"""A motion certified in one world is certified in another: what the edit does not touch is not swept twice.

Sound, since a sweep is over pairs of shapes: a pair of which neither shape, nor the motion of either,
differs keeps the distance that it was certified to keep. Everything else is checked anew: the scope of D,
Causes and SatisfiesRequest in the other world, start, limits, drive, the hold, the pairs with the handle,
and every pair with a shape that the edit touches.
"""

from copy import copy
from dataclasses import dataclass
from typing import Final

import numpy as np

from predicates.case import Answer, Case
from predicates.oracle import Embodiment
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError, OracleRejectedError
from sdt_kg.iri import Iri
from sdt_kg.motion import BodyMotion
from sdt_kg.twin import Container, Twin
from services.app import Service
from services.codesign.touched import Touched
from services.embodiment.certify.check import Certified, certify
from services.embodiment.oracle import WholeBody
from services.embodiment.setting import container_of
from services.physics.model import Scene

FREEDOM: Final = (Drive.FIXED, Drive.DIFFERENTIAL, Drive.OMNI)
"""Each base moves as those before it can, and otherwise too."""


@dataclass(frozen=True, slots=True)
class Swept:
    """How much was swept.

    Attributes:
        pairs: Of shapes that were swept in the other world.
        of: All pairs of shapes that a certificate is about.
    """

    pairs: int
    of: int


class Again:
    """The Embodiment protocol for one motion that is certified in another world under the same policy.

    Attributes:
        swept: Of the last question.
    """

    version = "certified again, sweeping what is touched"

    def __init__(self, oracle: WholeBody, touched: Touched) -> None:
        self._oracle, self._touched = oracle, touched
        self.swept = Swept(0, 0)

    def settings(self, twin: Twin, robot: Iri) -> tuple[tuple[str, str], ...]:
        return self._oracle.settings(twin, robot)

    def perform(self, case: Case) -> Answer:
        if not isinstance(case.body_motion, BodyMotion) or not isinstance(case.robot, str):
            raise OracleRejectedError("a motion is certified again, and there is none")
        container, oracle = container_of(case), self._oracle
        scene, self.swept = narrowed(oracle.scene(case.twin, case.robot), self._touched, container)
        outcome = certify(
            case.twin,
            case.robot,
            case.body_motion,
            container,
            oracle.tolerances,
            drive=oracle.drive or case.twin.robot(case.robot).drive,
            start=oracle.start_pose(case),
            scene=scene,
        )
        if isinstance(outcome, Certified):
            return Answer(case, True)
        return Answer(case, False, outcome.diagnoses)


def whole_body(service: Service) -> WholeBody:
    """Who finds and certifies body motions for a service.

    Raises:
        InputError: That is not this process.
    """
    oracle = service.embodiment
    if not isinstance(oracle, WholeBody):
        from services.dynamics.robot.bearing import Bearing  # noqa: PLC0415 - only where forces are asked about

        oracle = oracle.inner if isinstance(oracle, Bearing) else oracle
    if not isinstance(oracle, WholeBody):
        raise InputError(
            "grids and changes that nobody names are judged in process, and oracles elsewhere answer here",
            allowed="oracles of this process",
            remedy="name an edit, without a grid",
        )
    return oracle


def has_forces(service: Service) -> bool:
    """Whether the robot must bear forces, of which no search in another world says anything."""
    return whole_body(service) is not service.embodiment


def as_asked(service: Service, again: Again) -> Embodiment:
    """Who certifies again: with the forces that must be borne, where the service asks for them."""
    if not has_forces(service):
        return again
    from services.dynamics.robot.bearing import Bearing  # noqa: PLC0415 - only where forces are asked about

    return Bearing(again)


def narrowed(scene: Scene, touched: Touched, container: Container) -> tuple[Scene, Swept]:
    """The scene with those pairs only that an edit touches, and those with the handle; and how many."""
    other, of = copy(scene), len(scene.self_pairs) + len(scene.environment_pairs)
    if not touched.robot:
        again = {*touched.bodies, container.handle}
        kept = [one.body in again for one in scene.solids]
        other.self_pairs = scene.self_pairs[:0]
        other.environment_pairs = scene.environment_pairs[np.array(kept)[scene.environment_pairs[:, 1]]]
    return other, Swept(len(other.self_pairs) + len(other.environment_pairs), of)
