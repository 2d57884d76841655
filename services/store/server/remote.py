"""Quads on a SPARQL 1.1 server."""

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from itertools import islice
from typing import Final, Self
from urllib.parse import urlsplit

import pyoxigraph as ox

from sdt_kg.errors import InputError, QueryError, StoreRejectedError
from sdt_kg.iri import PREFIXES, Iri
from sdt_kg.store import Solutions, Term, value_of
from services.store.known import restricted
from services.store.quads import checked, content
from services.store.server.turns import turn
from services.store.server.wire import Form, Wire, shown

BATCH: Final = 5_000
"""[quads] In one INSERT DATA: a megabyte or less, which servers take as one request."""

BULK: Final = 50_000
"""[quads] In one file that is given to an Oxigraph: over a directory three times as quick as updates."""

DUMPED_GRAPHS: Final = 200
"""Graphs in one answer of a dump."""

JSON: Final = "application/sparql-results+json"
N_TRIPLES: Final = "application/n-triples"

AT_ONCE: Final = "?no_transaction"
"""Has an Oxigraph make new files of tables instead of a transaction; what it acknowledged is there."""

OXIGRAPH_UNION: Final[Form] = {"union-default-graph": "true"}
"""Asks an Oxigraph for the union; the recommendation has no such parameter."""

OXIGRAPH_PATHS: Final = ("/query", "/update", "/store")
"""Where `oxigraph serve` takes queries, updates and files."""

_NO_UNION: Final = """ASK {
  { SELECT ?s ?p ?o { GRAPH ?g { ?s ?p ?o } } LIMIT 1 }
  FILTER NOT EXISTS { ?s ?p ?o }
}"""
"""Whether the default graph lacks what is in a named one."""

FIGURE: Final = 1.0058548015155846
"""A double of which no digit can be left out."""

_DECLARED: Final = re.compile(r"PREFIX\s+(\w+):", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Addresses:
    """Where a server takes queries and updates.

    Attributes:
        query: URL of its query service.
        update: URL of its update service; None where it is only asked.
        files: URL at which an Oxigraph takes N-Quads; None for other servers.
    """

    query: str
    update: str | None
    files: str | None = None

    @classmethod
    def of(cls, text: str) -> Self:
        """Both addresses, `QUERY,UPDATE`; the base of an Oxigraph, `http://HOST`; or one to ask only.

        Raises:
            InputError: It is none of these.
        """
        urls = [part.strip() for part in text.split(",")]
        for url in urls:
            if not is_url(url) or not urlsplit(url).hostname:
                raise InputError(f"'{url}' is no address of a server", allowed="http://HOST…, https://HOST…")
        if len(urls) == 1:
            base = urls[0].rstrip("/")
            bare = urlsplit(base).path == ""
            return cls(*(base + path for path in OXIGRAPH_PATHS)) if bare else cls(urls[0], None)
        if len(urls) > 2:
            raise InputError(f"{len(urls)} addresses of a server", allowed="one for query, one for update")
        return cls(*urls)


class RemoteStore:
    """Any SPARQL 1.1 server whose default graph is the union of its named graphs.

    Every request means the same when it is sent twice, so a broken connection is tried again. One update
    is one transaction on the servers that have transactions; a long `add` takes several.
    """

    def __init__(self, addresses: Addresses, wire: Wire | None = None) -> None:
        self._addresses = addresses
        self._wire = wire or Wire()
        self._union: Form | None = None
        self._is_exact = False

    def add(self, quads: Iterable[ox.Quad]) -> None:
        """Put quads into their named graphs, in batches of which each is written whole or not at all."""
        source, files = iter(quads), self._addresses.files
        while batch := checked(islice(source, BULK if files else BATCH)):
            if files and len(batch) > BATCH:
                text = ox.serialize(batch, format=ox.RdfFormat.N_QUADS)
                assert text is not None, "no output was given"
                self._wire.load(files + AT_ONCE, text)
            else:
                self._update(f"INSERT DATA {{ {content(batch)} }}")

    def replace(self, graph: Iri, quads: Iterable[ox.Quad]) -> None:
        """Give a named graph this content instead of what it had, in one request."""
        self._update(f"DROP SILENT GRAPH {ox.NamedNode(graph)} ; INSERT DATA {{ {content(checked(quads))} }}")

    def drop(self, graph: Iri) -> None:
        """Remove a named graph, if it is there."""
        self._update(f"DROP SILENT GRAPH {ox.NamedNode(graph)}")

    def insert(self, quad: ox.Quad) -> None:
        """Put a quad into its named graph."""
        self._update(f"INSERT DATA {{ {content([quad])} }}")

    def remove(self, quad: ox.Quad) -> None:
        """Remove a quad, if it is there."""
        self._update(f"DELETE DATA {{ {content([quad])} }}")

    def alone(self, graph: Iri) -> AbstractContextManager[None]:
        """Nobody else of us writes the graph meanwhile; whoever does otherwise waits."""
        return turn(self, graph, shown(self._addresses.query))

    def __contains__(self, graph: Iri) -> bool:
        """Whether a named graph is there."""
        found = self._asked(f"ASK {{ GRAPH {ox.NamedNode(graph)} {{ ?s ?p ?o }} }}")
        return isinstance(found, ox.QueryBoolean) and bool(found)

    def graph(self, graph: Iri) -> list[ox.Quad]:
        """All quads of a named graph; none where it is not there."""
        return self._quads([graph])

    def about(self, subject: ox.NamedNode, graph: Iri) -> list[ox.Quad]:
        """What a named graph says of a subject."""
        name = ox.NamedNode(graph)
        rows = _select(self._asked(f"SELECT ?p ?o {{ GRAPH {name} {{ {subject} ?p ?o }} }}"))
        return [ox.Quad(subject, row["p"], row["o"], name) for row in rows]

    def query(
        self, sparql: str, graphs: Sequence[Iri] | None = None, known: Mapping[str, Term] | None = None
    ) -> Solutions:
        """Evaluate a query whose default graph is the union of these graphs, or of all."""
        text = _with_prefixes(restricted(sparql, known or {}))
        form = self._all_graphs() if graphs is None else _only(graphs)
        self._check_figures()
        return self._asked(text, form)

    def dump(self, graphs: Sequence[Iri] | None = None) -> ox.Store:
        """A copy of these named graphs, or of all."""
        names = list(self._graphs() if graphs is None else graphs)
        copy = ox.Store()
        for start in range(0, len(names), DUMPED_GRAPHS):
            copy.bulk_extend(self._quads(names[start : start + DUMPED_GRAPHS]))
        return copy

    def close(self) -> None:
        """Let go of the connection."""
        self._wire.close()

    def _graphs(self) -> list[Iri]:
        rows = _select(self._asked("SELECT DISTINCT ?g { GRAPH ?g { ?s ?p ?o } } ORDER BY ?g"))
        return [row["g"].value for row in rows]

    def _quads(self, graphs: Sequence[Iri]) -> list[ox.Quad]:
        """As a SELECT in JSON: unlike N-Triples it shows whether it is whole."""
        self._check_figures()
        names = " ".join(str(ox.NamedNode(graph)) for graph in graphs)
        rows = _select(
            self._asked(f"SELECT ?g ?s ?p ?o {{ VALUES ?g {{ {names} }} GRAPH ?g {{ ?s ?p ?o }} }}")
        )
        return [ox.Quad(row["s"], row["p"], row["o"], row["g"]) for row in rows]

    def _asked(self, text: str, form: Form | None = None) -> Solutions:
        """The answer of the server, as it would be in process."""
        shape = _shape(text)
        accept = N_TRIPLES if shape is ox.QueryTriples else JSON
        body = self._wire.query(self._addresses.query, {"query": text, **(form or {})}, accept)
        try:
            solutions = _triples(body) if shape is ox.QueryTriples else _results(body)
        except (SyntaxError, ValueError) as error:
            raise self._cut(error) from None
        if isinstance(solutions, shape):
            return solutions
        del solutions
        raise self._cut("an answer of another kind")

    def _cut(self, why: object) -> StoreRejectedError:
        return StoreRejectedError(
            shown(self._addresses.query),
            f"broke its answer off, or did not give one: {why}",
            remedy="has it a time limit? ask for less, or raise the limit",
        )

    def _update(self, text: str) -> None:
        if self._addresses.update is None:
            raise InputError(
                f"no address for updates beside {shown(self._addresses.query)}",
                allowed="http://HOST/QUERY,http://HOST/UPDATE",
            )
        self._wire.update(self._addresses.update, text)

    def _all_graphs(self) -> Form:
        """What to ask for so that the default graph is the union; an empty answer would be a lie."""
        if self._union is not None:
            return self._union
        for form in ({}, OXIGRAPH_UNION):
            if not bool(self._asked(_NO_UNION, form)):
                if bool(self._asked("ASK { GRAPH ?g { ?s ?p ?o } }")):
                    self._union = form
                return form
        raise StoreRejectedError(
            shown(self._addresses.query),
            "does not show its named graphs in the default graph",
            remedy="have it make the default graph the union of all: services/README.md says how",
        )

    def _check_figures(self) -> None:
        """A figure comes back as it is: of a rounded limit or length another verdict would follow."""
        if self._is_exact:
            return
        rows = list(_select(self._asked(f"SELECT ?figure {{ BIND ({FIGURE!r}e0 AS ?figure) }}")))
        if len(rows) != 1:
            raise self._cut("an answer of another kind")
        found = value_of(rows[0]["figure"])
        if found != FIGURE:
            raise StoreRejectedError(
                shown(self._addresses.query),
                f"gives back {found} for {FIGURE}",
                remedy="take a server that keeps all digits of a double: services/README.md names some",
            )
        self._is_exact = True


def _only(graphs: Sequence[Iri]) -> Form:
    """What to ask for so that these graphs are all that there is."""
    return {"default-graph-uri": list(graphs), "named-graph-uri": list(graphs)}


def is_url(text: str) -> bool:
    """Whether the text begins as the address of a server."""
    return text.lower().startswith(("http://", "https://"))


def _with_prefixes(sparql: str) -> str:
    """The query with the usual prefixes, as far as it needs them."""
    try:
        ox.Store().query(sparql)
    except SyntaxError:
        declared = {name.lower() for name in _DECLARED.findall(sparql)}
        lines = [
            f"PREFIX {name}: <{namespace}>" for name, namespace in PREFIXES.items() if name not in declared
        ]
        return "\n".join((*lines, sparql))
    return sparql


def _shape(sparql: str) -> type[Solutions]:
    """The kind of answer that the query has."""
    try:
        return type(ox.Store().query(sparql))
    except SyntaxError as error:
        raise QueryError(f"the query is not SPARQL: {error}", allowed="SELECT, ASK, CONSTRUCT") from None


def _results(body: bytes) -> ox.QuerySolutions | ox.QueryBoolean:
    """Rows or truth, from an answer that is whole."""
    found = ox.parse_query_results(body, ox.QueryResultsFormat.JSON)
    if isinstance(found, ox.QueryBoolean):
        json.loads(body)  # its parser stops at the truth value
        return found
    try:
        for _ in found:  # raises where the answer is cut
            pass
    finally:
        del found  # must not outlive this in an error that another thread forgets: it belongs to this one
    whole = ox.parse_query_results(body, ox.QueryResultsFormat.JSON)
    assert isinstance(whole, ox.QuerySolutions), "the same bytes"
    return whole


def _triples(body: bytes) -> ox.QueryTriples:
    store = ox.Store()
    store.load(body, format=ox.RdfFormat.N_TRIPLES)
    triples = store.query("CONSTRUCT { ?s ?p ?o } WHERE { ?s ?p ?o }")
    assert isinstance(triples, ox.QueryTriples), "a CONSTRUCT"
    return triples


def _select(solutions: Solutions) -> ox.QuerySolutions:
    assert isinstance(solutions, ox.QuerySolutions), "a SELECT"
    return solutions
