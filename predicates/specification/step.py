"""One step of a sequence, judged by the Law; *open to p* by its three relations with a goal of its own."""

import time
from dataclasses import dataclass, replace

from predicates.can_perform import can_perform
from predicates.case import Answer, Case, Diagnosis, Evidence, Kind, Outcome, Quantity, Verdict
from predicates.causes import STATE_TOLERANCE, causes, nothing_to_cause
from predicates.law import law
from predicates.meant import unit_of
from predicates.oracle import Embodiment, Physics, tee_class_of
from predicates.questions import unhurried, with_carried
from predicates.record.inputs import inputs_of, verdict_iri
from predicates.scope import claimed, out_of_scope
from sdt_kg.errors import OracleRejectedError
from sdt_kg.iri import Iri, local_name
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.state import Interval, Region, State
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Container, Twin


@dataclass(frozen=True, slots=True)
class Request:
    """A step about one container. See `Step`."""

    verb: Verb
    container: Container
    position: float | None = None

    def __str__(self) -> str:
        return in_words(self.verb, self.container.iri, self.position)


def in_words(verb: Verb, container: Iri, position: float | None) -> str:
    """What a step asks of a container: to be opened, closed, or opened to a position [rad or m]."""
    to = "" if position is None else f" to {position:g}"
    return f"{verb.value} {local_name(container)}{to}"


def opened_to(container: Container, position: float) -> Region:
    """The goal of a step that opens a container to a position [rad or m]."""
    return Region(((container.joint, Interval(position - STATE_TOLERANCE, position + STATE_TOLERANCE)),))


def judged(request: Request, twin: Twin, robot: Iri, physics: Physics, embodiment: Embodiment) -> Verdict:
    """The verdict about one request in the twin's state, with a motion that is made for it."""
    if request.position is None:
        case = Case(twin, robot=robot, task=Task(request.verb, request.container.iri))
        (verdict,) = law(case, physics, embodiment)
        return verdict
    return _opened_to(request.container, request.position, Case(twin, robot=robot), (physics, embodiment))


def reaches(
    goal: Region, container: Container, case: Case, physics: Physics, embodiment: Embodiment
) -> tuple[Answer, Answer, Answer]:
    """The three relations about a body motion that is given, and a goal of the container's own joint."""
    assert isinstance(case.body_motion, BodyMotion)
    given = with_carried(replace(case, final=goal), case.body_motion, container, physics)
    caused = next(causes(unhurried(given), physics))
    refused = (*caused.diagnoses, *_nothing_to_cause(given, container, goal))
    caused = replace(caused, holds=not refused, diagnoses=refused)
    return _satisfied(caused, container, goal), caused, next(can_perform(given, embodiment))


def _opened_to(
    container: Container, position: float, case: Case, oracles: tuple[Physics, Embodiment]
) -> Verdict:
    """The three relations about the goal that the container ends at p, within `STATE_TOLERANCE`."""
    began, (physics, embodiment) = time.perf_counter(), oracles
    goal = opened_to(container, position)
    asked = replace(case, final=goal)
    inputs = inputs_of(asked, physics, embodiment)
    outside = out_of_scope(case, container, tee_class_of(physics))
    refused = outside or _nothing_to_cause(asked, container, goal)
    if refused:
        outcome = Outcome.ABSTAINED if outside else Outcome.NOT_CERTIFIED
        caused = None if outside else Answer(asked, False, tuple(refused))
        seconds = time.perf_counter() - began
        return Verdict(
            verdict_iri(inputs), outcome, asked, None, caused, None, tuple(refused), inputs, seconds
        )
    caused, performed = _answers(asked, container, position, oracles)
    answers = (_satisfied(caused, container, goal), caused, performed)
    found = claimed(each for answer in answers for each in answer.diagnoses)
    outcome = _outcome(answers, found)
    final = replace(performed.case if performed.holds else caused.case, final=caused.case.final)
    return Verdict(
        verdict_iri(inputs),
        outcome,
        replace(final, body_motion=caused.case.body_motion) if performed.holds else final,
        *((None, None, None) if outcome is Outcome.ABSTAINED else answers),
        found,
        inputs,
        time.perf_counter() - began,
    )


def _outcome(answers: tuple[Answer, ...], found: tuple[Diagnosis, ...]) -> Outcome:
    """What the answers add up to, as in the Law: it abstains where one of them leaves the class."""
    if any(each.kind is Kind.OUT_OF_SCOPE for each in found):
        return Outcome.ABSTAINED
    return Outcome.CERTIFIED if all(each.holds for each in answers) else Outcome.NOT_CERTIFIED


def _nothing_to_cause(case: Case, container: Container, goal: Region) -> list[Diagnosis]:
    if case.twin.state not in goal:
        return []
    at, (_, bounds) = case.twin.state[container.joint], goal.intervals[0]
    evidence = Evidence(
        Quantity.POSITION, at, bounds.lower, unit_of(case.twin, container), entity=container.joint
    )
    return [nothing_to_cause(f"{container.name} is already there", evidence)]


def _answers(
    asked: Case, container: Container, position: float, oracles: tuple[Physics, Embodiment]
) -> tuple[Answer, Answer]:
    """Causes and CanPerform; Causes about the motion that the robot really makes the container do."""
    physics, embodiment = oracles
    exactly = Region(((container.joint, Interval(position, position)),))
    motion = next(physics.generate(asked.twin, exactly), None)
    if motion is None:
        raise OracleRejectedError(f"the physics made no motion of {container.name} to {position:g}")
    caused = next(causes(replace(asked, motion=motion), physics))
    performed = next(can_perform(replace(asked, motion=motion), embodiment))
    if performed.holds:
        body, motion = performed.case.body_motion, performed.case.motion
        if not isinstance(body, BodyMotion) or not isinstance(motion, Motion):
            raise OracleRejectedError("CanPerform holds, but the embodiment oracle gave no body motion")
        case = with_carried(replace(performed.case, final=asked.final), body, container, physics)
        executed = next(causes(unhurried(case), physics))
        caused = replace(executed, case=replace(executed.case, body_motion=case.body_motion))
    return caused, performed


def _satisfied(caused: Answer, container: Container, goal: Region) -> Answer:
    """Whether the final state lies in the goal."""
    final = caused.case.final
    if isinstance(final, State) and final in goal:
        return Answer(caused.case, holds=True)
    reason = f"{container.name} does not end where it was to be opened to"
    sure = all(each.proof for each in caused.diagnoses)
    return Answer(caused.case, False, (Diagnosis(Kind.SEMANTIC, reason, proof=sure),))
