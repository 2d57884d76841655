"""Task specifications on a service: each step judged from where the last one ended, rules, the best by J."""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from predicates.case import Answer, Case, Diagnosis, Kind, Outcome, Verdict
from predicates.oracle import LET_GO
from predicates.satisfies_request import met_requests
from predicates.specification.leg import Leg
from predicates.specification.model import Demand, KeepsDistance, QueryRule, Rule, Specification, Step
from predicates.specification.quality import better, measured, total
from predicates.specification.queries import InGraph
from predicates.specification.result import StepResult, TaskResult, task_inputs
from predicates.specification.rules import RuleAnswer, Standing, checked, first_broken
from predicates.specification.step import Request, judged
from sdt_kg.iri import Iri
from sdt_kg.motion import BodyMotion
from sdt_kg.state import State
from sdt_kg.twin import Twin
from services.app import Service
from services.specifications.clearance import Swept

MOST_MOTIONS = 8
"""[1] Seeds that are tried for a step, if the budget lasts, where motions are compared by J, or where one
that comes too near to a body might be replaced by one that does not."""

Told = Callable[[StepResult, int], None]

NOTHING_TO_DO = Diagnosis(
    Kind.CAUSAL, "nothing to cause: every container already meets the request", proof=True
)


def achieve_task(
    service: Service, specification: Specification, robot: str | None = None, told: Told = lambda *_: None
) -> TaskResult:
    """Every step, every rule, and what follows: certified only if all are.

    Each step is judged from the state in which the step before ended; the robot begins each at its
    start pose, parked. Seeds are tried until the policy's budget for a step is spent, if there is a J.

    Args:
        service: The Law over a kitchen.
        specification: About that kitchen.
        robot: Name or IRI of a loaded robot; may be left out where only one is loaded.
        told: Is called after each step, with what became of it and how many steps there are.
    """
    began, run = time.perf_counter(), _Run(service, specification, service.robot(robot))
    expected = 0
    for number, step in enumerate(specification.steps, 1):
        requests = _requests(run.twin, step)
        expected += len(requests)
        for request in requests:
            if step.container is None and _meets(run.twin, request):
                expected -= 1  # what moves together did it on the way
            elif run.may_take(request):
                run.take(request)
                told(run.steps[-1], expected + len(specification.steps) - number)
        run.look_back(step)
        if run.stopped:
            expected += len(specification.steps) - number
            break
    return run.result(expected, time.perf_counter() - began)


def _requests(twin: Twin, step: Step) -> list[Request]:
    """What a step asks in a state: every container means those that do not meet the request yet."""
    if step.container is not None:
        return [Request(step.verb, step.container, step.position)]
    every = (Request(step.verb, each) for each in twin.containers())
    return [each for each in every if not _meets(twin, each)]


def _meets(twin: Twin, request: Request) -> bool:
    """Whether the state meets a request that every container is asked."""
    return (request.verb, request.container.iri) in met_requests(twin, twin.state)


@dataclass(frozen=True, slots=True)
class _Try:
    """One search for a step, and what becomes of the rules with it."""

    seed: int
    verdict: Verdict
    leg: Leg | None
    value: float | None
    answers: list[RuleAnswer]

    @property
    def clean(self) -> bool:
        """Whether it is certified and breaks no rule."""
        return self.leg is not None and all(each.standing is not Standing.BROKEN for each in self.answers)


class _Run:
    """A sequence on its way."""

    def __init__(self, service: Service, specification: Specification, robot: Iri) -> None:
        self.service, self.specification, self.robot = service, specification, robot
        self.twin, case = service.twin, Case(service.twin, robot=robot)
        self._case, self._inputs = case, task_inputs(specification, case, service.physics, service.embodiment)
        self.steps: list[StepResult] = []
        self.legs: list[Leg] = []
        self._adrift: Request | None = None
        self._undone: list[Diagnosis] = []
        self._unsure: list[Diagnosis] = []
        self._answers: list[RuleAnswer] = []
        self._queries, self._clearance = InGraph(service.twin), Swept(robot)
        self._ends: list[Rule] = [each for each in specification.rules if _at_the_end(each)]
        self._depends = any(isinstance(each, KeepsDistance) for each in specification.rules)
        self._always: list[Rule] = [each for each in specification.rules if not _at_the_end(each)]

    def take(self, request: Request) -> None:
        """Judge one more step."""
        began, found = time.perf_counter(), list[_Try]()
        for seed in self._seeds(began):
            found.append(self._tried(request, seed))
            certified, clean = found[-1].leg is not None, found[-1].clean
            if self.specification.quality is None and (clean or not certified or not self._depends):
                break
        best, compared = self._best(found), sum(each.clean for each in found)
        self.steps.append(StepResult(request, best.verdict, best.seed, len(found), compared, best.value))
        if best.leg is None:
            return
        self.legs.append(best.leg)
        self._answers = best.answers
        assert isinstance(best.verdict.case.final, State), "what is certified has a final state"
        self.twin = self.twin.at(best.verdict.case.final)
        caused = best.verdict.causes
        self._adrift = request if caused is not None and LET_GO in caused.figures else None

    def may_take(self, request: Request) -> bool:
        """Whether one more step can be judged: it is known where the last one has left the kitchen."""
        if self._adrift is not None and not self.stopped:
            self._unsure.append(_drifts(self._adrift, f"nobody knows where '{request}' begins"))
        return not self.stopped

    def look_back(self, step: Step) -> None:
        """See what of a step for every container is undone at its end, by what moves together."""
        if step.container is not None or self.stopped:
            return
        for each in _requests(self.twin, step):
            reason = (
                f"'{each}' is not so at the end of the step for every container: what moves with it undid it"
            )
            self._undone.append(Diagnosis(Kind.SEMANTIC, reason))

    @property
    def stopped(self) -> bool:
        """Whether what was judged last is not certified, so that no other step can follow."""
        return len(self.legs) < len(self.steps) or bool(self._undone or self._unsure)

    def _tried(self, request: Request, seed: int) -> "_Try":
        verdict = self._judged(request, seed)
        leg = self._leg(verdict)
        answers = [] if leg is None else self._checked(self._always, [*self.legs, leg])
        return _Try(seed, verdict, leg, self._value(verdict), answers)

    def _seeds(self, began: float) -> Iterator[int]:
        """Seeds from the policy's on, while there is budget; the first in any case."""
        policy = self.service.policy
        for k in range(MOST_MOTIONS):
            if k and time.perf_counter() - began >= policy.budget:
                return
            yield policy.seed + k

    def _judged(self, request: Request, seed: int) -> Verdict:
        service = replace(self.service, policy=replace(self.service.policy, seed=seed))
        embodiment = self.service.embodiment if seed == self.service.policy.seed else service.embodiment
        return judged(request, self.twin, self.robot, self.service.physics, embodiment)

    def _leg(self, verdict: Verdict) -> Leg | None:
        body = verdict.case.body_motion
        if verdict.outcome is not Outcome.CERTIFIED or not isinstance(body, BodyMotion):
            return None
        return Leg.of(len(self.steps) + 1, self.twin, body)

    def _checked(self, rules: Sequence[Rule], legs: Sequence[Leg]) -> list[RuleAnswer]:
        return [checked(rule, legs, self._clearance, self._queries) for rule in rules]

    def _value(self, verdict: Verdict) -> float | None:
        quality, performed, body = self.specification.quality, verdict.can_perform, verdict.case.body_motion
        if quality is None or verdict.outcome is not Outcome.CERTIFIED:
            return None
        assert isinstance(performed, Answer)
        assert isinstance(body, BodyMotion)
        return measured(quality, body, performed, self._work)

    def _work(self, motion: BodyMotion) -> float | None:
        """Of a motion that begins in the present state."""
        from services.physics.model import Scene  # noqa: PLC0415 - loads the oracle
        from services.specifications.work import mechanical_work  # noqa: PLC0415 - see above

        return mechanical_work(Scene(self.twin, self.robot), motion)

    def _best(self, found: Sequence["_Try"]) -> "_Try":
        """Certified and clean before certified before refused; among equals the best by J, then the first."""
        best, quality = found[0], self.specification.quality
        for each in found[1:]:
            mine, its = (each.clean, each.leg is not None), (best.clean, best.leg is not None)
            value, other = each.value, best.value
            improves = (
                quality is not None and value is not None and (other is None or better(quality, value, other))
            )
            if mine > its or (mine == its and improves):
                best = each
        return best

    def result(self, expected: int, seconds: float) -> TaskResult:
        """What the steps and rules add up to."""
        complete = len(self.steps) == expected and len(self.legs) == expected
        if complete and self._adrift is not None and self.specification.rules:
            self._unsure.append(_drifts(self._adrift, "nothing bounds what the rules are about from then on"))
        ends = self._checked(self._ends, self.legs) if complete and self.legs else []
        answers = [*self._answers, *ends]
        broken = first_broken(answers)
        outcome = self._outcome(complete, answers)
        diagnoses = [] if broken is None or broken.diagnosis is None else [broken.diagnosis]
        others = [each.diagnosis for each in answers if each is not broken and each.diagnosis is not None]
        refused = [each for step in self.steps for each in step.verdict.diagnoses]
        refused += [*self._undone, *self._unsure]
        refused += [] if self.steps else [NOTHING_TO_DO]
        return TaskResult(
            specification=self.specification,
            case=self._case,
            inputs=self._inputs,
            outcome=outcome,
            steps=tuple(self.steps),
            of=expected,
            rules=tuple(answers),
            diagnoses=(*diagnoses, *others, *refused),
            broken=broken,
            value=self._total() if outcome is Outcome.CERTIFIED else None,
            seconds=seconds,
        )

    def _outcome(self, complete: bool, answers: Sequence[RuleAnswer]) -> Outcome:
        standings = {each.standing for each in answers}
        verdicts = {step.verdict.outcome for step in self.steps}
        if not self.steps or self._undone:
            return Outcome.NOT_CERTIFIED
        if Standing.BROKEN in standings or Outcome.NOT_CERTIFIED in verdicts:
            return Outcome.NOT_CERTIFIED
        if not complete or self._unsure or verdicts != {Outcome.CERTIFIED}:
            return Outcome.ABSTAINED
        return Outcome.CERTIFIED if standings <= {Standing.KEPT} else Outcome.ABSTAINED

    def _total(self) -> float | None:
        quality, values = self.specification.quality, [step.value for step in self.steps]
        known = [value for value in values if value is not None]
        return total(quality, known) if quality is not None and len(known) == len(values) else None


def _drifts(request: Request, so: str) -> Diagnosis:
    reason = f"{request.container.name} may move when it is let go after '{request}', so that {so}"
    return Diagnosis(Kind.OUT_OF_SCOPE, reason)


def _at_the_end(rule: Rule) -> bool:
    return isinstance(rule, QueryRule) and rule.demand is Demand.AT_THE_END
