"""What lets a record explain itself: the answer of each predicate, and the SHACL report of an abstention."""

import hashlib
from collections.abc import Iterator

import pyoxigraph as ox

from predicates.case import Answer, Verdict
from predicates.record.inputs import UNKNOWN_INPUT
from predicates.record.report import answers
from sdt_kg.entities import query_text
from sdt_kg.iri import LAW, PROV, RDF, SH, Iri, part_iri
from sdt_kg.shacl import Violation
from sdt_kg.state import State
from sdt_kg.store import Term, Triple, term_of
from sdt_kg.twin import Twin

PREDICATE_TERM = {"satisfiesRequest": "SatisfiesRequest", "causes": "Causes", "canPerform": "CanPerform"}
"""Property of a verdict → individual that stands for the predicate."""

_OF_KITCHEN = ("environment", "state")
_OF_MOTION = ("motion", "body_motion")
_RESTS_ON = {
    "satisfiesRequest": ("environment", "task", "final", "tee_class"),
    "causes": (*_OF_KITCHEN, "task", *_OF_MOTION, "final", "tee_class", "physics"),
    "canPerform": (*_OF_KITCHEN, "robot", *_OF_MOTION, "embodiment"),
}
"""Predicate → inputs that its answer is derived from; those of the embodiment oracle go with it."""


def answer_triples(verdict: Verdict) -> Iterator[Triple]:
    """One law:Answer for each predicate that was asked: what it says, from what, by whom, how long."""
    asked = {name: answer for name, answer in answers(verdict).items() if answer is not None}
    for index, (name, answer) in enumerate(answers(verdict).items(), 1):
        if answer is None:
            continue
        of = part_iri(verdict.iri, "answer", index)
        yield verdict.iri, LAW + "answer", ox.NamedNode(of)
        yield of, RDF + "type", ox.NamedNode(LAW + "Answer")
        yield of, LAW + "predicate", ox.NamedNode(LAW + PREDICATE_TERM[name])
        yield of, LAW + "holds", ox.Literal(answer.holds)
        if answer.seconds:
            yield of, LAW + "seconds", ox.Literal(float(sum(answer.seconds.values())))
        yield of, LAW + "version", ox.Literal(_version(verdict, name))
        for source in _sources(verdict, name, asked):
            yield of, PROV + "wasDerivedFrom", ox.NamedNode(source)


def _version(verdict: Verdict, predicate: str) -> str:
    """Who answered: the oracle, or for SatisfiesRequest its query and who evaluated it."""
    inputs = dict(verdict.inputs)
    if predicate == "causes":
        return inputs["physics"]
    if predicate == "canPerform":
        return inputs["embodiment"]
    digest = hashlib.sha256(query_text("satisfied_requests").encode()).hexdigest()
    return f"satisfied_requests.rq {digest[:16]}, pyoxigraph {ox.__version__}"


def _sources(verdict: Verdict, predicate: str, asked: dict[str, Answer]) -> Iterator[Iri]:
    """Inputs, and the answer that gave the motion or final state which this one is about."""
    numbers = {name: index for index, (name, _) in enumerate(verdict.inputs, 1)}
    known = dict(verdict.inputs)
    for name in (*_RESTS_ON[predicate], *_settings(verdict, predicate)):
        if known.get(name, UNKNOWN_INPUT) != UNKNOWN_INPUT:
            yield part_iri(verdict.iri, "input", numbers[name])
    solved = known.get("body_motion") == UNKNOWN_INPUT
    executed = solved and "canPerform" in asked and asked["canPerform"].holds
    before = {
        "satisfiesRequest": "causes",
        "causes": "canPerform" if executed else "",
        "canPerform": "causes" if solved and not executed else "",
    }[predicate]
    if before in asked:
        yield part_iri(verdict.iri, "answer", list(PREDICATE_TERM).index(before) + 1)


def _settings(verdict: Verdict, predicate: str) -> Iterator[str]:
    if predicate == "canPerform":
        yield from (name for name, _ in verdict.inputs if name.startswith("embodiment."))


def position_triples(judged: Iri, start: State, state: State) -> Iterator[Triple]:
    """Joints that are not where the kitchen starts, and where they are: the state s in which was asked."""
    began = dict(start.items())
    moved = [(joint, at) for joint, at in sorted(state.items()) if at != began[joint]]
    for index, (joint, position) in enumerate(moved, 1):
        of = part_iri(judged, "joint_position", index)
        yield judged, LAW + "jointPosition", ox.NamedNode(of)
        yield of, RDF + "type", ox.NamedNode(LAW + "JointPosition")
        yield of, LAW + "entity", ox.NamedNode(joint)
        yield of, LAW + "value", ox.Literal(float(position))


def allowance_triples(judged: Iri, twin: Twin) -> Iterator[Triple]:
    """The force [N] at every handle, if who asked allowed one."""
    allowed = twin.entities.facts.one(twin.environment, "allowedAtEveryHandle")
    if allowed is not None:
        yield judged, LAW + "handleForce", term_of(allowed)


def scope_triples(verdict: Verdict) -> Iterator[Triple]:
    """The SHACL validation report of an abstention; each diagnosis is derived from a result of it."""
    found = [
        (index, each.violation)
        for index, each in enumerate(verdict.diagnoses, 1)
        if each.violation is not None
    ]
    if not found:
        return
    report = part_iri(verdict.iri, "report", 1)
    yield verdict.iri, LAW + "scopeReport", ox.NamedNode(report)
    yield report, RDF + "type", ox.NamedNode(SH + "ValidationReport")
    yield report, SH + "conforms", ox.Literal(False)
    for index, violation in found:
        result = part_iri(verdict.iri, "result", index)
        yield report, SH + "result", ox.NamedNode(result)
        yield part_iri(verdict.iri, "diagnosis", index), PROV + "wasDerivedFrom", ox.NamedNode(result)
        for name, value in result_terms(violation):
            yield result, name, value


def result_terms(violation: Violation) -> Iterator[tuple[Iri, Term]]:
    """Property and value of a sh:ValidationResult, with what the shape asked for."""
    yield RDF + "type", ox.NamedNode(SH + "ValidationResult")
    yield SH + "focusNode", ox.NamedNode(violation.focus)
    yield SH + "resultMessage", ox.Literal(violation.message)
    yield SH + "resultSeverity", ox.NamedNode(SH + "Violation")
    yield SH + "sourceShape", ox.NamedNode(violation.shape)
    if violation.component is not None:
        yield SH + "sourceConstraintComponent", ox.NamedNode(violation.component)
    if violation.path is not None:
        yield SH + "resultPath", ox.NamedNode(violation.path)
    if violation.value is not None:
        yield SH + "value", term_of(violation.value)
    if violation.bound is not None:
        yield LAW + "demanded", term_of(violation.bound)
