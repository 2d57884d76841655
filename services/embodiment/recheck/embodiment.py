"""CanPerform of one body motion, under the conditions of its certificate: only checked, never searched."""

import math
from functools import cached_property

import numpy as np

from predicates.case import Answer, Case, Quantity
from predicates.record.inputs import ANY_START, NEAREST, TURNED, pose_text
from sdt_kg.errors import OracleRejectedError
from sdt_kg.iri import Iri
from sdt_kg.motion import Array, BodyMotion
from sdt_kg.twin import Twin
from services.embodiment.certify.certificate import Certificate
from services.embodiment.certify.check import Certified, certify
from services.embodiment.floor import check_base, check_floor
from services.physics.model import Scene

ROUNDING = 1e-9  # [rad] by which two who compute it differ in where a handle is


class Certifier:
    """The Embodiment protocol for the motion of a certificate.

    Args:
        twin: The kitchen in the state in which the motion begins, and its robot.
        certificate: Drive, start pose and tolerances are its own.
    """

    version = "recheck"

    def __init__(self, twin: Twin, certificate: Certificate) -> None:
        self.twin, self.certificate = twin, certificate

    @cached_property
    def scene(self) -> Scene:
        """Shapes and kinematics of the twin; InputError where no question about it is judged."""
        scene = Scene(self.twin, self.certificate.robot)
        check_floor(scene)
        check_base(scene, self.certificate.drive)
        return scene

    def settings(self, twin: Twin, robot: Iri) -> tuple[tuple[str, str], ...]:
        del twin, robot
        one = self.certificate
        return (("drive", one.drive.value), ("tolerances", repr(one.tolerances)))

    def starts_as(self, text: str | None) -> bool:
        """Whether the certificate's start pose is what a verdict's input `start` says."""
        start = self.certificate.start
        if start is None or text is None:
            return start is None and text == ANY_START
        x, y, yaw = start
        if not text.endswith(TURNED):
            return text == pose_text(x, y, yaw)
        handle = self.certificate.held_in(self.twin).handle
        at = self.scene.placement(self.scene.q((0.0, 0.0, 0.0), {}), handle).translation
        if not faces(start, at):
            return False
        return is_at(start, text) or (NEAREST in text and self._moved_from(text, at))

    def _moved_from(self, text: str, handle: Array) -> bool:
        """Whether the parked robot cannot stand at the start pose in the text, turned to the handle."""
        x, y = map(float, text.split(", ")[:2])
        base = np.tile((x, y, np.arctan2(handle[1] - y, handle[0] - x)), (2, 1))
        none, one = np.zeros((2, 0)), self.certificate
        stands = BodyMotion(
            one.robot,
            one.motion.gripper,
            (),
            np.arange(2.0),
            base,
            none,
            none,
            np.zeros((2, 3)),
            (),
            none,
            none,
        )
        container = one.held_in(self.twin)
        outcome = certify(
            self.twin, one.robot, stands, container, one.tolerances, drive=one.drive, scene=self.scene
        )
        found = () if isinstance(outcome, Certified) else outcome.diagnoses
        evidences = [each.evidence for each in found if each.evidence is not None]
        return any(one.quantity is Quantity.DISTANCE and one.scope == "environment" for one in evidences)

    def perform(self, case: Case) -> Answer:
        if not isinstance(case.body_motion, BodyMotion) or not isinstance(case.robot, str):
            raise OracleRejectedError("a certificate is rechecked by its body motion, and there is none")
        one = self.certificate
        outcome = certify(
            self.twin,
            one.robot,
            case.body_motion,
            one.held_in(self.twin),
            one.tolerances,
            drive=one.drive,
            start=one.start,
            scene=self.scene,
            asked=one.asked,
        )
        if isinstance(outcome, Certified):
            pairs = outcome.nearest_pairs
            return Answer(case, True, notes=outcome.nearest, figures=outcome.figures, nearest_pairs=pairs)
        return Answer(case, False, outcome.diagnoses, figures=outcome.figures)


def faces(start: tuple[float, float, float], handle: Array) -> bool:
    """Whether a start pose is turned to a handle, world position (3,): to another one no less exactly."""
    x, y, yaw = start
    return abs(math.remainder(yaw - math.atan2(handle[1] - y, handle[0] - x), math.tau)) < ROUNDING


def is_at(start: tuple[float, float, float], text: str) -> bool:
    """Whether a start pose is where a verdict's input `start` begins with, at whatever angle."""
    x, y, _ = start
    return text.startswith(pose_text(x, y, 0.0).removesuffix("0"))
