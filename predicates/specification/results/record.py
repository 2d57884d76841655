"""Result of a task specification → triples: PROV-O and law:, in a named graph of its own."""

import hashlib
from collections.abc import Iterator
from typing import Final

import pyoxigraph as ox

from predicates.record.artefacts import artefact_of
from predicates.record.explained import allowance_triples, position_triples
from predicates.record.facts import Facts
from predicates.record.recall import budget_of
from predicates.record.seal import sealed
from predicates.record.stored import OUTCOME_TERM, read_inputs
from predicates.record.triples import Record, diagnosis_triples, provenance_triples
from predicates.scope import tee_class_of_hash, verb_iri
from predicates.specification.model import Quality
from predicates.specification.quality import UNITS, better
from predicates.specification.results.result import StepResult, TaskResult
from predicates.specification.rules import RuleAnswer, Standing
from sdt_kg.iri import LAW, PROV, RDF, RDFS, Iri, graph_iri, local_name, part_iri
from sdt_kg.motion import BodyMotion
from sdt_kg.store import Term, Triple

STANDING_TERM: Final = {
    Standing.KEPT: "Kept",
    Standing.BROKEN: "Broken",
    Standing.UNBOUNDED: "NotBounded",
}


def task_record(result: TaskResult) -> Record:
    """The result as PROV-O and law: triples, no blank nodes; each step names the verdict that it rests on.

    The verdicts of the steps have records of their own.
    """
    graph = graph_iri("task_result", local_name(result.iri))
    steps = [each for index, step in enumerate(result.steps, 1) for each in _step(result, index, step)]
    rules = [each for index, rule in enumerate(result.rules, 1) for each in _rule(result, index, rule)]
    twin = result.case.twin
    moved = position_triples(result.iri, twin.entities.coupling.start(), twin.state)
    allowed = allowance_triples(result.iri, twin)
    provenance = provenance_triples(result.iri, result.inputs)
    triples = (*_result(result), *moved, *allowed, *steps, *rules, *provenance)
    return Record(result.iri, graph, sealed(result.iri, triples))


def gives_way(stored: list[ox.Quad], fresh: list[ox.Quad], result: Iri) -> bool:
    """Whether the stored record of a task's result is to be replaced by this one.

    What is certified gives way to what is certified and better by J only; anything else, to what is
    certified and to the answer of a search that was allowed longer.
    """
    before, after = Facts(stored), Facts(fresh)
    if _outcome(before, result) == "Certified":
        return _outcome(after, result) == "Certified" and _better(after, before, result)
    return _outcome(after, result) == "Certified" or _budget(after, result) > _budget(before, result)


def _outcome(facts: Facts, result: Iri) -> str:
    return local_name(facts.needed(result, LAW + "taskOutcome"))


def _budget(facts: Facts, result: Iri) -> float:
    return budget_of(read_inputs(facts, result))


def _better(one: Facts, other: Facts, result: Iri) -> bool:
    values = [each.number(result, LAW + "qualityValue") for each in (one, other)]
    if values[0] is None or values[1] is None:
        return values[1] is None and values[0] is not None
    return better(Quality(local_name(one.needed(result, LAW + "comparedBy"))), values[0], values[1])


def _result(result: TaskResult) -> Iterator[Triple]:
    """Outcome, what was asked of whom, J, the rule that was broken first, all reasons."""
    subject, asked = result.iri, result.specification
    yield subject, RDF + "type", _node(LAW + "TaskResult")
    yield subject, RDFS + "label", ox.Literal(asked.label)
    yield subject, LAW + "taskOutcome", _node(LAW + OUTCOME_TERM[result.outcome])
    yield subject, LAW + "specification", _node(asked.iri)
    yield asked.iri, RDF + "type", _node(LAW + "TaskSpecification")
    if asked.written:
        yield subject, LAW + "writtenAs", ox.Literal(asked.written)
    yield subject, LAW + "environment", _node(result.case.twin.environment)
    if isinstance(result.case.robot, str):
        yield subject, LAW + "robot", _node(result.case.robot)
    if (tee := tee_class_of_hash(dict(result.inputs)["tee_class"])) is not None:
        yield subject, LAW + "teeClass", _node(tee.iri)
    yield subject, LAW + "stepsAsked", ox.Literal(result.of)
    yield subject, LAW + "rulesAsked", ox.Literal(len(asked.rules))
    yield subject, LAW + "seconds", ox.Literal(result.seconds)
    yield from _quality(subject, asked.quality, result.value)
    for index, diagnosis in enumerate(result.diagnoses, 1):
        of = part_iri(subject, "diagnosis", index)
        yield subject, LAW + "diagnosis", _node(of)
        yield from diagnosis_triples(of, diagnosis)
    if result.broken is not None:
        first = part_iri(subject, "rule", result.rules.index(result.broken) + 1)
        yield subject, LAW + "firstBroken", _node(first)


def _quality(of: Iri, quality: Quality | None, value: float | None) -> Iterator[Triple]:
    if quality is None:
        return
    yield of, LAW + "comparedBy", _node(LAW + quality.value)
    if value is not None:
        yield of, LAW + "qualityValue", ox.Literal(value)
        yield of, LAW + "unit", ox.Literal(UNITS[quality])


def _step(result: TaskResult, index: int, step: StepResult) -> Iterator[Triple]:
    """The request, the verdict that counts with its motion, and among how many it was chosen."""
    of, task = part_iri(result.iri, "step", index), part_iri(result.iri, "task", index)
    request, verdict = step.request, step.verdict
    yield result.iri, LAW + "stepResult", _node(of)
    yield of, RDF + "type", _node(LAW + "StepResult")
    yield of, LAW + "task", _node(task)
    yield task, RDF + "type", _node(LAW + "Task")
    yield task, LAW + "index", ox.Literal(index)
    yield task, LAW + "verb", _node(verb_iri(request.verb))
    yield task, LAW + "container", _node(request.container.iri)
    if request.position is not None:
        yield task, LAW + "goalPosition", ox.Literal(float(request.position))
    yield of, LAW + "taskOutcome", _node(LAW + OUTCOME_TERM[verdict.outcome])
    yield of, LAW + "verdict", _node(verdict.iri)
    yield of, PROV + "wasDerivedFrom", _node(verdict.iri)
    yield of, LAW + "searchSeed", ox.Literal(step.seed)
    yield of, LAW + "searches", ox.Literal(step.tried)
    yield of, LAW + "compared", ox.Literal(step.compared)
    yield from _quality(of, result.specification.quality, step.value)
    if isinstance(verdict.case.body_motion, BodyMotion):
        yield of, LAW + "bodyMotion", _node(part_iri(verdict.iri, "body_motion", 1))
    if (artefact := artefact_of(verdict)) is not None:
        yield of, LAW + "artefactHash", ox.Literal(hashlib.sha256(artefact.content).hexdigest())


def _rule(result: TaskResult, index: int, answer: RuleAnswer) -> Iterator[Triple]:
    """The rule in words, what is known of it and how; where it is broken, in which step, when and why."""
    of = part_iri(result.iri, "rule", index)
    yield result.iri, LAW + "ruleAnswer", _node(of)
    yield of, RDF + "type", _node(LAW + "RuleAnswer")
    yield of, RDFS + "label", ox.Literal(answer.rule)
    yield of, LAW + "standing", _node(LAW + STANDING_TERM[answer.standing])
    yield of, LAW + "checkedHow", ox.Literal(answer.how)
    if answer.step is not None:
        yield of, LAW + "inStep", _node(part_iri(result.iri, "step", answer.step))
    if answer.time is not None:
        yield of, LAW + "time", ox.Literal(float(answer.time))
    if answer.state is not None:
        yield from position_triples(of, result.case.twin.entities.coupling.start(), answer.state)
    if answer.diagnosis is not None:
        reason = part_iri(of, "diagnosis", 1)
        yield of, LAW + "diagnosis", _node(reason)
        yield from diagnosis_triples(reason, answer.diagnosis)


def _node(iri: Iri) -> Term:
    return ox.NamedNode(iri)
