"""A task's result against its steps' verdicts: where each begins, the rules, the outcome, J."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from hashlib import sha256
from itertools import zip_longest

from predicates.case import Answer, Artefact, Case, Outcome
from predicates.causes import causes
from predicates.oracle import LET_GO, RESTLESS, Physics, not_checked
from predicates.questions import unhurried, with_carried
from predicates.record.inputs import NOT_HASHED, UNKNOWN_INPUT, goal_of, input_hash, state_hash, task_text
from predicates.record.stored import StoredVerdict
from predicates.scope import tee_class_of_hash
from predicates.specification.leg import Leg
from predicates.specification.model import Quality, Specification
from predicates.specification.quality import measured, total
from predicates.specification.queries import InGraph
from predicates.specification.read import read_specification
from predicates.specification.results.result import content_hash
from predicates.specification.results.stored import StoredResult, StoredStep
from predicates.specification.rules import RuleAnswer, Standing, at_the_end, checked
from predicates.specification.step import Request, opened_to
from predicates.specification.walk import Taken, Walk
from sdt_kg.errors import InputError
from sdt_kg.iri import Iri, local_name, task_result_iri
from sdt_kg.motion import BodyMotion
from sdt_kg.state import State
from sdt_kg.task import Task
from sdt_kg.twin import Twin
from services.embodiment.certify.certificate import Certificate, read_certificate
from services.embodiment.certify.tasks.near import Swept
from services.embodiment.certify.tasks.work import mechanical_work
from services.embodiment.recheck.check import Rechecked, Trial
from services.embodiment.recheck.claim import SAME_FIGURE
from services.embodiment.recheck.models import Models, TwinOf, at_hand
from services.physics.model import Scene

OF_THE_STEP = frozenset({"state", "task", "final", "embodiment.seed", *NOT_HASHED})
"""Inputs of a step's verdict that are not those of the task's result."""
OF_THE_RESULT = frozenset({"specification", "rules"})
"""Inputs of a result that no verdict has."""

Found = tuple[StoredVerdict, Artefact | None, Rechecked | None]
"""A step's verdict, what shows it, and what its own recheck found; both None where nothing shows it."""
VerdictOf = Callable[[Iri], Found]


def recheck_result(
    stored: StoredResult, verdict_of: VerdictOf, twin_of: TwinOf, physics: Physics
) -> Rechecked:
    """Whether a task's result follows from the verdicts of its steps, and these hold.

    The steps are walked again: what each asks where the one before ended, where its certified motion ends,
    by Φ; then the rules over these motions, the outcome, and J.

    Args:
        stored: The result; its specification was kept with it.
        verdict_of: What is known of a step's verdict; InputError where it is not there, or damaged.
        twin_of: The models that it is about.
        physics: Φ of the class that it is relative to.
    """
    trial = Trial(stored.iri, kind="task result")
    trial.about = f"{stored.label}, {local_name(stored.robot)} in {local_name(stored.environment)}"
    try:
        if trial.found(_contradicts_itself(stored)):
            return trial.ended()
        twin, source = at_hand(twin_of, _models(stored), {})
        twin = twin.at(stored.moved)
        specification = read_specification(twin, stored.written, "the specification that was kept")
        trial.notes.append(source)
        if not trial.found(_asks_other(stored, specification, twin)):
            again = _Again(stored, Walk(twin, specification), verdict_of, physics)
            trial.found(again.differences())
            trial.notes += again.notes
    except InputError as error:
        trial.failed(error)
    return trial.ended()


def _contradicts_itself(stored: StoredResult) -> Iterator[str]:
    said = dict(stored.inputs)
    if task_result_iri(input_hash(stored.inputs)) != stored.iri:
        yield "the result's IRI is not the hash of its inputs: one of them was changed"
    for name, model in (("environment", stored.environment), ("robot", stored.robot)):
        if said.get(name, "").split(" ")[0] != model:
            yield f"the result's input '{name}' is {said.get(name)}, and it says {model}"
    tee = tee_class_of_hash(said.get("tee_class", ""))
    if tee is not None and stored.tee_class not in {None, tee.iri}:
        yield f"the result's class is {stored.tee_class}, by its inputs {tee.iri}"


def _models(stored: StoredResult) -> Models:
    said = dict(stored.inputs)
    environment, robot = (said[name].partition(" ") for name in ("environment", "robot"))
    return (environment[0], environment[2]), (robot[0], robot[2])


def _asks_other(stored: StoredResult, specification: Specification, twin: Twin) -> Iterator[str]:
    said = dict(stored.inputs)
    if said.get("state") != state_hash(twin.state):
        yield "the result's input 'state' is not the state in which its first step is said to begin"
    if said.get("specification") != content_hash(specification):
        yield "the result's input 'specification' is not the specification that was kept with it"


class _Again:
    """A result on its way, walked once more."""

    def __init__(self, stored: StoredResult, walk: Walk, verdict_of: VerdictOf, physics: Physics) -> None:
        self.stored, self.walk, self.physics = stored, walk, physics
        self.notes: list[str] = []
        self._verdict_of = verdict_of
        self._reasons: list[str] = []
        self._taken: list[tuple[Twin, Certificate | None]] = []

    def differences(self) -> list[str]:
        """Why the result does not follow from its steps; empty if it does."""
        walk, stored = self.walk, self.stored
        walk.go(self._take)
        if self._reasons:
            return self._reasons
        if (len(self._taken), walk.expected) != (len(stored.steps), stored.asked):
            self._reasons.append(
                f"the result has {len(stored.steps)} of {stored.asked} steps, its specification asks "
                f"{len(self._taken)} of {walk.expected}"
            )
        answers = self._rules()
        self._reasons += _rules_differ(stored, answers)
        outcome = walk.outcome(each.standing for each in answers)
        if outcome is not stored.outcome:
            self._reasons.append(
                f"the result says {stored.outcome.value}, its steps and rules {outcome.value}"
            )
        self._reasons += self._values_differ()
        return self._reasons

    def _take(self, request: Request) -> Taken:
        """What the stored verdict of the next step shows; nothing follows what it does not show."""
        number, twin = len(self._taken) + 1, self.walk.twin
        if number > len(self.stored.steps):
            self._reasons.append(f"the result has no step {number}, and its specification asks '{request}'")
            return Taken(Outcome.ABSTAINED)
        step = self.stored.steps[number - 1]
        verdict, artefact, found = self._verdict_of(step.verdict)
        self._reasons += [
            f"step {number}, {step}: {each}"
            for each in (
                *_is_other(step, request),
                *self._is_of_other(step, request, verdict, artefact, found),
            )
        ]
        if self._reasons or verdict.outcome is not Outcome.CERTIFIED or artefact is None:
            self._taken.append((twin, None))
            if found is None:
                self.notes.append(f"step {number} is {verdict.outcome.value}: that was not checked again")
            return Taken(verdict.outcome)
        certificate = read_certificate(artefact.content)
        self._taken.append((twin, certificate))
        final, figures = _ends(request, twin, certificate, self.physics)
        leg = Leg.of(number, twin, certificate.motion, not_checked(figures))
        return Taken(verdict.outcome, leg, final, LET_GO in figures, RESTLESS in figures)

    def _is_of_other(
        self,
        step: StoredStep,
        request: Request,
        verdict: StoredVerdict,
        artefact: Artefact | None,
        found: Rechecked | None,
    ) -> Iterator[str]:
        """In what a step's verdict is not about what the step asks, or does not show it."""
        if found is not None and not found.holds:
            yield f"its verdict does not hold: {found.reasons[0]}"
        if verdict.outcome is not step.outcome:
            yield f"it is said to be {step.outcome.value}, and its verdict says {verdict.outcome.value}"
        if verdict.outcome is Outcome.CERTIFIED and artefact is None:
            yield "its verdict is certified, and has no certificate"
        if (None if artefact is None else sha256(artefact.content).hexdigest()) != step.artefact:
            yield "its verdict has another motion or proof than the one that was chosen"
        yield from self._is_asked_otherwise(request, verdict)

    def _is_asked_otherwise(self, request: Request, verdict: StoredVerdict) -> Iterator[str]:
        said = dict(verdict.inputs)
        wanted = {name: value for name, value in self.stored.inputs if name not in OF_THE_RESULT}
        for name in sorted({*said, *wanted} - OF_THE_STEP):
            if said.get(name, UNKNOWN_INPUT) != wanted.get(name, UNKNOWN_INPUT):
                yield f"its verdict's input '{name}' is {said.get(name)}, the result's {wanted.get(name)}"
        if said.get("state") != state_hash(self.walk.twin.state):
            yield "its verdict does not begin where the step before ended, or the task begins"
        container, position = request.container, request.position
        task = UNKNOWN_INPUT if position is not None else task_text(Task(request.verb, container.iri))
        if said.get("task") != task:
            yield f"its verdict's input 'task' is {said.get('task')}, asked is {task}"
        goal = None if position is None else opened_to(container, position)
        if goal_of(said.get("final", "")) != goal:
            yield f"its verdict's input 'final' is {said.get('final')}, asked is '{request}'"

    def _rules(self) -> list[RuleAnswer]:
        """Those that hold all along, over what is certified; those about the end where all of it is."""
        walk, rules = self.walk, self.walk.specification.rules
        if not walk.legs:
            return []
        asked = [each for each in rules if not at_the_end(each)]
        asked += [each for each in rules if at_the_end(each) and walk.complete]
        swept, queries = Swept(self.stored.robot), InGraph(walk.twin)
        return [checked(rule, walk.legs, swept, queries) for rule in asked]

    def _values_differ(self) -> Iterator[str]:
        """In what J is another than that of the steps' motions."""
        quality = self.walk.specification.quality
        if quality is None:
            return
        values = [_value(quality, twin, certificate) for twin, certificate in self._taken]
        for number, (step, value) in enumerate(zip(self.stored.steps, values, strict=False), 1):
            if not _same(value, step.value):
                yield f"step {number}, {step}: J is {step.value} in the result, {value} of its motion"
        whole = total(quality, values) if self.stored.outcome is Outcome.CERTIFIED else None
        if not _same(whole, self.stored.value):
            yield f"J of the whole is {self.stored.value} in the result, {whole} of its motions"


def _value(quality: Quality, twin: Twin, certificate: Certificate | None) -> float | None:
    """J of a step's certified motion, which begins in the twin's state."""
    if certificate is None:
        return None

    def work(motion: BodyMotion) -> float | None:
        return mechanical_work(Scene(twin, certificate.robot), motion)

    performed = Answer(Case(twin), holds=True, figures=certificate.figures)
    return measured(quality, certificate.motion, performed, work)


def _is_other(step: StoredStep, request: Request) -> Iterator[str]:
    asked = request.verb, request.container.iri, request.position
    if (step.verb, step.container, step.position) != asked:
        yield f"the specification asks '{request}' here"


def _ends(
    request: Request, twin: Twin, certificate: Certificate, physics: Physics
) -> tuple[State, Mapping[str, tuple[float, str]]]:
    """The state in which a certified motion ends, by Φ, and the figures of Causes."""
    case = Case(twin, certificate.robot, body_motion=certificate.motion)
    carried = with_carried(case, certificate.motion, request.container, physics)
    caused = next(causes(unhurried(carried), physics))
    assert isinstance(caused.case.final, State), "what was certified has a final state"
    return caused.case.final, caused.figures


def _rules_differ(stored: StoredResult, answers: Sequence[RuleAnswer]) -> Iterator[str]:
    found = [(each.rule, each.standing) for each in answers]
    for number, (was, now) in enumerate(zip_longest(stored.rules, found), 1):
        if was != now:
            yield f"rule {number} is {_standing(was)} in the result, and {_standing(now)}"


def _standing(rule: tuple[str, Standing] | None) -> str:
    return "not there" if rule is None else f"'{rule[0]}', {rule[1].value},"


def _same(one: float | None, other: float | None) -> bool:
    if one is None or other is None:
        return one is other
    return math.isclose(one, other, rel_tol=SAME_FIGURE, abs_tol=SAME_FIGURE)
