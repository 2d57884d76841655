"""Quads in this process: pyoxigraph, in memory or over a directory."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from itertools import islice

import pyoxigraph as ox

from sdt_kg.errors import QueryError
from sdt_kg.iri import PREFIXES, Iri
from sdt_kg.store import Solutions, Term
from services.store.known import restricted
from services.store.quads import checked, content

BATCH = 50_000
"""[quads] Written in one transaction: all of them or none."""


class EmbeddedStore:
    """pyoxigraph's store; where it lies, and what `close` does, was decided by who opened it.

    Args:
        store: Empty or not.
        finish: Called once, on closing; by default what is in memory is gone then.
    """

    def __init__(self, store: ox.Store, finish: Callable[[ox.Store], None] = lambda store: None) -> None:
        self._store = store
        self._finish = finish
        self._is_open = True

    def add(self, quads: Iterable[ox.Quad]) -> None:
        """Put quads into their named graphs, in batches of which each is written whole or not at all."""
        source = iter(quads)
        while batch := checked(islice(source, BATCH)):
            self._store.extend(batch)

    def replace(self, graph: Iri, quads: Iterable[ox.Quad]) -> None:
        """Give a named graph this content instead of what it had, in one transaction."""
        name = ox.NamedNode(graph)
        self._store.update(f"DROP SILENT GRAPH {name} ; INSERT DATA {{ {content(checked(quads))} }}")

    def drop(self, graph: Iri) -> None:
        """Remove a named graph, if it is there."""
        self._store.remove_graph(ox.NamedNode(graph))

    def alone(self, graph: Iri) -> AbstractContextManager[None]:
        """Nobody else writes the graph meanwhile: one process has the store."""
        return nullcontext()

    def __contains__(self, graph: Iri) -> bool:
        """Whether a named graph is there."""
        return self._store.contains_named_graph(ox.NamedNode(graph))

    def graph(self, graph: Iri) -> list[ox.Quad]:
        """All quads of a named graph; none where it is not there."""
        return list(self._store.quads_for_pattern(None, None, None, ox.NamedNode(graph)))

    def query(
        self, sparql: str, graphs: Sequence[Iri] | None = None, known: Mapping[str, Term] | None = None
    ) -> Solutions:
        """Evaluate a query whose default graph is the union of these graphs, or of all."""
        names = None if graphs is None else [ox.NamedNode(graph) for graph in graphs]
        try:
            return self._store.query(
                restricted(sparql, known or {}),
                default_graph=None if names is None else list(names),
                named_graphs=None if names is None else list(names),
                use_default_graph_as_union=names is None,
                prefixes=PREFIXES,
            )
        except SyntaxError as error:
            raise QueryError(f"the query is not SPARQL: {error}", allowed="SELECT, ASK, CONSTRUCT") from None

    def dump(self, graphs: Sequence[Iri] | None = None) -> ox.Store:
        """A copy of these named graphs, or of all."""
        copy = ox.Store()
        copy.bulk_extend(self._quads(graphs))
        return copy

    def close(self) -> None:
        """Finish writing, and let another process have the place."""
        if self._is_open:
            self._is_open = False
            store, self._store = self._store, ox.Store()
            self._finish(store)

    def _quads(self, graphs: Sequence[Iri] | None) -> Iterator[ox.Quad]:
        if graphs is None:
            yield from self._store
            return
        for graph in graphs:
            yield from self._store.quads_for_pattern(None, None, None, ox.NamedNode(graph))
