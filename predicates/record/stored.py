"""Verdicts as a store holds them: triples → values."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Never

import pyoxigraph as ox

from predicates.case import (
    OUTCOME_OF,
    Artefact,
    Code,
    Diagnosis,
    Evidence,
    Kind,
    Outcome,
    Quantity,
    Search,
)
from predicates.margins import NearestPair
from predicates.record.artefacts import read_artefact
from predicates.record.facts import Facts, damaged, term
from predicates.record.inputs import Inputs
from predicates.record.seal import check_unbroken, read_triples
from predicates.scope import claimed
from sdt_kg.errors import NoTruthError
from sdt_kg.iri import LAW, PROV, RDF, SH, Iri, graph_iri, local_name, verdict_iri
from sdt_kg.shacl import Violation
from sdt_kg.task import Verb

DIAGNOSIS_CLASS = {
    Kind.SEMANTIC: "SemanticFailure",
    Kind.CAUSAL: "CausalFailure",
    Kind.EMBODIMENT: "EmbodimentFailure",
    Kind.OUT_OF_SCOPE: "OutOfScope",
}
OUTCOME_TERM = {
    Outcome.CERTIFIED: "Certified",
    Outcome.NOT_CERTIFIED: "NotCertified",
    Outcome.ABSTAINED: "Abstained",
}
_KIND = {name: kind for kind, name in DIAGNOSIS_CLASS.items()}
VERBS = {verb.value.capitalize(): verb for verb in Verb}
_CODE = {code.value: code for code in Code}
_QUANTITY = {quantity.value: quantity for quantity in Quantity}
OUTCOMES = {name: outcome for outcome, name in OUTCOME_TERM.items()}
ONCE = (
    *("outcome", "satisfiesRequest", "causes", "canPerform", "environment", "teeClass", "robot"),
    *("drive", "handleForce", "gripper", "task", "container", "motion", "bodyMotion"),
)
"""What a record says of its verdict no more than once."""


@dataclass(frozen=True, slots=True)
class StoredVerdict:
    """What a store says of one verdict.

    Attributes:
        satisfies_request: The predicate's answer; None where it was not run.
        causes: None where it was not run.
        can_perform: None where it was not run.
        diagnoses: A collision's two links come in alphabetical order.
        notes: In alphabetical order.
        figures: Certified margins: name → (value, unit).
        nearest_pairs: Name of a figure → between which bodies that distance is; none where it is not said.
        artefact: What re-verifies it, if it has one.
        drive: How the base moves; None where that is not said, as gripper and class.
        gripper: Which one acts.
        tee_class: IRI of the class D that it is relative to.
        moved: Joint → position [rad or m] of what is not where the kitchen starts.
        answers: Predicate → whether it holds, as each answer by itself says.
    """

    iri: Iri
    outcome: Outcome
    environment: Iri
    robot: Iri | None
    verb: Verb | None
    container: Iri | None
    satisfies_request: bool | None
    causes: bool | None
    can_perform: bool | None
    diagnoses: tuple[Diagnosis, ...]
    notes: tuple[str, ...]
    figures: dict[str, tuple[float, str]]
    inputs: tuple[tuple[str, str], ...]
    seconds: float
    artefact: Artefact | None = None
    drive: str | None = None
    gripper: str | None = None
    tee_class: Iri | None = None
    moved: Mapping[Iri, float] = field(default_factory=dict[Iri, float])
    answers: Mapping[str, bool | None] = field(default_factory=dict[str, bool | None])
    nearest_pairs: dict[str, NearestPair] = field(default_factory=dict[str, NearestPair])

    def __bool__(self) -> Never:
        """As a verdict has none."""
        raise NoTruthError("a stored verdict", OUTCOME_OF)


def read_verdicts(store: ox.Store) -> Iterator[StoredVerdict]:
    """Every verdict of a store, by IRI; raises as `read_verdict`."""
    for iri, quads in verdict_records(store):
        yield read_verdict(quads, iri)


def verdict_records(store: ox.Store) -> Iterator[tuple[Iri, Iterable[ox.Quad]]]:
    """IRI and record of every verdict of a store, by IRI, as they stand there."""
    for iri in verdicts_of(store):
        graph = ox.NamedNode(graph_iri("verdict", local_name(iri)))
        yield iri, store.quads_for_pattern(None, None, None, graph)


def verdicts_of(store: ox.Store) -> list[Iri]:
    """IRIs of all verdicts of a store, in order."""
    return records_of(store, "Verdict", "verdict", verdict_iri)


def records_of(store: ox.Store, kind: str, graphs: str, iri_of: Callable[[str], Iri]) -> list[Iri]:
    """IRIs of all that is of a class of law:, or that a graph is meant to be about, in order."""
    found = store.quads_for_pattern(None, ox.NamedNode(RDF + "type"), ox.NamedNode(LAW + kind), None)
    named = {quad.subject.value for quad in found if isinstance(quad.subject, ox.NamedNode)}
    there = {each.value for each in store.named_graphs() if isinstance(each, ox.NamedNode)}
    stem = graph_iri(graphs, "")
    return sorted(named | {iri_of(local_name(each)) for each in there if each.startswith(stem)})


def read_verdict(quads: Iterable[ox.Quad], iri: Iri) -> StoredVerdict:
    """The verdict of this IRI, whose graph these quads are.

    Raises:
        InputError: The record is damaged, or was changed after it was written.
    """
    store, written = ox.Store(), list(quads)
    store.extend(written)
    stored = replace(_verdict(Facts(store), iri), artefact=read_artefact(store, iri))
    check_unbroken(iri, read_triples(written))
    return stored


def read_inputs(facts: Facts, judged: Iri) -> Inputs:
    """All that decided a verdict, or a task's result: name → value or hash."""
    used = facts.all(facts.needed(judged, PROV + "wasGeneratedBy"), PROV + "used")
    return tuple((facts.needed(of, LAW + "name"), facts.needed(of, LAW + "inputHash")) for of in used)


def read_positions(facts: Facts, judged: Iri) -> dict[Iri, float]:
    """Joint → position [rad or m] of what is not where the kitchen starts."""
    return {
        facts.needed(of, LAW + "entity"): facts.measured(of, LAW + "value")
        for of in facts.all(judged, LAW + "jointPosition")
    }


def _verdict(facts: Facts, iri: Iri) -> StoredVerdict:
    facts.check_kind(iri, "Verdict")
    facts.check_once(iri, (LAW + name for name in ONCE))
    task = facts.text(iri, LAW + "task")
    verb = facts.text(task, LAW + "verb") if task else None
    return StoredVerdict(
        iri=iri,
        outcome=term(OUTCOMES, facts.needed(iri, LAW + "outcome")),
        environment=facts.needed(iri, LAW + "environment"),
        robot=facts.text(iri, LAW + "robot"),
        verb=term(VERBS, verb) if verb else None,
        container=facts.text(iri, LAW + "container"),
        satisfies_request=facts.truth(iri, LAW + "satisfiesRequest"),
        causes=facts.truth(iri, LAW + "causes"),
        can_perform=facts.truth(iri, LAW + "canPerform"),
        diagnoses=claimed(read_diagnosis(facts, each) for each in facts.all(iri, LAW + "diagnosis")),
        notes=tuple(facts.all(iri, LAW + "note")),
        figures=dict(_figure(facts, each) for each in facts.all(iri, LAW + "figure")),
        inputs=read_inputs(facts, iri),
        seconds=facts.number(iri, LAW + "seconds") or 0.0,
        drive=facts.text(iri, LAW + "drive"),
        gripper=facts.text(iri, LAW + "gripper"),
        tee_class=facts.text(iri, LAW + "teeClass"),
        moved=read_positions(facts, iri),
        answers={
            local_name(facts.needed(of, LAW + "predicate")): facts.truth(of, LAW + "holds")
            for of in facts.all(iri, LAW + "answer")
        },
        nearest_pairs=dict(_nearest_pairs(facts, iri)),
    )


def _figure(facts: Facts, of: Iri) -> tuple[str, tuple[float, str]]:
    value = facts.measured(of, LAW + "value")
    return facts.needed(of, LAW + "name"), (value, facts.needed(of, LAW + "unit"))


def _nearest_pairs(facts: Facts, iri: Iri) -> Iterator[tuple[str, NearestPair]]:
    for of in facts.all(iri, LAW + "figure"):
        if (links := _links(facts, of)) is not None:
            yield facts.needed(of, LAW + "name"), NearestPair(links, facts.measured(of, LAW + "time"))


def _links(facts: Facts, of: Iri) -> tuple[Iri, Iri] | None:
    """The two bodies of a distance, in alphabetical order; None where no body is said."""
    links = facts.all(of, LAW + "link")
    if len(links) not in {0, 2}:
        raise damaged(of, f"it has {len(links)} values of {LAW}link")
    return (links[0], links[1]) if links else None


def read_diagnosis(facts: Facts, of: Iri) -> Diagnosis:
    """The reason that stands for itself as the individual `of`."""
    return Diagnosis(
        kind=term(_KIND, facts.needed(of, RDF + "type")),
        reason=facts.needed(of, LAW + "reason"),
        evidence=_evidence(facts, of) if facts.text(of, LAW + "quantity") else None,
        proof=facts.truth(of, LAW + "proof") is True,
        search=_search(facts, of),
        violation=_violation(facts, of),
        code=term(_CODE, code) if (code := facts.text(of, LAW + "code")) else None,
    )


def _violation(facts: Facts, of: Iri) -> Violation | None:
    """The SHACL result from which the diagnosis is derived."""
    result = facts.text(of, PROV + "wasDerivedFrom")
    if result is None:
        return None
    return Violation(
        focus=facts.needed(result, SH + "focusNode"),
        path=facts.text(result, SH + "resultPath"),
        value=facts.value(result, SH + "value"),
        bound=facts.value(result, LAW + "demanded"),
        message=facts.needed(result, SH + "resultMessage"),
        shape=facts.needed(result, SH + "sourceShape"),
        component=facts.text(result, SH + "sourceConstraintComponent"),
    )


def _evidence(facts: Facts, of: Iri) -> Evidence:
    return Evidence(
        quantity=term(_QUANTITY, facts.needed(of, LAW + "quantity")),
        value=facts.measured(of, LAW + "value"),
        bound=facts.measured(of, LAW + "bound"),
        unit=facts.needed(of, LAW + "unit"),
        entity=facts.text(of, LAW + "entity"),
        links=_links(facts, of),
        time=facts.number(of, LAW + "time"),
        scope=facts.text(of, LAW + "collisionScope") or "",
        path=facts.text(of, LAW + "path"),
    )


def _search(facts: Facts, of: Iri) -> Search | None:
    seeds = facts.number(of, LAW + "searchedSeeds")
    if seeds is None:
        return None
    counts = [int(facts.number(of, LAW + f"searched{name}") or 0) for name in ("Branches", "Placements")]
    return Search(int(seeds), *counts, seconds=facts.number(of, LAW + "searchedSeconds") or 0.0)
