"""What a store of quads does, and quads as text that any SPARQL server takes."""

from collections.abc import Iterable, Mapping, Sequence
from contextlib import AbstractContextManager
from itertools import groupby
from typing import Protocol

import pyoxigraph as ox

from sdt_kg.errors import InputError
from sdt_kg.iri import Iri
from sdt_kg.store import Solutions, Term


class QuadStore(Protocol):
    """Twins and verdicts, kept: in a file, in a directory or on a server. No blank nodes.

    A directory or a server keeps what a method has written as soon as it returns, whatever happens to
    this process then; a file keeps it from `close` on.
    """

    def add(self, quads: Iterable[ox.Quad]) -> None:
        """Put quads into their named graphs; one that is there already changes nothing.

        Raises:
            InputError: A blank node, or a quad of no named graph.
            StoreError: Not all of it was written; doing it again is harmless.
        """
        ...

    def replace(self, graph: Iri, quads: Iterable[ox.Quad]) -> None:
        """Give a named graph this content instead of what it had, in one step."""
        ...

    def drop(self, graph: Iri) -> None:
        """Remove a named graph, if it is there."""
        ...

    def alone(self, graph: Iri) -> AbstractContextManager[None]:
        """Nobody else writes the graph meanwhile: what was read is still so when it is replaced."""
        ...

    def __contains__(self, graph: Iri) -> bool:
        """Whether a named graph is there."""
        ...

    def graph(self, graph: Iri) -> list[ox.Quad]:
        """All quads of a named graph; none where it is not there."""
        ...

    def query(
        self, sparql: str, graphs: Sequence[Iri] | None = None, known: Mapping[str, Term] | None = None
    ) -> Solutions:
        """Evaluate a query whose default graph is the union of these graphs.

        Args:
            sparql: A query which `checked_query` has let through.
            graphs: None for all of them.
            known: Values for variables of the query's pattern (`services.store.known`).

        Raises:
            QueryError: It does not parse, or its pattern has no variable of that name.
            StoreError: There is no whole answer.
        """
        ...

    def dump(self, graphs: Sequence[Iri] | None = None) -> ox.Store:
        """A copy of these named graphs, or of all."""
        ...

    def close(self) -> None:
        """Finish writing, and let go of the place."""
        ...


def checked(quads: Iterable[ox.Quad]) -> list[ox.Quad]:
    """The quads, each of a named graph and without blank nodes, so that writing them again is harmless.

    Raises:
        InputError: One is not.
    """
    found = list(quads)
    for quad in found:
        named = isinstance(quad.subject, ox.NamedNode) and isinstance(quad.graph_name, ox.NamedNode)
        if not named or not isinstance(quad.object, ox.NamedNode | ox.Literal):
            raise InputError(f"a store cannot keep {quad}", allowed="quads of named graphs, no blank nodes")
    return found


def content(quads: Iterable[ox.Quad]) -> str:
    """What stands between the braces of INSERT DATA; neighbours of one graph share its name."""
    parts: list[str] = []
    for graph, group in groupby(quads, key=lambda quad: quad.graph_name):
        lines = ox.serialize((quad.triple for quad in group), format=ox.RdfFormat.N_TRIPLES)
        assert lines is not None, "no output was given"
        parts.append(f"GRAPH {graph} {{\n{lines.decode()}}}")
    return "\n".join(parts)
