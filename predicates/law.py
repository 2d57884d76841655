"""Eq. (4): the Law of Task-Achieving Body Motion."""

import time
from collections.abc import Iterator
from dataclasses import replace
from typing import TypeGuard, TypeVar

from predicates.can_perform import can_perform
from predicates.case import Answer, Case, Diagnosis, Kind, Outcome, Quantity, Verdict
from predicates.causes import causes
from predicates.meant import moved_by
from predicates.oracle import Embodiment, Physics
from predicates.questions import Question, questions, unhurried, with_carried
from predicates.record.inputs import Inputs, inputs_of, verdict_iri
from predicates.record.recall import Recall, answers_again, nothing_stored, recalled
from predicates.satisfies_request import satisfies_request
from predicates.scope import claimed
from sdt_kg.errors import OracleRejectedError
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.state import Region, State
from sdt_kg.task import UNKNOWN, Task, Unknown
from sdt_kg.twin import Container

T = TypeVar("T")
Answers = tuple[Answer | None, Answer | None, Answer | None]

BY_SPEED = frozenset({Quantity.VELOCITY, Quantity.ACCELERATION, Quantity.FORCE})
"""What a motion of a container breaks that need not be broken more slowly."""

NOT_ASKED = Diagnosis(Kind.EMBODIMENT, "no robot was asked, so CanPerform is open")


def law(
    case: Case, physics: Physics, embodiment: Embodiment | None = None, recall: Recall = nothing_stored
) -> Iterator[Verdict]:
    r"""Eq. (4): :math:`SatisfiesRequest \wedge Causes \wedge CanPerform \Rightarrow CanAchieve`.

    Modes: (+task, -motion) generation; (+task, +motion) or (+task, +body_motion) verification, in
    each one verdict for each container that the task may mean; (-task, +motion) or
    (-task, +body_motion) explanation, one verdict for each request that is met afterwards and was
    not before, or a single refusal; everything after a change of twin, robot or task: what if.
    Robot unknown: one verdict for each robot of the twin, if there is an embodiment to ask.

    Whatever can run, runs, also after a refusal: a verdict names every reason. Outside the scope
    of D nothing runs and the Law abstains. What `recall` has under the verdict's IRI is not judged
    again, but for a refusal that a longer search may overturn.

    Raises:
        NoModeError: Task and motion are both unknown.
        InputError: The motion is no motion of this kitchen.
        OracleUnavailableError: An oracle did not answer: there is no verdict.
    """
    for question in questions(case, physics, embodiment):
        inputs = inputs_of(question.asked, physics, embodiment)
        stored = _recalled(question, inputs, recall)
        yield _judged(question, physics, embodiment, inputs) if stored is None else stored


def stored_verdicts(
    case: Case, physics: Physics, embodiment: Embodiment | None, recall: Recall
) -> tuple[Verdict, ...] | None:
    """What `law` would yield, if everything that is asked is stored; else None, and nothing is judged."""
    found: list[Verdict] = []
    for question in questions(case, physics, embodiment):
        stored = _recalled(question, inputs_of(question.asked, physics, embodiment), recall)
        if stored is None:
            return None
        found.append(stored)
    return tuple(found)


def _recalled(question: Question, inputs: Inputs, recall: Recall) -> Verdict | None:
    """The stored verdict, if there is one that answers again."""
    stored = recall(verdict_iri(inputs))
    if stored is None or not answers_again(stored, inputs):
        return None
    return recalled(stored, question.asked, inputs)


def _judged(question: Question, physics: Physics, embodiment: Embodiment | None, inputs: Inputs) -> Verdict:
    """Three answers about one question, and what follows from them."""
    began = time.perf_counter()
    case, container = question.case, question.container
    caused = _caused(case, physics)
    guessed = _is_guessed(question.asked)
    if caused is not None and guessed:
        caused = _unproved(caused)
    satisfied = performed = None
    if caused is None or not _outside(caused):
        solved = case if caused is None else caused.case
        performed = _performed(solved, embodiment)
        if _is_new(performed, question) and (caused is None or _may_be_executed(case, caused)):
            caused = _executed(performed, case, physics)
            solved = caused.case
            performed = replace(performed, case=replace(performed.case, final=solved.final))
        satisfied = _as_sure_as(caused, _satisfied(solved, container))
        if satisfied is not None and guessed:
            satisfied = _unproved(satisfied)
    return _verdict(case, (satisfied, caused, performed), began, inputs)


def _caused(case: Case, physics: Physics) -> Answer | None:
    """The answer of Causes; None for a body motion which moves no container."""
    if case.motion is UNKNOWN and case.body_motion is not UNKNOWN:
        return None
    return _timed("causes", causes(case, physics))


def _is_guessed(asked: Case) -> bool:
    """Whether how the kitchen moves was concluded from the robot's motion, which does not say it."""
    if isinstance(asked.motion, Motion) or not isinstance(asked.body_motion, BodyMotion):
        return False
    return not asked.body_motion.kitchen_joints


def _unproved(answer: Answer) -> Answer:
    """The answer, proving nothing."""
    return replace(answer, diagnoses=tuple(replace(each, proof=False) for each in answer.diagnoses))


def _timed(step: str, answers: Iterator[Answer]) -> Answer:
    """The first answer, with the seconds that it took, unless it divides them into steps itself."""
    began = time.perf_counter()
    answer = next(answers)
    return replace(answer, seconds=answer.seconds or {step: time.perf_counter() - began})


def _outside(answer: Answer) -> bool:
    return any(diagnosis.kind is Kind.OUT_OF_SCOPE for diagnosis in answer.diagnoses)


def _satisfied(case: Case, container: Container | None) -> Answer | None:
    """The answer of SatisfiesRequest about the final state, so far as there is one."""
    if container is not None:
        known = isinstance(case.final, State | Region)
        return _timed("satisfies request", satisfies_request(case)) if known else None
    if isinstance(case.task, Task):
        reason = f"the motion moves no container, so nothing is {case.task.verb.value} that was not before"
    else:
        reason = "the motion meets no request that was not met before"
    return Answer(case, holds=False, diagnoses=(Diagnosis(Kind.SEMANTIC, reason, proof=True),))


def _as_sure_as(caused: Answer | None, satisfied: Answer | None) -> Answer | None:
    """SatisfiesRequest about a state that Φ is not sure of (stopped by outer shapes) proves nothing."""
    if satisfied is None or caused is None or all(each.proof for each in caused.diagnoses):
        return satisfied
    return _unproved(satisfied)


def _performed(case: Case, embodiment: Embodiment | None) -> Answer | None:
    """The answer of CanPerform, if there is somebody to ask and a container whose motion to ask about.

    CanPerform is about τ, whatever the task: a motion of another container than the task's is asked
    about without the task.
    """
    if embodiment is None or case.robot is UNKNOWN or not isinstance(case.motion, Motion):
        return None
    moved = moved_by(case.twin, case.motion.of)
    if not moved:
        return None
    about = isinstance(case.task, Task) and case.task.container in {each.iri for each in moved}
    answers = can_perform(case if about else replace(case, task=UNKNOWN), embodiment)
    answer = _timed("can perform", answers)
    return replace(answer, case=replace(answer.case, task=case.task))


def _is_new(performed: Answer | None, question: Question) -> TypeGuard[Answer]:
    """Whether CanPerform holds by a body motion that was not given, or that is only near τ.

    One that comes with a τ keeps that to within a tolerance: where the container then ends is what counts.
    """
    if performed is None or not performed.holds:
        return False
    case = question.case
    slower = isinstance(case.motion, Motion) and not case.motion.timed
    near = isinstance(question.asked.motion, Motion)
    return slower or near or performed.case.body_motion is not case.body_motion


def _may_be_executed(given: Case, caused: Answer) -> bool:
    """Whether Causes is about what a robot makes of τ: of one that was given, if that is τ, or τ slower.

    What leaves the joint's way or limits, or begins elsewhere, is no better for a robot that does otherwise.
    """
    if not isinstance(given.motion, Motion) or caused.holds:
        return True
    found = {None if each.evidence is None else each.evidence.quantity for each in caused.diagnoses}
    return not given.motion.timed and found <= BY_SPEED


def _executed(performed: Answer, given: Case, physics: Physics) -> Answer:
    """Causes about the motion that the robot really makes the container do.

    A generated τ is a proposal which the robot may slow down: what it proposed is not what counts.
    """
    body_motion, motion = performed.case.body_motion, performed.case.motion
    if not isinstance(body_motion, BodyMotion) or not isinstance(motion, Motion):
        raise OracleRejectedError("CanPerform holds, but the embodiment oracle gave no body motion")
    container = moved_by(performed.case.twin, motion.of)[0]
    case = with_carried(replace(performed.case, final=given.final), body_motion, container, physics)
    if given.body_motion is UNKNOWN and not (isinstance(given.motion, Motion) and given.motion.timed):
        case = unhurried(case)
    return _timed("causes", causes(case, physics))


def _verdict(asked: Case, answers: Answers, began: float, inputs: Inputs) -> Verdict:
    """What the answers add up to."""
    satisfied, caused, performed = answers
    diagnoses = [each for answer in answers if answer is not None for each in answer.diagnoses]
    case = _solved(asked, answers)
    if any(answer is not None and _outside(answer) for answer in answers):
        outcome, satisfied, caused, performed = Outcome.ABSTAINED, None, None, None
    elif all(answer is not None and answer.holds for answer in answers):
        outcome = Outcome.CERTIFIED
    else:
        outcome = Outcome.NOT_CERTIFIED
        if performed is None and all(answer is not None and answer.holds for answer in answers[:2]):
            diagnoses.append(NOT_ASKED)
    seconds = time.perf_counter() - began
    return Verdict(
        verdict_iri(inputs), outcome, case, satisfied, caused, performed, claimed(diagnoses), inputs, seconds
    )


def _solved(asked: Case, answers: Answers) -> Case:
    """The case with all that the relations found out, later answers winning."""
    case = asked
    for found in (answer.case for answer in answers if answer is not None):
        case = Case(
            twin=case.twin,
            robot=_known(case.robot, found.robot),
            task=_known(case.task, found.task),
            motion=_known(case.motion, found.motion),
            final=_known(case.final, found.final),
            body_motion=_known(case.body_motion, found.body_motion),
        )
    return case


def _known(before: T | Unknown, found: T | Unknown) -> T | Unknown:
    return before if isinstance(found, Unknown) else found
