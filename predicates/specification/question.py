"""Whether a rule's query is a question about what it is asked over: one that is none keeps all, or none."""

from collections.abc import Iterator
from difflib import get_close_matches
from functools import cache
from typing import Any, Final, cast

import pyoxigraph as ox
import rdflib
from rdflib.paths import Path

from predicates.specification.comparing import algebra_of, tokens
from predicates.specification.model import Scope
from sdt_kg.history.events import Event, EventType
from sdt_kg.history.records import event_triples, first_triples
from sdt_kg.iri import ID, PREFIXES, RDF, RDFS, SDT, TEE, XSD, Iri
from sdt_kg.shapes import declared
from sdt_kg.twin import Twin

CORE: Final = (RDF, RDFS, XSD)
"""Whose terms need not be in a graph: types of literals, and paths that may have no step."""

OF_STATES: Final = frozenset({SDT + "position"})
"""Terms that only states have."""

CHANGING: Final = frozenset({"now", "rand", "uuid", "struuid"})
"""Functions with which the same question has another answer."""

LIKENESS = 0.8
"""[1] Share of letters in common from which a term may have been meant."""


def faults(sparql: str, twin: Twin, over: Scope) -> Iterator[tuple[str, str]]:
    """Why the query tells nothing of what it is asked over, and what is allowed: it would keep every rule."""
    algebra, words = algebra_of(sparql), {text.lower() for kind, text in tokens(sparql) if kind == "word"}
    if "from" in words or (algebra is not None and algebra.datasetClause):
        yield "has FROM, though it is asked of the kitchen's own graph", "a query without it"
    if over is Scope.EVENTS and "graph" in words:
        yield "has GRAPH, though events are in no named graph", f"GRAPH over law:{Scope.STATES.value}"
    if changing := sorted(words & CHANGING):
        yield f"has {changing[0].upper()}, whose answer is another each time", "what follows from the kitchen"
    if algebra is not None and _always_has_a_row(algebra):
        yield "counts or adds up, and has a row whatever it finds", "ASK, or SELECT with HAVING"
    if (beside := _ordered_text(sparql)) is not None:
        yield f"compares {beside}, which is text, by order, and no number is in order with it", "a number"
    yield from _strangers(sparql, algebra, twin, over)


def _strangers(sparql: str, algebra: Any, twin: Twin, over: Scope) -> Iterator[tuple[str, str]]:  # noqa: ANN401 - a tree of rdflib's own kinds
    """Terms and individuals that nothing has which is asked."""
    for iri in _iris(sparql, algebra):
        if iri.startswith(CORE):
            continue
        told = (
            iri not in OF_STATES if over is Scope.EVENTS else iri not in _of_events() or _in_graph(iri, twin)
        )
        if not told:
            elsewhere = Scope.EVENTS if over is Scope.STATES else Scope.STATES
            yield f"names <{iri}>, which nothing has over law:{over.value}", f"law:over law:{elsewhere.value}"
        known = declared() if iri.startswith((SDT, TEE)) else frozenset[Iri]()
        if iri not in known and not _in_graph(iri, twin):
            likest = get_close_matches(iri, sorted(declared()), n=2, cutoff=LIKENESS)
            who = "no kitchen has" if iri in declared() else "neither a vocabulary nor the kitchen has"
            what = f"names <{iri}>, which {who}"
            yield what, " or ".join(f"<{each}>" for each in likest)


def _always_has_a_row(algebra: Any) -> bool:  # noqa: ANN401 - a tree of rdflib's own kinds
    """Whether it is an aggregate over everything at once, which not even nothing leaves without a row."""
    part = algebra.p if algebra.name == "SelectQuery" else None
    while part is not None and part.name in {"Project", "Distinct", "Reduced", "OrderBy", "Slice", "Extend"}:
        part = part.p
    return part is not None and part.name == "AggregateJoin" and part.p.expr is None


def _ordered_text(sparql: str) -> str | None:
    """A plain string beside <, >, <= or >=."""
    found = [("", ""), *tokens(sparql), ("", "")]
    for before, (kind, text), after in zip(found, found[1:], found[2:], strict=False):
        is_plain = kind == "string" and after[1] not in {"^", "@"}
        if is_plain and {before[1], after[1]} & {"<", ">", "<=", ">="}:
            return text
    return None


def _iris(sparql: str, algebra: Any) -> list[Iri]:  # noqa: ANN401 - likewise
    """IRIs that the query asks for, each once; declarations of prefixes do not count."""
    named = _named(sparql) if algebra is None else _nodes(algebra)
    return sorted(set(named))


def _nodes(part: Any) -> Iterator[Iri]:  # noqa: ANN401 - likewise
    """The IRIs anywhere in a part of an algebra, on property paths too."""
    if isinstance(part, rdflib.URIRef):
        yield str(part)
    elif isinstance(part, Path):
        yield from _nodes(list(vars(part).values()))
    elif isinstance(part, dict):  # an algebra's node
        yield from _nodes(list(cast("dict[str, Any]", part).values()))
    elif isinstance(part, list | tuple | set):
        for each in cast("list[Any]", part):
            yield from _nodes(each)


def _named(sparql: str) -> Iterator[Iri]:
    """The same by a look at its words."""
    prefixes, found = dict(PREFIXES), tokens(sparql)
    edge = ("", "")
    for before, (kind, text), after in zip([edge, *found], found, [*found[1:], edge], strict=False):
        if kind == "iri" and before[0] == "name" and before[1].endswith(":"):
            prefixes[before[1][:-1]] = text[1:-1]
            continue
        if kind == "iri":
            yield text[1:-1]
        if kind == "name" and after[0] != "unknown":  # an escape goes on behind it
            prefix, _, name = text.partition(":")
            if name:
                yield prefixes.get(prefix, "") + name


@cache
def _of_events() -> frozenset[Iri]:
    """Terms by which only events are told."""
    some = [Event(each, ID, 0, 0.0, ID) for each in EventType]
    triples = (*event_triples(ID, some, ID, 0), *first_triples(ID, [ID]))
    return frozenset(
        {SDT + each.value for each in EventType} | {name for _, name, _ in triples} - {RDF + "type"}
    )


def _in_graph(iri: Iri, twin: Twin) -> bool:
    _, rows = twin.query(f"ASK {{ {{ <{iri}> ?p ?o }} UNION {{ ?s <{iri}> ?o }} UNION {{ ?s ?p <{iri}> }} }}")
    return bool(rows[0]["answer"])


def is_question(sparql: str) -> bool:
    """Whether the query is ASK or SELECT."""
    return isinstance(ox.Store().query(sparql, prefixes=PREFIXES), ox.QueryBoolean | ox.QuerySolutions)
