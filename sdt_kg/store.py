"""Store: named graphs and queries over them, and the in-memory form."""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import lru_cache, partial
from textwrap import shorten
from threading import Lock
from typing import Final, Protocol

import pyoxigraph as ox

from sdt_kg.errors import QueryError
from sdt_kg.iri import PREFIXES, XSD, Iri
from sdt_kg.lines import of_lines, to_lines
from sdt_kg.numbers import number_in, whole_in

Term = ox.NamedNode | ox.Literal
AnyTerm = ox.NamedNode | ox.BlankNode | ox.Literal | ox.Triple
Triple = tuple[Iri, Iri, Term]
Value = str | float | int | bool | None
Row = dict[str, object]
Solutions = ox.QuerySolutions | ox.QueryBoolean | ox.QueryTriples

_READERS: Final[dict[str, Callable[[str], Value]]] = {
    **dict.fromkeys((XSD + name for name in ("double", "float", "decimal")), number_in),
    **dict.fromkeys((XSD + name for name in ("integer", "int", "long", "nonNegativeInteger")), whole_in),
    XSD + "boolean": lambda text: {"true": True, "1": True, "false": False, "0": False}[text],
}
KEPT_NODES: Final = 65_536
"""Nodes kept for the next triple about the same: making one checks its IRI."""

MOST_NESTED: Final = 256
"""[1] Brackets within each other in a query: of 4,000 the parser dies, and the process with it."""

MOST_JOINED: Final = 1_000
"""[1] Patterns, filters and signs between parts of a query: of 4,000 it may die likewise."""

SHOWN_EXPECTATION: Final = 80
"""[characters] Of what the parser would have accepted; it lists whole character classes."""

_QUOTED: Final = re.compile(r"""<[^<>"{}|^`\\\s]*>|"(?:[^"\\\n]|\\.)*"|'(?:[^'\\\n]|\\.)*'""")
_JOINT: Final = re.compile(
    r"\|\||&&|[+*/|{]|\b(?:optional|union|filter|bind|minus)\b|[.;](?=\s|$)", re.IGNORECASE
)
_ESCAPE: Final = re.compile(r"\\u([0-9A-Fa-f]{4})|\\U([0-9A-Fa-f]{8})")


@lru_cache(maxsize=KEPT_NODES)
def _node(iri: Iri) -> ox.NamedNode:
    return ox.NamedNode(iri)


class Store(Protocol):
    """Named graphs. A twin's entity graphs are written once; only state graphs come and go."""

    def add(self, graph: Iri, triples: Iterable[Triple]) -> None:
        """Put triples into a named graph."""
        ...

    def drop(self, graph: Iri) -> None:
        """Remove a named graph."""
        ...

    def triples(self, graph: Iri) -> Iterable[Triple]:
        """All triples of a named graph."""
        ...

    def query(
        self,
        sparql: str,
        graphs: Sequence[Iri],
        known: Mapping[str, Term] | None = None,
        named: Sequence[Iri] = (),
    ) -> Solutions:
        """Evaluate a query whose default graph is the union of these graphs.

        Args:
            sparql: The query.
            graphs: In the default graph, and named.
            known: Values for variables that the query selects.
            named: Only named: `GRAPH` finds them, the default graph does not hold them.

        Raises:
            QueryError: It does not parse, or binds a variable that it does not select.
        """
        ...

    def dump(self, graphs: Sequence[Iri], into: "ox.Store | None" = None) -> "ox.Store":
        """A copy of these named graphs, by itself or added to a store."""
        ...


class MemoryStore:
    """The in-memory form, pyoxigraph's.

    Args:
        make: Gives what it holds and may change, when it is first asked for anything.
    """

    def __init__(self, make: Callable[[], ox.Store] = ox.Store) -> None:
        self._make, self._lock = make, Lock()
        self._made: ox.Store | None = None

    def __reduce__(self) -> tuple[type["MemoryStore"], tuple[Callable[[], ox.Store]]]:
        return MemoryStore, (partial(of_lines, to_lines(self._store)),)

    @property
    def _store(self) -> ox.Store:
        with self._lock:
            if self._made is None:
                self._made = self._make()
            return self._made

    def add(self, graph: Iri, triples: Iterable[Triple]) -> None:
        """Put triples into a named graph."""
        name = ox.NamedNode(graph)
        self._store.extend(_quads(name, triples))

    def drop(self, graph: Iri) -> None:
        """Remove a named graph."""
        self._store.remove_graph(ox.NamedNode(graph))

    def triples(self, graph: Iri) -> Iterable[Triple]:
        """All triples of a named graph."""
        for quad in self._store.quads_for_pattern(None, None, None, ox.NamedNode(graph)):
            subject, value = quad.subject, quad.object
            assert isinstance(subject, ox.NamedNode), "no blank nodes in data"
            assert isinstance(value, ox.NamedNode | ox.Literal), "no blank nodes in data"
            yield subject.value, quad.predicate.value, value

    def query(
        self,
        sparql: str,
        graphs: Sequence[Iri],
        known: Mapping[str, Term] | None = None,
        named: Sequence[Iri] = (),
    ) -> Solutions:
        """Evaluate a query whose default graph is the union of these graphs."""
        names = [ox.NamedNode(graph) for graph in graphs]
        bound: dict[ox.Variable, AnyTerm] = {ox.Variable(name): term for name, term in (known or {}).items()}
        try:
            return self._store.query(
                sparql,
                default_graph=list(names),
                named_graphs=[*names, *map(ox.NamedNode, named)],
                prefixes=PREFIXES,
                substitutions=bound,
            )
        except (SyntaxError, ValueError, RuntimeError) as error:
            raise QueryError(f"the query is not SPARQL: {error}", allowed="SELECT, ASK, CONSTRUCT") from None

    def dump(self, graphs: Sequence[Iri], into: ox.Store | None = None) -> ox.Store:
        """A copy of these named graphs, by itself or added to a store."""
        copy = ox.Store() if into is None else into
        for graph in graphs:
            copy.extend(self._store.quads_for_pattern(None, None, None, ox.NamedNode(graph)))
        return copy

    def everything(self) -> ox.Store:
        """A copy of all named graphs."""
        copy = ox.Store()
        copy.extend(self._store)
        return copy


def stored(graphs: Mapping[Iri, Iterable[Triple]]) -> ox.Store:
    """These named graphs."""
    made = ox.Store()
    for graph, triples in graphs.items():
        made.extend(_quads(ox.NamedNode(graph), triples))
    return made


def _quads(graph: ox.NamedNode, triples: Iterable[Triple]) -> Iterator[ox.Quad]:
    return (ox.Quad(_node(subject), _node(predicate), value, graph) for subject, predicate, value in triples)


def checked_query(sparql: str) -> str:
    """The query, if it only reads what is loaded.

    pyoxigraph cannot switch SERVICE off, and where a string or an IRI ends depends on its
    grammar, so that a scan for the keyword alone can be misled: the word is refused anywhere.

    Raises:
        QueryError: It has the word SERVICE, does not parse, is an update, or calls what is not there.
    """
    plain = _ESCAPE.sub(lambda match: chr(int(match[1] or match[2], 16)), sparql)
    if "service" in plain.lower() or "service" in sparql.lower():
        raise QueryError(
            "the query has the word SERVICE, which asks another server",
            allowed="SELECT, ASK, CONSTRUCT, DESCRIBE over what is loaded",
            remedy="leave the word out, in names and comments too",
        )
    bare = _QUOTED.sub(" ", sparql)
    if _depth(bare) > MOST_NESTED:
        raise QueryError(
            "the query is nested too deeply", allowed=f"{MOST_NESTED} brackets or signs within each other"
        )
    if (parts := len(_JOINT.findall(bare))) > MOST_JOINED:
        raise QueryError(f"the query joins {parts} parts", allowed=str(MOST_JOINED), remedy="a VALUES list")
    try:
        ox.Store().query(sparql, prefixes=PREFIXES)
    except UnicodeEncodeError:
        raise QueryError("the query has bytes that are no text", allowed="SPARQL in UTF-8") from None
    except SyntaxError as error:
        raise not_read(error) from None
    except RuntimeError as error:
        raise not_there(error) from None
    return sparql


def _depth(sparql: str) -> int:
    """How many brackets, and signs before what is signed itself, are within each other at most."""
    depth = run = most = 0
    for each in sparql:
        depth += (each in "({[") - (each in ")}]")
        run = run + 1 if each in "!-+^" else run if each.isspace() else 0
        most = max(most, depth + run)
    return most


def not_there(error: Exception) -> QueryError:
    """What an evaluator says of a query that calls a function which it has not."""
    return QueryError(
        f"the query cannot be evaluated: {error}", allowed="functions and aggregates of SPARQL 1.1"
    )


def not_read(error: Exception) -> QueryError:
    """What a parser says of a query, in words."""
    where, _, expected = str(error).partition(" expected ")
    if "Prefix not found" in expected:
        return QueryError(
            f"the query has a prefix that is not declared: {where.removesuffix(':')}",
            allowed=f"{', '.join(PREFIXES)}, and what the query declares",
            remedy="put PREFIX NAME: <IRI> at its beginning",
        )
    what = shorten(" ".join(expected.split()), SHOWN_EXPECTATION, placeholder=" …")
    return QueryError(
        f"the query is not SPARQL that reads: {where} expected {what}"
        if what
        else f"the query is not SPARQL that reads: {where}",
        allowed="SELECT, ASK, CONSTRUCT, DESCRIBE",
        remedy="LOAD, INSERT, DELETE and other updates are not done here",
    )


def value_of(term: object) -> Value:
    """IRI as text, literal as bool, int, float or text, unbound as None.

    A literal that is none of its datatype, like "0/4" of `xsd:double`, is its text.
    """
    if isinstance(term, ox.NamedNode):
        return term.value
    if isinstance(term, ox.Literal):
        try:
            return _READERS.get(term.datatype.value, str)(term.value)
        except (KeyError, ValueError):
            return term.value
    return None if term is None else str(term)


def rows_of(solutions: Solutions) -> tuple[list[str], list[Row]]:
    """Columns and rows of an answer; ASK has one cell, CONSTRUCT has subject, predicate, object."""
    if isinstance(solutions, ox.QueryBoolean):
        return ["answer"], [{"answer": bool(solutions)}]
    if isinstance(solutions, ox.QueryTriples):
        columns = ["subject", "predicate", "object"]
        return columns, [
            {"subject": value_of(s), "predicate": value_of(p), "object": value_of(o)}
            for s, p, o in ((t.subject, t.predicate, t.object) for t in solutions)
        ]
    columns = [variable.value for variable in solutions.variables]
    return columns, [
        dict(zip(columns, (value_of(term) for term in solution), strict=True)) for solution in solutions
    ]


def term_of(value: Value) -> Term:
    """Literal of a number or boolean; IRI of an absolute IRI; else a plain literal."""
    if isinstance(value, bool):
        return ox.Literal(value)
    if isinstance(value, int):
        return ox.Literal(value)
    if isinstance(value, float):
        return double(value)
    text = str(value)
    if re.match(r"[a-z][a-z0-9+.-]*:\S+$", text):
        return ox.NamedNode(text)
    return ox.Literal(text)


def double(value: float) -> ox.Literal:
    """xsd:double that reads back as exactly this value."""
    return ox.Literal(value)
