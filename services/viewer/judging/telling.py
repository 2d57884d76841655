"""A verdict as the page shows it: in words, as a film, and what to look at in the picture."""

from collections.abc import Callable
from dataclasses import dataclass

import pyoxigraph as ox

from predicates.case import Verdict
from predicates.record import to_record
from sdt_kg.iri import PREFIXES, Iri
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.task import Task
from sdt_kg.twin import Twin
from services.physics.model import Scene
from services.viewer.judging import measure
from services.viewer.judging.question import Judged, Question
from services.viewer.picture.marks import Mark, What, marks_of, nearest_of
from services.viewer.picture.skeleton import Skeleton
from services.viewer.picture.standing import Pose2, start_pose
from services.viewer.picture.timeline import Posture, Timeline
from services.why import sections


def told(question: Question, verdict: Verdict, twin: Twin, scene: Callable[[], Scene]) -> Judged:
    """The verdict as the page shows it; the scene of the twin is asked for where points are measured."""
    quads = list(to_record(verdict).quads())
    answers = (verdict.satisfies_request, verdict.causes, verdict.can_perform)
    one, two, three = (None if each is None else each.holds for each in answers)
    looked = _Looked(question, verdict, twin, scene)
    return Judged(
        question=question,
        iri=verdict.iri,
        outcome=verdict.outcome.value,
        holds=(one, two, three),
        diagnoses=verdict.diagnoses,
        sections=sections(quads, verdict.iri, edits=question.place.edits),
        motion=looked.motion,
        marks=looked.marks(),
        start=looked.start(),
        seconds=verdict.seconds,
        trig=ox.serialize(quads, format=ox.RdfFormat.TRIG, prefixes=PREFIXES) or b"",
    )


@dataclass(frozen=True, slots=True)
class _Looked:
    """What of a verdict can be seen."""

    question: Question
    verdict: Verdict
    twin: Twin
    scene: Callable[[], Scene]

    @property
    def motion(self) -> BodyMotion | Motion | None:
        """What can be played: the robot's motion, else the container's."""
        verdict = self.verdict
        answers = verdict.can_perform, verdict.causes, verdict.satisfies_request
        case = next((each.case for each in answers if each is not None), verdict.case)
        if isinstance(case.body_motion, BodyMotion):
            return case.body_motion if case.body_motion.robot == self.robot else None
        return case.motion if isinstance(case.motion, Motion) and not case.motion.is_poses else None

    @property
    def robot(self) -> Iri:
        """Whose motion is asked about."""
        robot = self.verdict.case.robot
        assert isinstance(robot, str), "the page asks about one robot"
        return robot

    def start(self) -> Pose2 | None:
        """Where the robot stood; None where nothing says so."""
        task = self.verdict.case.task
        if not isinstance(task, Task) or not isinstance(task.container, str):
            return None
        container = self.twin.container(task.container)
        kitchen = Skeleton.of(self.twin.mechanism(self.twin.environment))
        return start_pose(self.twin, kitchen, container, self.question.base)

    def marks(self) -> tuple[Mark, ...]:
        """Reasons, closest pairs and the region of a proof, with their points."""
        found = marks_of(self.verdict.diagnoses)
        performed = self.verdict.can_perform
        if performed is None:
            return found
        if performed.holds:
            found += nearest_of(performed)
        found = tuple(map(self._measured, found))
        proved = measure.region(self.twin, performed.artefact)
        return found if proved is None else (*found, proved)

    def _measured(self, mark: Mark) -> Mark:
        posture = self._posture(mark) if mark.bodies else None
        return mark if posture is None else measure.with_ends(self.scene(), posture, mark)

    def _posture(self, mark: Mark) -> Posture | None:
        """Where everything was when it was measured, so far as the verdict tells."""
        motion, start = self.motion, self.start()
        if mark.time is None:
            return None
        if isinstance(motion, BodyMotion):
            timeline = Timeline(motion, self.twin.state, self.twin.entities.coupling)
            return timeline.at(timeline.since_start(mark.time))
        if mark.time == 0 and mark.what is What.CONTACT and start is not None:
            return Posture(start, {}, dict(self.twin.state))
        return None
