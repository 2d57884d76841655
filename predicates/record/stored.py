"""Verdicts as a store holds them: triples → values."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import pyoxigraph as ox

from predicates.case import Diagnosis, Evidence, Kind, Outcome, Quantity, Search
from sdt_kg.iri import LAW, PROV, RDF, SH, Iri, local_name
from sdt_kg.scope import Violation
from sdt_kg.store import Value, value_of
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
_OUTCOME = {name: outcome for outcome, name in OUTCOME_TERM.items()}


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


def read_verdicts(store: ox.Store) -> Iterator[StoredVerdict]:
    """Every verdict of a store, by IRI."""
    kind, verdict = ox.NamedNode(RDF + "type"), ox.NamedNode(LAW + "Verdict")
    found = {
        quad.subject.value: quad.graph_name
        for quad in store.quads_for_pattern(None, kind, verdict, None)
        if isinstance(quad.subject, ox.NamedNode)
    }
    for iri, graph in sorted(found.items()):
        yield read_verdict(store.quads_for_pattern(None, None, None, graph), iri)


def read_verdict(quads: Iterable[ox.Quad], iri: Iri) -> StoredVerdict:
    """The verdict of this IRI, whose graph these quads are."""
    return _verdict(_Facts(quads), iri)


class _Facts:
    """Values of the properties of one verdict's graph."""

    def __init__(self, quads: Iterable[ox.Quad]) -> None:
        self._values: dict[tuple[str, str], list[Value]] = {}
        for quad in quads:
            assert isinstance(quad.subject, ox.NamedNode), "no blank nodes in data"
            key = (quad.subject.value, quad.predicate.value)
            self._values.setdefault(key, []).append(value_of(quad.object))

    def all(self, subject: Iri, name: Iri) -> list[str]:
        """IRIs or texts, numbered parts in the order of their numbers."""
        return sorted((str(each) for each in self._values.get((subject, name), [])), key=_numbered)

    def text(self, subject: Iri, name: Iri) -> str | None:
        return next(iter(self.all(subject, name)), None)

    def value(self, subject: Iri, name: Iri) -> Value:
        return next(iter(self._values.get((subject, name), [])), None)

    def truth(self, subject: Iri, name: Iri) -> bool | None:
        value = self.value(subject, name)
        return value if isinstance(value, bool) else None

    def number(self, subject: Iri, name: Iri) -> float | None:
        value = self.value(subject, name)
        return float(value) if isinstance(value, int | float) else None

    def needed(self, subject: Iri, name: Iri) -> str:
        text = self.text(subject, name)
        assert text is not None, f"a verdict without {name}"
        return text


def _numbered(iri: str) -> tuple[int, str]:
    number = iri.rsplit("/", 1)[-1]
    return (int(number) if number.isdecimal() else 0), iri


def _verdict(facts: _Facts, iri: Iri) -> StoredVerdict:
    task = facts.text(iri, LAW + "task")
    verb = facts.text(task, LAW + "verb") if task else None
    used = facts.all(facts.needed(iri, PROV + "wasGeneratedBy"), PROV + "used")
    return StoredVerdict(
        iri=iri,
        outcome=_OUTCOME[local_name(facts.needed(iri, LAW + "outcome"))],
        environment=facts.needed(iri, LAW + "environment"),
        robot=facts.text(iri, LAW + "robot"),
        verb=Verb(local_name(verb).lower()) if verb else None,
        container=facts.text(iri, LAW + "container"),
        satisfies_request=facts.truth(iri, LAW + "satisfiesRequest"),
        causes=facts.truth(iri, LAW + "causes"),
        can_perform=facts.truth(iri, LAW + "canPerform"),
        diagnoses=tuple(_diagnosis(facts, each) for each in facts.all(iri, LAW + "diagnosis")),
        notes=tuple(facts.all(iri, LAW + "note")),
        figures=dict(_figure(facts, each) for each in facts.all(iri, LAW + "figure")),
        inputs=tuple((facts.needed(of, LAW + "name"), facts.needed(of, LAW + "inputHash")) for of in used),
        seconds=facts.number(iri, LAW + "seconds") or 0.0,
    )


def _figure(facts: _Facts, of: Iri) -> tuple[str, tuple[float, str]]:
    value = facts.number(of, LAW + "value")
    assert value is not None, "a figure without value"
    return facts.needed(of, LAW + "name"), (value, facts.needed(of, LAW + "unit"))


def _diagnosis(facts: _Facts, of: Iri) -> Diagnosis:
    return Diagnosis(
        kind=_KIND[local_name(facts.needed(of, RDF + "type"))],
        reason=facts.needed(of, LAW + "reason"),
        evidence=_evidence(facts, of) if facts.text(of, LAW + "quantity") else None,
        proof=facts.truth(of, LAW + "proof") is True,
        search=_search(facts, of),
        violation=_violation(facts, of),
    )


def _violation(facts: _Facts, of: Iri) -> Violation | None:
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


def _evidence(facts: _Facts, of: Iri) -> Evidence:
    links = facts.all(of, LAW + "link")
    value, bound = facts.number(of, LAW + "value"), facts.number(of, LAW + "bound")
    assert value is not None
    assert bound is not None
    return Evidence(
        quantity=Quantity(facts.needed(of, LAW + "quantity")),
        value=value,
        bound=bound,
        unit=facts.needed(of, LAW + "unit"),
        entity=facts.text(of, LAW + "entity"),
        links=(links[0], links[1]) if links else None,
        time=facts.number(of, LAW + "time"),
        scope=facts.text(of, LAW + "collisionScope") or "",
        path=facts.text(of, LAW + "path"),
    )


def _search(facts: _Facts, of: Iri) -> Search | None:
    seeds = facts.number(of, LAW + "searchedSeeds")
    if seeds is None:
        return None
    counts = [int(facts.number(of, LAW + f"searched{name}") or 0) for name in ("Branches", "Placements")]
    return Search(int(seeds), *counts, seconds=facts.number(of, LAW + "searchedSeconds") or 0.0)
