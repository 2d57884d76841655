"""One question to a store and its answer, as bytes in a format that the asker accepts."""

import csv
import io
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from itertools import chain
from typing import Any, Final, Self

import pyoxigraph as ox

from sdt_kg.errors import InputError, QueryError
from sdt_kg.iri import PREFIXES, Iri
from sdt_kg.store import not_read, not_there
from services.store.guard import RefusedQueryError, guarded, known_graphs
from services.store.workers.deltas import DEFAULT_GRAPH, Held
from services.store.workers.errors import Limit, LimitError, NotAcceptableError
from services.store.workers.frames import Head

TABLES: Final = {
    "application/sparql-results+json": ox.QueryResultsFormat.JSON,
    "application/sparql-results+xml": ox.QueryResultsFormat.XML,
    "text/csv": ox.QueryResultsFormat.CSV,
    "text/tab-separated-values": ox.QueryResultsFormat.TSV,
}
"""Formats of SELECT."""
TRUTHS: Final = dict(list(TABLES.items())[:2])
"""Formats of ASK."""
GRAPHS: Final = {
    "text/turtle": ox.RdfFormat.TURTLE,
    "application/n-triples": ox.RdfFormat.N_TRIPLES,
    "application/trig": ox.RdfFormat.TRIG,
    "application/ld+json": ox.RdfFormat.JSON_LD,
}
"""Formats of CONSTRUCT, DESCRIBE and whole graphs."""
QUADS: Final = "application/n-quads"


@dataclass(frozen=True, slots=True)
class Asked:
    """One question.

    Attributes:
        do: `query`, `graph` (a whole one), `about` (quads of all named graphs that mention an IRI) or
            `present` (all triples of the default graph that do).
        text: The query, or the IRI of the graph or entity; the default graph is the empty text.
        accepted: Media types that the asker takes, best first.
        base: IRI against which relative IRIs are resolved.
        default_graphs, named_graphs: The dataset, if the asker says it.
        known: Variables that the query selects → IRIs or texts, as JSON-able pairs (kind, value).
        rows, size: At most so many rows or triples, and so many bytes.
    """

    do: str
    text: str
    accepted: tuple[str, ...] = (*TABLES, *GRAPHS)
    base: Iri | None = None
    default_graphs: tuple[Iri, ...] = ()
    named_graphs: tuple[Iri, ...] = ()
    known: Mapping[str, tuple[str, str]] = field(default_factory=dict[str, tuple[str, str]])
    rows: int = 1_000_000
    size: int = 64 * 2**20

    def head(self) -> Head:
        """As JSON."""
        return {name: getattr(self, name) for name in self.__slots__}

    @classmethod
    def of(cls, head: Head) -> Self:
        """The question that a head says."""
        lists = {"accepted", "default_graphs", "named_graphs"}
        fields: dict[str, Any] = {  # as JSON gives them
            name: tuple(value) if name in lists else value for name, value in head.items()
        }
        return cls(**fields)


@dataclass(frozen=True, slots=True)
class Answered:
    """An answer.

    Attributes:
        media: Its media type.
        body: Complete: an answer is never cut.
        found: Whether the graph or the entity asked for is there.
    """

    media: str
    body: bytes = field(repr=False)
    found: bool = True


def answer(held: Held, asked: Asked) -> Answered:
    """The answer to a question.

    Raises:
        QueryError: No SPARQL that reads.
        RefusedQueryError: SERVICE, or a graph that is not here.
        NotAcceptableError: The answer has none of the accepted formats.
        LimitError: Too many rows or bytes.
    """
    return {"query": _query, "graph": _graph, "about": _about, "present": _present}[asked.do](held, asked)


class _Bounded(io.BytesIO):
    """A buffer that refuses to become too long."""

    def __init__(self, size: int) -> None:
        super().__init__()
        self._size = size

    def write(self, part: bytes, /) -> int:  # pyright: ignore[reportIncompatibleMethodOverride]  # bytes only
        if self.tell() + len(part) > self._size:
            raise LimitError(Limit.BYTES, f"{self._size} bytes of answer")
        return super().write(part)


def _query(held: Held, asked: Asked) -> Answered:
    solutions = _solutions(held, asked)
    out = _Bounded(asked.size)
    if isinstance(solutions, ox.QueryTriples):
        return _triples(_counted(solutions, asked), asked)
    formats = TRUTHS if isinstance(solutions, ox.QueryBoolean) else TABLES
    media = _accepted(asked, formats)
    solutions.serialize(out, format=formats[media])
    body = out.getvalue()
    if len(body) > asked.rows and _row_count(body, formats[media]) > asked.rows:
        raise LimitError(Limit.ROWS, f"{asked.rows} rows")
    return Answered(media, body)


def _solutions(held: Held, asked: Asked) -> ox.QuerySolutions | ox.QueryBoolean | ox.QueryTriples:
    """What pyoxigraph says, over the dataset of the protocol, else of the query, else the whole."""
    checked = guarded(asked.text, held.is_graph, asked.base)
    known_graphs((*asked.default_graphs, *asked.named_graphs), held.is_graph)
    default, named = asked.default_graphs, asked.named_graphs
    if not default and not named:
        default, named = checked.default_graphs, checked.named_graphs
    dataset: dict[str, list[ox.NamedNode]] = {}
    if default or named:
        dataset = {"default_graph": _nodes(default), "named_graphs": _nodes(named)}
    try:
        return held.store.query(
            checked.text,
            base_iri=asked.base,
            prefixes=PREFIXES,
            substitutions={ox.Variable(name): _term(*value) for name, value in asked.known.items()},
            **dataset,  # pyright: ignore[reportArgumentType]  # two of the keywords
        )
    except (SyntaxError, ValueError) as error:
        said = not_read(error)
        if checked.text != asked.text:
            service = "the word SERVICE may stand in strings, comments and full IRIs only"
            raise QueryError(said.what, allowed=said.allowed, remedy=service) from None
        raise said from None
    except RuntimeError as error:
        raise not_there(error) from None


def _nodes(graphs: Iterable[Iri]) -> list[ox.NamedNode]:
    return [ox.NamedNode(graph) for graph in graphs]


def _term(kind: str, value: str) -> ox.NamedNode | ox.Literal:
    return ox.NamedNode(value) if kind == "iri" else ox.Literal(value)


def _counted(triples: Iterable[ox.Triple], asked: Asked) -> list[ox.Triple]:
    """Each triple once, if there are not too many."""
    found: dict[ox.Triple, None] = {}
    for triple in triples:
        found[triple] = None
        if len(found) > asked.rows:
            raise LimitError(Limit.ROWS, f"{asked.rows} triples")
    return list(found)


def _triples(triples: Iterable[ox.Triple], asked: Asked) -> Answered:
    media, out = _accepted(asked, GRAPHS), _Bounded(asked.size)
    prefixes = PREFIXES if media != "application/n-triples" else None
    ox.serialize(triples, out, GRAPHS[media], prefixes=prefixes)
    return Answered(media, out.getvalue())


def _accepted(asked: Asked, formats: Mapping[str, object]) -> str:
    for media in asked.accepted:
        if media in formats:
            return media
    raise NotAcceptableError("the answer has no accepted media type", allowed=", ".join(formats))


def _row_count(body: bytes, form: ox.QueryResultsFormat) -> int:
    if form == ox.QueryResultsFormat.CSV:
        return sum(1 for _ in csv.reader(io.StringIO(body.decode(), newline=""))) - 1
    parsed = ox.parse_query_results(body, format=form)
    return sum(1 for _ in parsed) if isinstance(parsed, ox.QuerySolutions) else 1


def _graph(held: Held, asked: Asked) -> Answered:
    """A whole graph; the default graph is there even when it is empty."""
    found = asked.text == DEFAULT_GRAPH or held.is_graph(asked.text)
    graph = ox.DefaultGraph() if asked.text == DEFAULT_GRAPH else ox.NamedNode(asked.text)
    quads = held.store.quads_for_pattern(None, None, None, graph)
    triples = (ox.Triple(quad.subject, quad.predicate, quad.object) for quad in quads)
    answered = _triples(_counted(triples, asked), asked)
    return Answered(answered.media, answered.body, found)


def _about(held: Held, asked: Asked) -> Answered:
    """Quads of named graphs that have the IRI as subject or object, as N-Quads."""
    node = ox.NamedNode(asked.text)
    patterns: tuple[Callable[[], Iterable[ox.Quad]], ...] = (
        lambda: held.store.quads_for_pattern(node, None, None, None),
        lambda: held.store.quads_for_pattern(None, None, node, None),
    )
    quads: list[ox.Quad] = []
    for pattern in patterns:
        shown = (quad for quad in pattern() if isinstance(quad.graph_name, ox.NamedNode))
        quads += [quad for quad, _ in zip(shown, range(asked.rows), strict=False)]
    out = _Bounded(asked.size)
    ox.serialize(quads, out, ox.RdfFormat.N_QUADS)
    return Answered(QUADS, out.getvalue(), bool(quads))


def _present(held: Held, asked: Asked) -> Answered:
    """Triples of the default graph that have the IRI as subject or object: no other state or branch."""
    node, graph = ox.NamedNode(asked.text), ox.DefaultGraph()
    quads = chain(
        held.store.quads_for_pattern(node, None, None, graph),
        held.store.quads_for_pattern(None, None, node, graph),
    )
    triples = _counted((quad.triple for quad in quads), asked)
    answered = _triples(triples, asked)
    return Answered(answered.media, answered.body, bool(triples))


def error_head(error: InputError) -> Head:
    """A refusal as JSON."""
    head: Head = {"error": type(error).__name__, "what": error.what, "allowed": error.allowed}
    return head | {
        "remedy": error.remedy,
        "limit": error.limit.value if isinstance(error, LimitError) else "",
    }


def error_of(head: Head) -> InputError:
    """The refusal that a head says."""
    if head["limit"]:
        return LimitError(Limit(head["limit"]), head["allowed"])
    kinds = (RefusedQueryError, NotAcceptableError, QueryError)
    kind = {each.__name__: each for each in kinds}[head["error"]]
    return kind(head["what"], allowed=head["allowed"], remedy=head["remedy"])
