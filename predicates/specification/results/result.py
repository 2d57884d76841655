"""What became of a task specification: its steps, its rules, J."""

from dataclasses import dataclass

from predicates.case import Case, Diagnosis, Outcome, Verdict
from predicates.oracle import Embodiment, Physics
from predicates.record.inputs import UNKNOWN_INPUT, Inputs, input_hash, inputs_of
from predicates.specification.model import Specification
from predicates.specification.rules import RuleAnswer
from predicates.specification.step import Request
from sdt_kg.iri import Iri, task_result_iri

RULES_VERSION = "9"
"""Raised whenever the judgement of steps and rules or the choice by J may change."""


@dataclass(frozen=True, slots=True)
class StepResult:
    """A step's verdict, and by what it was chosen.

    Attributes:
        verdict: The one that counts.
        seed: Of its search.
        tried: Searches made.
        compared: Certified motions that broke no rule, among which it is the best by J.
        value: J of its motion; None where there is no J, no motion, or nobody measured it.
    """

    request: Request
    verdict: Verdict
    seed: int
    tried: int
    compared: int
    value: float | None


@dataclass(frozen=True, slots=True)
class TaskResult:
    """What became of a task specification.

    Attributes:
        case: Kitchen and robot in the state in which the first step begins.
        inputs: All that decides the result: name → value or hash.
        steps: As far as they were judged: the first that is not certified is the last.
        of: How many steps there are; those for every container count as found on the way.
        rules: What became of each rule, over the steps that are certified.
        broken: The rule that was broken first.
        value: J of the whole sequence, where it is certified and measured.
    """

    specification: Specification
    case: Case
    inputs: Inputs
    outcome: Outcome
    steps: tuple[StepResult, ...]
    of: int
    rules: tuple[RuleAnswer, ...]
    diagnoses: tuple[Diagnosis, ...]
    broken: RuleAnswer | None
    value: float | None
    seconds: float

    @property
    def iri(self) -> Iri:
        """The hash of all inputs."""
        return task_result_iri(input_hash(self.inputs))


def task_inputs(specification: Specification, case: Case, physics: Physics, embodiment: Embodiment) -> Inputs:
    """Inputs of a task's result: those of its first step but for the request, and the specification.

    Not hashed is what it is called: its IRI and its label are for people.
    """
    asked = [each for each in inputs_of(case, physics, embodiment) if each[1] != UNKNOWN_INPUT]
    return (*asked, ("specification", content_hash(specification)), ("rules", RULES_VERSION))


def content_hash(specification: Specification) -> str:
    """Hash of what a specification asks, whatever it is called."""
    content = repr((specification.steps, specification.rules, specification.quality))
    return input_hash((("content", content),))
