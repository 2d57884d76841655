"""Results of tasks as a store holds them: triples → values."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import pyoxigraph as ox

from predicates.case import Outcome
from predicates.record.facts import Facts, term
from predicates.record.inputs import Inputs
from predicates.record.seal import check_seal, check_unbroken, read_triples
from predicates.record.stored import OUTCOMES, VERBS, read_inputs, read_positions, records_of
from predicates.specification.results.record import STANDING_TERM
from predicates.specification.rules import Standing
from predicates.specification.step import in_words
from sdt_kg.iri import LAW, RDFS, Iri, task_result_iri
from sdt_kg.task import Verb

ONCE: Final = (
    *("taskOutcome", "environment", "robot", "teeClass", "handleForce", "stepsAsked", "qualityValue"),
    "writtenAs",
)
"""What a record says of its result no more than once."""

_STANDING: Final = {name: standing for standing, name in STANDING_TERM.items()}


@dataclass(frozen=True, slots=True)
class StoredStep:
    """What a store says of a step: what was asked, the verdict that counts, the hash of what shows it, J."""

    verb: Verb
    container: Iri
    position: float | None
    outcome: Outcome
    verdict: Iri
    artefact: str | None
    value: float | None

    def __str__(self) -> str:
        return in_words(self.verb, self.container, self.position)


@dataclass(frozen=True, slots=True)
class StoredResult:
    """What a store says of a task's result.

    Attributes:
        written: The specification in Turtle; empty where it was not kept.
        moved: Joint → position [rad or m] of what is not where the kitchen starts, as the first step begins.
        asked: How many steps there are.
        rules: What each says in words, and what is known of it.
        value: J of the whole sequence.
        tee_class: IRI of the class D that it is relative to; None where that is not said.
    """

    iri: Iri
    label: str
    outcome: Outcome
    environment: Iri
    robot: Iri
    written: str
    inputs: Inputs
    moved: dict[Iri, float]
    asked: int
    steps: tuple[StoredStep, ...]
    rules: tuple[tuple[str, Standing], ...]
    value: float | None
    tee_class: Iri | None = None


def results_of(store: ox.Store) -> list[Iri]:
    """IRIs of all results of task specifications of a store, in order."""
    return records_of(store, "TaskResult", "task_result", task_result_iri)


def read_result(quads: Iterable[ox.Quad], iri: Iri) -> StoredResult:
    """The result of this IRI, whose graph these quads are.

    Raises:
        InputError: The record is damaged, or was changed after it was written.
    """
    written = list(quads)
    result = _result(Facts(written), iri)
    if result.written:
        check_seal(iri, written)
    else:  # versions that did not keep it did not seal either
        check_unbroken(iri, read_triples(written))
    return result


def _result(facts: Facts, iri: Iri) -> StoredResult:
    facts.check_kind(iri, "TaskResult")
    facts.check_once(iri, (LAW + name for name in ONCE))
    return StoredResult(
        iri=iri,
        label=facts.needed(iri, RDFS + "label"),
        outcome=term(OUTCOMES, facts.needed(iri, LAW + "taskOutcome")),
        environment=facts.needed(iri, LAW + "environment"),
        robot=facts.needed(iri, LAW + "robot"),
        written=facts.text(iri, LAW + "writtenAs") or "",
        inputs=read_inputs(facts, iri),
        moved=read_positions(facts, iri),
        asked=int(facts.measured(iri, LAW + "stepsAsked")),
        steps=tuple(_step(facts, each) for each in facts.all(iri, LAW + "stepResult")),
        rules=tuple(_rule(facts, each) for each in facts.all(iri, LAW + "ruleAnswer")),
        value=facts.number(iri, LAW + "qualityValue"),
        tee_class=facts.text(iri, LAW + "teeClass"),
    )


def _step(facts: Facts, of: Iri) -> StoredStep:
    task = facts.needed(of, LAW + "task")
    return StoredStep(
        verb=term(VERBS, facts.needed(task, LAW + "verb")),
        container=facts.needed(task, LAW + "container"),
        position=facts.number(task, LAW + "goalPosition"),
        outcome=term(OUTCOMES, facts.needed(of, LAW + "taskOutcome")),
        verdict=facts.needed(of, LAW + "verdict"),
        artefact=facts.text(of, LAW + "artefactHash"),
        value=facts.number(of, LAW + "qualityValue"),
    )


def _rule(facts: Facts, of: Iri) -> tuple[str, Standing]:
    return facts.needed(of, RDFS + "label"), term(_STANDING, facts.needed(of, LAW + "standing"))
