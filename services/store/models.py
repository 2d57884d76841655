"""Models in a store: one of each name that queries see, and what others of that name were."""

import base64
import zlib
from collections.abc import Iterable, Sequence
from itertools import chain
from typing import Final

import pyoxigraph as ox

from sdt_kg.errors import InputError
from sdt_kg.iri import LAW, XSD, Iri, graph_iri, local_name
from sdt_kg.store import rows_of
from sdt_kg.triples import Facts
from services.store.quads import QuadStore

REPLACED: Final = ox.NamedNode(LAW + "replacedModel")
INFERRED: Final = "SELECT ?graph { ?graph sdt:inferredBy ?rule }"
MOST_BYTES: Final = 1 << 30
"""Of a model's graphs as N-Quads: 300 times those of kitchen a."""


def keep_model(store: QuadStore, model: Iri, graphs: Sequence[Iri], fresh: ox.Store) -> None:
    """The store has these graphs of a model, and no others of it.

    One of that name and of another content is set aside, packed: verdicts may be about it, and queries
    see but one.

    Args:
        store: Where it is kept.
        model: Kitchen or robot.
        graphs: What is asserted of it, then what is inferred.
        fresh: Has them.
    """
    asserted, *_ = graphs
    with store.alone(asserted):
        inferred = (str(row["graph"]) for row in rows_of(store.query(INFERRED))[1])
        known = {*graphs, *(graph for graph in inferred if is_graph_of(model, graph))}
        there = {graph: set(store.graph(graph)) for graph in known}
        differing = [graph for graph, quads in there.items() if quads != set(quads_of(fresh, graph))]
        if differing and there[asserted]:
            store.add([_packed(model, chain.from_iterable(there.values()))])
        for graph in differing:
            store.replace(graph, quads_of(fresh, graph))
        if differing:  # it may have been there before: what queries see need not be kept twice
            here = chain.from_iterable(quads_of(fresh, graph) for graph in graphs)
            store.drop(_aside(model, _content_hash(here)).value)


def is_graph_of(model: Iri, graph: Iri) -> bool:
    """Whether a graph says what is asserted or inferred of a model; those of a history's branches do not."""
    prefix = graph_iri("inferred", f"{local_name(model)}/")
    inferred = graph.startswith(prefix) and "/" not in graph.removeprefix(prefix)
    return inferred or graph == graph_iri("asserted", local_name(model))


def replaced_model(store: ox.Store, model: Iri, content_hash: str) -> list[ox.Quad] | None:
    """The graphs of a model of this content that another of its name took the place of; None if none was.

    Raises:
        InputError: What was kept of it is damaged.
    """
    graph = _aside(model, content_hash)
    found = next(iter(store.quads_for_pattern(graph, REPLACED, None, graph)), None)
    if found is None:
        return None
    try:
        return _unpacked(found.object.value if isinstance(found.object, ox.Literal) else "")
    except (ValueError, zlib.error, SyntaxError) as error:
        raise InputError(
            f"what was kept of another {local_name(model)} is damaged: {error}",
            remedy="name the models with --kitchen and --robot",
        ) from None


def _unpacked(content: str) -> list[ox.Quad]:
    unzip = zlib.decompressobj()
    text = unzip.decompress(base64.b64decode(content, validate=True), MOST_BYTES)
    if not unzip.eof:
        raise ValueError("it ends too early, or is larger than any model")
    return list(ox.parse(text, format=ox.RdfFormat.N_QUADS))


def quads_of(store: ox.Store, graph: Iri) -> list[ox.Quad]:
    """All that a store says in a named graph."""
    return list(store.quads_for_pattern(None, None, None, ox.NamedNode(graph)))


def _packed(model: Iri, quads: Iterable[ox.Quad]) -> ox.Quad:
    """The graphs of a model in one literal, in a graph that is named after their content."""
    told = list(quads)
    graph = _aside(model, _content_hash(told))
    text = "".join(sorted(f"{each} .\n" for each in told))
    content = base64.b64encode(zlib.compress(text.encode())).decode("ascii")
    return ox.Quad(graph, REPLACED, ox.Literal(content, datatype=ox.NamedNode(XSD + "base64Binary")), graph)


def _content_hash(quads: Iterable[ox.Quad]) -> str:
    """As of a twin's model: of quads that a twin wrote, without blank nodes."""
    return Facts(
        (each.subject.value, each.predicate.value, each.object)
        for each in quads
        if isinstance(each.subject, ox.NamedNode) and isinstance(each.object, ox.NamedNode | ox.Literal)
    ).content_hash()


def _aside(model: Iri, content_hash: str) -> ox.NamedNode:
    return ox.NamedNode(graph_iri("set_aside", f"{local_name(model)}/{content_hash}"))
