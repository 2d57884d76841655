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
from sdt_kg.annotation import Drive
from sdt_kg.errors import OracleRejectedError
from sdt_kg.iri import Iri
from sdt_kg.motion import BodyMotion
from sdt_kg.twin import Container, Twin
from services.app import Policy
from services.codesign.touched import Touched
from services.embodiment.certify.check import Certified, certify
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.oracle import WholeBody, container_of
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

    def __init__(self, oracle: WholeBody, policy: Policy, scene: Scene, touched: Touched) -> None:
        self.oracle, self.policy, self.scene, self.touched = oracle, policy, scene, touched
        self.swept = Swept(0, 0)

    def settings(self, twin: Twin, robot: Iri) -> tuple[tuple[str, str], ...]:
        return self.oracle.settings(twin, robot)

    def perform(self, case: Case) -> Answer:
        if not isinstance(case.body_motion, BodyMotion) or not isinstance(case.robot, str):
            raise OracleRejectedError("a motion is certified again, and there is none")
        container = container_of(case)
        scene, self.swept = narrowed(self.scene, self.touched, container)
        outcome = certify(
            case.twin,
            case.robot,
            case.body_motion,
            container,
            self.oracle.tolerances,
            drive=drive_of(self.policy, case.twin, case.robot),
            start=start_of(self.policy, self.scene, container),
            scene=scene,
        )
        if isinstance(outcome, Certified):
            return Answer(case, True)
        return Answer(case, False, outcome.diagnoses)


def narrowed(scene: Scene, touched: Touched, container: Container) -> tuple[Scene, Swept]:
    """The scene with those pairs only that an edit touches, and those with the handle; and how many."""
    other, of = copy(scene), len(scene.self_pairs) + len(scene.environment_pairs)
    if not touched.robot:
        again = {*touched.bodies, container.handle}
        kept = [one.body in again for one in scene.solids]
        other.self_pairs = scene.self_pairs[:0]
        other.environment_pairs = scene.environment_pairs[np.array(kept)[scene.environment_pairs[:, 1]]]
    return other, Swept(len(other.self_pairs) + len(other.environment_pairs), of)


def drive_of(policy: Policy, twin: Twin, robot: Iri) -> Drive:
    """How the base moves under a policy."""
    return policy.drive or twin.robot(robot).drive


def start_of(policy: Policy, scene: Scene, container: Container) -> tuple[float, float, float]:
    """Where the robot starts under a policy: as told, else at the kitchen's pose, turned to the handle."""
    if policy.base is not None:
        return policy.base
    x, y, _ = scene.twin.kitchen().start
    handle = scene.placement(scene.q((0.0, 0.0, 0.0), {}), container.handle).translation
    return x, y, float(np.arctan2(handle[1] - y, handle[0] - x))


def tolerances_of(policy: Policy) -> Tolerances:
    """What a certificate allows under a policy."""
    return WholeBody(contact=policy.contact).tolerances
