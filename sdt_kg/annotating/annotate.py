"""Rules → annotations: what is inferred about a kitchen or robot, and by which rule.

Each rule of `ontology/rules` is one CONSTRUCT; they run in the order of their numbers, each over
what is asserted and what the rules before it found. What a rule finds goes to a named graph of
that rule, which says so: `<graph> sdt:inferredBy <rule>`.
"""

from collections.abc import Iterator
from functools import cache
from itertools import chain
from typing import Final

import pyoxigraph as ox

import ontology
from sdt_kg.annotating.panels import panel_triples
from sdt_kg.iri import ID, RDF, SDT, TEE, Iri, graph_iri, local_name
from sdt_kg.store import MemoryStore, Store, Triple
from sdt_kg.triples import Facts

TEE_GRAPH: Final = TEE.removesuffix("#")
"""Named graph of the constants of D_artic."""

STRUCTURE_RULE: Final = "r07_door_by_structure"


@cache
def rules() -> tuple[tuple[str, str], ...]:
    """Name and text of each rule, in order."""
    files = sorted(ontology.path("rules").glob("r*.rq"))
    assert files, "the package has its rules"
    return tuple((file.stem, file.read_text(encoding="utf-8")) for file in files)


def rule_iri(rule: str) -> Iri:
    """Individual of a rule."""
    return f"{ID}rule/{rule}"


@cache
def tee_triples() -> tuple[Triple, ...]:
    """What `tee.ttl` says."""
    quads = ox.parse(ontology.path("tee.ttl").read_bytes(), format=ox.RdfFormat.TURTLE)
    return tuple(
        (quad.subject.value, quad.predicate.value, quad.object)
        for quad in quads
        if isinstance(quad.subject, ox.NamedNode) and isinstance(quad.object, ox.NamedNode | ox.Literal)
    )


@cache
def tee_facts() -> Facts:
    """The same, as a store says it."""
    store = MemoryStore()
    store.add(TEE_GRAPH, tee_triples())
    return Facts(store.triples(TEE_GRAPH))


def annotate(store: Store, model: Iri, asserted: Iri) -> list[Iri]:
    """Run all rules over the model's asserted graph.

    Returns:
        The named graphs of what was inferred, in order.
    """
    graphs = [asserted, TEE_GRAPH]
    for name, text in rules():
        if name == STRUCTURE_RULE:
            graphs += _infer(store, model, "measure_panels", panel_triples(store, graphs))
        solutions = store.query(text, graphs)
        assert isinstance(solutions, ox.QueryTriples), f"{name} is a CONSTRUCT"
        graphs += _infer(store, model, name, map(_triple, solutions))
    return graphs[2:]


def _triple(triple: ox.Triple) -> Triple:
    subject, value = triple.subject, triple.object
    assert isinstance(subject, ox.NamedNode), "rules make no blank nodes"
    assert isinstance(value, ox.NamedNode | ox.Literal), "rules make no blank nodes"
    return subject.value, triple.predicate.value, value


def _infer(store: Store, model: Iri, rule: str, found: Iterator[Triple]) -> list[Iri]:
    """The named graph of what the rule found, as a list; an empty one where it found nothing."""
    first = next(found, None)
    if first is None:
        return []
    graph = graph_iri("inferred", f"{local_name(model)}/{rule}")
    maker = rule_iri(rule)
    about: list[Triple] = [
        (graph, SDT + "inferredBy", ox.NamedNode(maker)),
        (maker, RDF + "type", ox.NamedNode(SDT + "Rule")),
    ]
    store.add(graph, chain(about, (first,), found))
    return [graph]
