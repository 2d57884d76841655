"""All checks of a body motion, one after the other."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from predicates.case import Artefact, ArtefactKind, Diagnosis
from sdt_kg.annotation import Drive
from sdt_kg.errors import OracleRejectedError, UnknownEntityError
from sdt_kg.iri import Iri
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.twin import Container, Twin
from services.embodiment.certify.asked import keeps
from services.embodiment.certify.certificate import Certificate, models_of, sealed
from services.embodiment.certify.collisions import above_floor, collisions
from services.embodiment.certify.findings import Findings
from services.embodiment.certify.held.hold import Hold, begin
from services.embodiment.certify.held.pressed import pressed
from services.embodiment.certify.inside import inside
from services.embodiment.certify.limits import drive_limits, joint_limits, kitchen_keeps
from services.embodiment.certify.motion import of_another_robot, rests, whole_motion
from services.embodiment.certify.motion import start as starts
from services.embodiment.certify.robustness import reach_of, tolerated
from services.embodiment.certify.survey import survey
from services.embodiment.certify.sweep.kinematics import unit_of
from services.embodiment.certify.sweep.pieces import Pieces
from services.embodiment.certify.sweep.subject import Subject, subject
from services.embodiment.certify.tolerances import Tolerances
from services.physics.model import Scene


@dataclass(frozen=True, slots=True)
class Certified:
    """Every check holds, between samples too.

    Attributes:
        figures: What was kept, and by how much: name → (value, unit). Smallest distances are those
            to within 1 mm, or 0.02 m where nothing comes nearer.
        certificate: What re-verifies it.
    """

    figures: dict[str, tuple[float, str]]
    certificate: Certificate

    @property
    def nearest(self) -> tuple[str, ...]:
        """What comes nearest, and what the check could not see, in words."""
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
    hold, held = _hold(checked, container, motion.gripper, in_full)
    findings.add(held)
    findings.add(collisions(checked, hold))
    findings.add(inside(checked))
    reach = reach_of(checked)
    findings.add(above_floor(checked, reach))
    findings.add(_end(scene, pieces, container))
    if findings.violations:
        if in_full:
            findings.with_survey(_survey(checked, container, motion.gripper))
        return Refused(findings.diagnoses(), findings.figures)
    assert hold is not None, "a container that moves unheld is refused"
    findings.figures |= tolerated(checked, hold, findings, reach)
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
    return Certified(findings.figures, certificate)


def _check_figures(figures: dict[str, tuple[float, str]]) -> None:
    """Every figure is a number: what is none compares with no bound, and would have kept them all."""
    for name, (value, _) in figures.items():
        if not np.isfinite(value):
            raise OracleRejectedError(
                f"the certificate's figure '{name}' came out as {value}: nothing is certified"
            )


def _hold(checked: Subject, container: Container, name: str, in_full: bool) -> tuple[Hold | None, Findings]:
    """How the named gripper holds the container; if none is named, the one that does so best.

    What follows a grasp that comes too late is judged as well if the refusal is to be `in_full`.
    """
    grippers = {gripper.name: gripper for gripper in checked.scene.annotation.grippers}
    if name and name not in grippers:
        raise UnknownEntityError("gripper", name, grippers)
    first = begin(checked.scene, checked.pieces, container)
    if first is None:
        return None, Findings()
    chosen = [grippers[name]] if name else list(grippers.values())
    holds = [Hold(checked, container, gripper, first) for gripper in chosen]
    contacts = [hold.contact() for hold in holds]
    best = min(range(len(holds)), key=lambda i: max((v.excess for v in contacts[i].violations), default=0.0))
    hold, findings = holds[best], contacts[best]
    if findings.violations:
        lates = (one.later() for one in (holds if in_full else ()))
        hold = next((late for late in lates if late is not None), None)
    if hold is not None:
        findings.add(hold.follows())
        findings.add(hold.keeps_fingers())
        findings.add(pressed(checked, hold))
        findings.nearest.extend(_let_go(hold))
    return hold, findings


def _let_go(hold: Hold) -> Iterator[str]:
    """What a certificate rests on if the hand leaves the handle before the motion ends."""
    if hold.left < len(hold.pieces.start):
        name, when = hold.container.name, f"from {hold.time:.2f} s to {hold.until:.2f} s"
        yield f"let go: {name} is held {when}, and nothing in D_artic moves it afterwards"


def _survey(checked: Subject, container: Container, name: str) -> Findings:
    grippers = [one for one in checked.scene.annotation.grippers if name in {"", one.name}]
    return survey(checked, container, grippers, begin(checked.scene, checked.pieces, container))


def _end(scene: Scene, pieces: Pieces, container: Container) -> Findings:
    k = scene.coordinate[container.joint]
    last = pieces.at(np.array([len(pieces.start) - 1]), pieces.duration[-1:])[0][0, k]
    unit = unit_of(scene, k)
    return Findings(figures={"container at the end": (float(last), unit)})
