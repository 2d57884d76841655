"""What a store of quads does, and quads and known values as text that any SPARQL server takes."""

from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from itertools import groupby
from typing import Final, Protocol

import pyoxigraph as ox

from sdt_kg.errors import InputError, QueryError
from sdt_kg.iri import PREFIXES, Iri
from sdt_kg.store import Solutions, Term

KEPT_TEXTS: Final = 256
"""Queries whose variables are remembered."""


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
            known: Values for variables that the query selects.

        Raises:
            QueryError: It does not parse, or binds a variable that it does not select.
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
        lines = "\n".join(f"{quad.subject} {quad.predicate} {quad.object} ." for quad in group)
        parts.append(f"GRAPH {graph} {{\n{lines}\n}}")
    return "\n".join(parts)


def restricted(sparql: str, known: Mapping[str, Term]) -> str:
    """The query, with a VALUES clause at its end that fixes these variables.

    Unlike a substitution it is seen by the planner, which starts from what is known: the answer then
    takes as long as it has rows, however much the store holds. Terms are written as N-Triples has them.

    A variable that is computed, or a query that ends with VALUES itself, makes it no SPARQL any more.

    Raises:
        QueryError: It does not parse, or does not select one of the variables.
    """
    if not known:
        return sparql
    selected = _selected(sparql)
    for name in known:
        if name not in selected:
            allowed = ", ".join(sorted(selected)) or "a SELECT"
            raise QueryError(f"the query does not select ?{name}", allowed=allowed)
    names, terms = " ".join(f"?{name}" for name in known), " ".join(str(term) for term in known.values())
    return f"{sparql}\nVALUES ({names}) {{ ({terms}) }}"


@lru_cache(maxsize=KEPT_TEXTS)
def _selected(sparql: str) -> frozenset[str]:
    """Variables which the query selects, computed ones too."""
    try:
        solutions = ox.Store().query(sparql, prefixes=PREFIXES)
    except SyntaxError as error:
        raise QueryError(f"the query is not SPARQL: {error}", allowed="SELECT") from None
    if not isinstance(solutions, ox.QuerySolutions):
        return frozenset()
    return frozenset(variable.value for variable in solutions.variables)
