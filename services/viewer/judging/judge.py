"""What a process that judges for the page does: verdicts, and what can be opened, ready to be shown."""

import copy
import logging
import pickle
from collections import OrderedDict
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from predicates.case import Answer
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError, SdtError
from sdt_kg.iri import Iri
from sdt_kg.load import model_name
from sdt_kg.motion import Motion
from sdt_kg.scope import D_ARTIC, D_ARTIC_DYN
from sdt_kg.task import Task
from sdt_kg.twin import Twin
from services.app import Policy, Service
from services.embodiment.oracle import WholeBody
from services.judging.problems import Problem, ProblemType, problem, problem_of
from services.judging.workers.jobs import Done, Quads
from services.judging.workers.jobs import Task as Sent
from services.motions import read_motion
from services.physics.model import Scene
from services.physics.oracle import Kinematics
from services.viewer.judging.places import Places
from services.viewer.judging.question import Asked, Judged, Opening, Paths, Place, Question
from services.viewer.judging.telling import told

KEPT: Final = 6
"""Policies whose scenes are kept."""
SCENES: Final = 3
"""Scenes that are kept for measuring."""
WARMING: Final = 1.0
"""[s] Of search that warming may take."""

_log = logging.getLogger("sdt.view.judge")


def warmed(place: Place) -> "Judge":
    """A judge that has the place loaded and a first case judged: the next finds everything compiled."""
    judge = Judge()
    try:
        judge.warm(place)
    except SdtError:
        _log.exception("a first case could not be judged")
    return judge


@dataclass(slots=True)
class Kept:
    """Φ and R that keep the scenes which they have built."""

    _physics: Kinematics = field(default_factory=Kinematics)
    _bodies: OrderedDict[Policy, WholeBody] = field(default_factory=OrderedDict[Policy, WholeBody])

    def physics(self) -> Kinematics:
        """Φ."""
        return self._physics

    def embodiment(self, policy: Policy) -> WholeBody:
        """R under a policy; it begins with the scenes of another one with the same drive and seed."""
        if policy not in self._bodies:
            like = (policy.drive, policy.seed)
            last = next((each for of, each in self._bodies.items() if (of.drive, of.seed) == like), None)
            start, contact, friction = policy.base, policy.contact, policy.friction
            how = (policy.budget, policy.seed, policy.any_start, contact, friction)
            body = WholeBody(policy.drive, start, *how)
            if last is not None:
                # Scenes and roads depend on drive and seed alone.
                shared = copy.copy(last)
                shared.drive, shared.start, shared.budget = body.drive, body.start, body.budget
                shared.seed, shared.any_start, shared.tolerances = body.seed, body.any_start, body.tolerances
                body = shared
            self._bodies[policy] = body
        self._bodies.move_to_end(policy)
        while len(self._bodies) > KEPT:
            self._bodies.popitem(last=False)
        return self._bodies[policy]


@dataclass(slots=True)
class Judge:
    """The Law over the places that are asked about."""

    _places: Places = field(default_factory=Places)
    _kept: Kept = field(default_factory=Kept)
    _forced: tuple[tuple[Place, Policy], Service] | None = None
    _scenes: list[Scene] = field(default_factory=list[Scene])

    def __call__(self, task: Sent, recall: Quads) -> Done | Problem:
        """The answer to a question, or what the shell would say of it; nothing that is kept is asked for."""
        del recall
        try:
            asked: Asked = pickle.loads(task.payload)  # noqa: S301 - of the process that began this one
            answer = self._judged(asked) if isinstance(asked, Question) else self._paths(asked.place)
            return Done(pickle.dumps(answer), task.encoding)
        except SdtError as error:
            return problem_of(error)
        except Exception:  # noqa: BLE001 - the edge of a process: logged, and answered as a failure
            _log.exception("a case could not be judged")
            return problem(
                ProblemType.INTERNAL, "the case could not be judged; the log of the service says why"
            )

    def _service(self, place: Place, policy: Policy) -> Service:
        return Service(self._places.twin(place), policy, oracles=self._kept)

    def _relative(self, question: Question, policy: Policy) -> Service:
        """The service, asked relative to the question's class."""
        if question.tee == D_ARTIC.name:
            return self._service(question.place, policy)
        if question.tee != D_ARTIC_DYN.name:
            classes = f"{D_ARTIC.name}, {D_ARTIC_DYN.name}"
            raise InputError(f"no TEE class '{question.tee}'", allowed=classes)
        key = (question.place, policy)
        if self._forced is None or self._forced[0] != key:
            self._forced = key, Service(self._places.twin(question.place), policy).with_forces()
        return self._forced[1]

    def warm(self, place: Place) -> None:
        """A first case is judged there.

        Raises:
            SdtError: A model that is none.
        """
        service = self._service(place, Policy(budget=WARMING))
        drawers = [each for each in service.twin.containers() if each.kind == "drawer"]
        for container in (drawers or service.twin.containers())[:1]:
            next(service.achieve(f"open:{container.name}", model_name(place.robot)), None)
            self._scene(service.twin, service.robot(model_name(place.robot)))

    def _scene(self, twin: Twin, robot: Iri) -> Scene:
        """The scene of a twin, in which points are measured; the last few are kept."""
        found = next((one for one in self._scenes if one.twin is twin), None) or Scene(twin, robot)
        self._scenes = [found, *(one for one in self._scenes if one is not found)][:SCENES]
        return found

    def _paths(self, place: Place) -> Paths:
        twin = self._places.twin(place)
        openings: list[Opening] = []
        refused: list[tuple[str, str]] = []
        for answer in Service(twin, oracles=self._kept).causes("open"):
            container = twin.container(_container(answer))
            motion = answer.case.motion
            if answer.holds and isinstance(motion, Motion):
                opening = Opening(container.name, container.handle, motion.of, motion.values[:, 0].copy())
                openings.append(opening)
            else:
                refused.append((container.name, answer.diagnoses[0].reason))
        return Paths(tuple(openings), tuple(refused))

    def _judged(self, question: Question) -> Judged:
        policy = Policy(
            drive=None if question.drive is None else Drive(question.drive),
            base=question.base,
            budget=question.budget,
            any_start=question.any_start,
            friction=question.friction,
        )
        service = self._relative(question, policy)
        robot = service.robot(model_name(question.place.robot))
        motion = read_motion(Path(question.motion), service.twin, robot) if question.motion else None
        found = list(service.achieve(question.task, robot, motion))
        if len(found) != 1:
            raise InputError(f"'{question.task}' is {len(found)} questions", allowed="one container")
        return told(question, found[0], service.twin, lambda: self._scene(service.twin, robot))


def _container(answer: Answer) -> Iri:
    task = answer.case.task
    assert isinstance(task, Task), "Causes names the task"
    assert isinstance(task.container, str), "and the container, of each answer"
    return task.container
