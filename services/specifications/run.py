"""Task specifications on a service: each step judged from where the last one ended, rules, the best by J."""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from predicates.case import Answer, Case, Outcome, Verdict
from predicates.causes import nothing_to_cause
from predicates.oracle import LET_GO, RESTLESS, not_checked
from predicates.specification.leg import Leg
from predicates.specification.model import KeepsDistance, Rule, Specification
from predicates.specification.quality import better, measured, total
from predicates.specification.queries import InGraph
from predicates.specification.results.result import StepResult, TaskResult, task_inputs
from predicates.specification.rules import RuleAnswer, Standing, at_the_end, checked, first_broken
from predicates.specification.step import Request, judged
from predicates.specification.walk import Taken, Walk
from sdt_kg.iri import Iri
from sdt_kg.motion import BodyMotion
from sdt_kg.state import State
from services.app import Service

MOST_MOTIONS = 8
"""[1] Seeds that are tried for a step, if the budget lasts, where motions are compared by J, or where one
that comes too near to a body might be replaced by one that does not."""

Told = Callable[[StepResult, int], None]

NOTHING_TO_DO = nothing_to_cause("every container already meets the request")


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
    run.walk.go(run.take, lambda asked: told(run.steps[-1], asked))
    return run.result(time.perf_counter() - began)


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
        from services.embodiment.certify.tasks.near import Swept  # noqa: PLC0415 - loads the oracle

        self.service, self.specification, self.robot = service, specification, robot
        self.walk, case = Walk(service.twin, specification), Case(service.twin, robot=robot)
        self._case, self._inputs = case, task_inputs(specification, case, service.physics, service.embodiment)
        self.steps: list[StepResult] = []
        self._answers: list[RuleAnswer] = []
        self._queries, self._clearance = InGraph(service.twin), Swept(robot)
        self._ends: list[Rule] = [each for each in specification.rules if at_the_end(each)]
        self._depends = any(isinstance(each, KeepsDistance) for each in specification.rules)
        self._always: list[Rule] = [each for each in specification.rules if not at_the_end(each)]

    def take(self, request: Request) -> Taken:
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
            return Taken(best.verdict.outcome)
        self._answers = best.answers
        final, figures = best.verdict.case.final, _caused(best.verdict)
        assert isinstance(final, State), "what is certified has a final state"
        return Taken(best.verdict.outcome, best.leg, final, LET_GO in figures, RESTLESS in figures)

    def _tried(self, request: Request, seed: int) -> "_Try":
        verdict = self._judged(request, seed)
        leg = self._leg(verdict)
        answers = [] if leg is None else self._checked(self._always, [*self.walk.legs, leg])
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
        return judged(request, self.walk.twin, self.robot, self.service.physics, embodiment)

    def _leg(self, verdict: Verdict) -> Leg | None:
        body = verdict.case.body_motion
        if verdict.outcome is not Outcome.CERTIFIED or not isinstance(body, BodyMotion):
            return None
        return Leg.of(len(self.steps) + 1, self.walk.twin, body, not_checked(_caused(verdict)))

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
        from services.embodiment.certify.tasks.work import mechanical_work  # noqa: PLC0415 - loads the oracle
        from services.physics.model import Scene  # noqa: PLC0415 - see above

        return mechanical_work(Scene(self.walk.twin, self.robot), motion)

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

    def result(self, seconds: float) -> TaskResult:
        """What the steps and rules add up to."""
        walk = self.walk
        ends = self._checked(self._ends, walk.legs) if walk.complete and walk.legs else []
        answers = [*self._answers, *ends]
        broken = first_broken(answers)
        outcome = walk.outcome(each.standing for each in answers)
        diagnoses = [] if broken is None or broken.diagnosis is None else [broken.diagnosis]
        others = [each.diagnosis for each in answers if each is not broken and each.diagnosis is not None]
        refused = [each for step in self.steps for each in step.verdict.diagnoses]
        refused += walk.reasons
        refused += [] if self.steps else [NOTHING_TO_DO]
        return TaskResult(
            specification=self.specification,
            case=self._case,
            inputs=self._inputs,
            outcome=outcome,
            steps=tuple(self.steps),
            of=walk.expected,
            rules=tuple(answers),
            diagnoses=(*diagnoses, *others, *refused),
            broken=broken,
            value=self._total() if outcome is Outcome.CERTIFIED else None,
            seconds=seconds,
        )

    def _total(self) -> float | None:
        quality = self.specification.quality
        return None if quality is None else total(quality, [step.value for step in self.steps])


def _caused(verdict: Verdict) -> dict[str, tuple[float, str]]:
    """What Φ found in figures."""
    return {} if verdict.causes is None else verdict.causes.figures
