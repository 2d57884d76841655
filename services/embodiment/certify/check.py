"""All checks of a body motion, one after the other."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from predicates.case import Artefact, ArtefactKind, Diagnosis
from predicates.margins import NearestPair
from sdt_kg.annotation import Drive
from sdt_kg.errors import OracleRejectedError
from sdt_kg.iri import Iri
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.twin import Container, Twin
from services.embodiment.certify.asked import keeps
from services.embodiment.certify.certificate import Certificate, models_of, sealed
from services.embodiment.certify.collisions.inside import inside
from services.embodiment.certify.collisions.pairs import above_floor, collisions
from services.embodiment.certify.collisions.survey import survey
from services.embodiment.certify.drive import drive_limits
from services.embodiment.certify.findings import Findings
from services.embodiment.certify.held.aside import moved_aside
from services.embodiment.certify.held.friction import friction
from services.embodiment.certify.held.hold import TURN
from services.embodiment.certify.held.holds import held_so
from services.embodiment.certify.limits import joint_limits, kitchen_keeps
from services.embodiment.certify.motion import of_another_robot, rests, whole_motion
from services.embodiment.certify.motion import start as starts
from services.embodiment.certify.robustness import reach_of, tolerated
from services.embodiment.certify.sweep.kinematics import unit_of
from services.embodiment.certify.sweep.pieces import Pieces
from services.embodiment.certify.sweep.subject import Subject, subject
from services.embodiment.certify.tolerances import Tolerances
from services.physics.model import Scene

ONE_HOLD = "what moves it by itself then is not looked at"
TIMES = "of a motion with times of its own one hold is looked at"


@dataclass(frozen=True, slots=True)
class Certified:
    """Every check holds, between samples too.

    Attributes:
        figures: What was kept, and by how much: name → (value, unit). Smallest distances are those
            to within 1 mm, or 0.02 m where nothing comes nearer.
        certificate: What re-verifies it.
        nearest_pairs: Name of a figure → between which two bodies that smallest distance is, and when.
    """

    figures: dict[str, tuple[float, str]]
    certificate: Certificate
    nearest_pairs: dict[str, NearestPair]

    @property
    def nearest(self) -> tuple[str, ...]:
        """What comes nearest, what the check could not see, and what moves besides who holds, in words."""
        return self.certificate.nearest

    def artefact(self) -> Artefact:
        """The certificate, to be stored with the verdict; it is packed when somebody asks for its bytes."""
        return Artefact(ArtefactKind.CERTIFICATE, partial(sealed, self.certificate.said()))


@dataclass(frozen=True, slots=True)
class Refused:
    """At least one check does not hold.

    Attributes:
        diagnoses: The first and the worst violation of each rule.
        figures: What was measured on the way.
    """

    diagnoses: tuple[Diagnosis, ...]
    figures: dict[str, tuple[float, str]]


def certify(  # noqa: PLR0913  # what a motion is judged by; the rest has defaults
    twin: Twin,
    robot: Iri,
    motion: BodyMotion,
    container: Container,
    tolerances: Tolerances,
    *,
    drive: Drive,
    start: tuple[float, float, float] | None = None,
    scene: Scene | None = None,
    asked: Motion | None = None,
    one_hold: bool = False,
    in_full: bool = False,
) -> Certified | Refused:
    """Whether the robot can move so, and moves that container by its handle and nothing else.

    The motion between samples is the cubic Hermite spline of its samples; every check holds for
    all of it. Reaching the task's goal is not judged here: the container's last position is a figure.

    Args:
        twin: Kitchen and robot, in the state in which the motion begins.
        robot: IRI of the robot.
        motion: What is judged.
        container: The container that is to be moved.
        tolerances: What is allowed.
        drive: What the base can do.
        start: Base pose x, y [m], yaw [rad] at which the robot has to start, parked; None if any
            start will do.
        scene: The scene of this twin and robot if it is built already.
        asked: Motion of the container, as values, that it has to keep, with its times if it is timed; None if
            any will do.
        one_hold: Whether it has to be held from when it begins to move to when it stops for good, since
            what it would do by itself in between is not known; so it has where `asked` has times, too.
        in_full: Whether a refusal is to have every kind of collision with its depth, and how the handle
            is held and let go; takes longer, and changes no refusal into a certificate or back.

    Raises:
        MotionError: The arrays are no motion: shapes, times, values which are not numbers.
        UnknownEntityError: The motion names a joint or gripper that is not there.
        OracleRejectedError: A figure came out as no number, so that nothing can be said.
    """
    scene = Scene(twin, robot) if scene is None else scene
    assert scene.twin.state == twin.state, "the scene is of another state"
    assert scene.robot.mechanism == twin.mechanism(robot), "the scene is of another robot"
    assert scene.kitchen.mechanism == twin.mechanism(twin.environment), "the scene is of another kitchen"
    foreign = of_another_robot(scene, motion)
    if foreign.violations:
        return Refused(foreign.diagnoses(), foreign.figures)
    pieces, findings = whole_motion(scene, motion, tolerances)
    findings.add(starts(scene, pieces, start, tolerances))
    findings.add(rests(scene, pieces, tolerances))
    findings.add(joint_limits(scene, pieces, container, tolerances))
    findings.add(drive_limits(scene, pieces, drive, tolerances))
    findings.add(kitchen_keeps(scene, pieces, container, tolerances))
    if asked is not None:
        findings.add(keeps(scene, pieces, asked, tolerances))
    checked = subject(scene, pieces, tolerances)
    why = ONE_HOLD if one_hold else TIMES if asked is not None and asked.timed else ""
    holds, held = held_so(checked, container, motion.gripper, one_hold=why, in_full=in_full)
    findings.add(held)
    if TURN in held.figures:
        findings.add(friction(holds, held.figures[TURN][0], tolerances.cone))
    findings.add(collisions(checked, holds))
    findings.add(inside(checked))
    reach = reach_of(checked)
    findings.add(above_floor(checked, reach))
    findings.add(_end(scene, pieces, container))
    if findings.violations:
        if in_full:
            findings.with_survey(_survey(checked, container, motion.gripper))
        return Refused(findings.diagnoses(), findings.figures)
    assert holds, "a container that moves unheld is refused"
    findings.figures |= tolerated(holds, findings, reach)
    findings.nearest += moved_aside(scene, pieces, holds)
    _check_figures(findings.figures)
    certificate = Certificate(
        models=models_of(twin, robot),
        state=dict(twin.state.items()),
        container=container.iri,
        drive=drive,
        start=start,
        tolerances=tolerances,
        motion=motion,
        figures=findings.figures,
        nearest=tuple(findings.nearest),
        asked=asked,
        handle=container.handle,
    )
    return Certified(findings.figures, certificate, findings.nearest_pairs)


def _check_figures(figures: dict[str, tuple[float, str]]) -> None:
    """Every figure is a number: what is none compares with no bound, and would have kept them all."""
    for name, (value, _) in figures.items():
        if not np.isfinite(value):
            raise OracleRejectedError(
                f"the certificate's figure '{name}' came out as {value}: nothing is certified"
            )


def _survey(checked: Subject, container: Container, name: str) -> Findings:
    grippers = [one for one in checked.scene.annotation.grippers if name in {"", one.name}]
    return survey(checked, container, grippers)


def _end(scene: Scene, pieces: Pieces, container: Container) -> Findings:
    k = scene.coordinate[container.joint]
    return Findings(figures={"container at the end": (float(pieces.end[k]), unit_of(scene, k))})
