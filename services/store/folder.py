"""Quads in a directory: a journal takes what is written, RocksDB's tables take much of it at once."""

import threading
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from itertools import chain, islice
from pathlib import Path
from typing import Final

import pyoxigraph as ox

from sdt_kg.errors import StoreRejectedError
from sdt_kg.iri import Iri
from sdt_kg.store import Solutions, Term
from services.store.embedded import BATCH, EmbeddedStore
from services.store.journal import Entry, Journal
from services.store.quads import checked

MOST: Final = 50_000
"""[quads] Kept in the journal, and here, before they are put into the tables."""

FEW: Final = 10_000
"""[quads] Up to which one transaction (15 us a quad) is quicker than new files (6 us, and 0.2 s)."""


class FolderStore:
    """pyoxigraph's store over a directory.

    RocksDB takes 15 us for each quad, whatever is written with it: a verdict would wait for two
    milliseconds. What reads sees all that was written, since it is put into the tables before.

    Args:
        tables: RocksDB's.
        journal: What a process that was killed has left there is put into the tables at once; None where
            the directory is only read.

    Raises:
        StoreRejectedError: The journal is damaged, or what it has cannot be put into the tables; likewise
            when something is read, where the tables are damaged.
    """

    def __init__(self, folder: Path, tables: ox.Store, journal: Journal | None) -> None:
        self._folder, self._tables, self._journal = folder, tables, journal
        self._reader = EmbeddedStore(tables)
        self._emptied: set[ox.NamedNode] = set()
        self._written: dict[ox.NamedNode, list[ox.Quad]] = {}
        self._count = 0
        self._lock = threading.RLock()
        self._is_open = True
        if journal is None:
            return
        for entry in journal.entries():
            self._take(entry)
        self._settle()
        journal.clear()  # of an entry that was not whole

    def add(self, quads: Iterable[ox.Quad]) -> None:
        """Put quads into their named graphs, in batches of which each is written whole or not at all."""
        source = iter(quads)
        while batch := checked(islice(source, BATCH)):
            self._write(Entry(None, batch))

    def replace(self, graph: Iri, quads: Iterable[ox.Quad]) -> None:
        """Give a named graph this content instead of what it had, in one step."""
        self._write(Entry(ox.NamedNode(graph), checked(quads)))

    def drop(self, graph: Iri) -> None:
        """Remove a named graph, if it is there."""
        self._write(Entry(ox.NamedNode(graph), []))

    def alone(self, graph: Iri) -> AbstractContextManager[None]:
        """Nobody else writes the graph meanwhile: one process has the directory."""
        return nullcontext()

    def __contains__(self, graph: Iri) -> bool:
        """Whether a named graph is there."""
        with reading(self._folder):
            return graph in self._settled(graph)

    def graph(self, graph: Iri) -> list[ox.Quad]:
        """All quads of a named graph; none where it is not there."""
        with reading(self._folder):
            return self._settled(graph).graph(graph)

    def query(
        self, sparql: str, graphs: Sequence[Iri] | None = None, known: Mapping[str, Term] | None = None
    ) -> Solutions:
        """Evaluate a query whose default graph is the union of these graphs, or of all."""
        with reading(self._folder):
            return _whole(self._settled().query(sparql, graphs, known))

    def dump(self, graphs: Sequence[Iri] | None = None) -> ox.Store:
        """A copy of these named graphs, or of all."""
        with reading(self._folder):
            return self._settled().dump(graphs)

    def close(self) -> None:
        """All is in the tables, and another process may have the directory."""
        with self._lock:
            if not self._is_open:
                return
            self._is_open = False
            try:
                if self._journal is not None:
                    self._settle()
                    with self._said():
                        self._tables.flush()
            finally:  # what the tables could not take is in the journal
                if self._journal is not None:
                    self._journal.close()
                self._reader.close()
                self._tables = ox.Store()

    def _write(self, entry: Entry) -> None:
        if self._journal is None:
            raise StoreRejectedError(
                str(self._folder), "can only be read", remedy="copy it to where it can be written"
            )
        with self._lock:
            self._journal.add(entry)
            self._take(entry)
            if self._count >= MOST:
                self._settle()

    def _take(self, entry: Entry) -> None:
        """The entry is to be put into the tables, with those before it."""
        if entry.emptied is not None:
            self._emptied.add(entry.emptied)
            self._written[entry.emptied] = []
        for quad in entry.quads:
            assert isinstance(quad.graph_name, ox.NamedNode), "as checked"
            self._written.setdefault(quad.graph_name, []).append(quad)
        self._count += len(entry.quads)

    def _settled(self, graph: Iri | None = None) -> EmbeddedStore:
        """The tables, with all that was written; or all that was written to that graph."""
        with self._lock:
            if graph is None or ox.NamedNode(graph) in self._written:
                self._settle()
            return self._reader

    def _settle(self) -> None:
        """The tables have what the journal has; a process that is killed meanwhile does it again.

        Raises:
            StoreRejectedError: They do not; the journal keeps it, and it is tried again.
        """
        if self._journal is None or not self._written:
            return
        quads = list(chain.from_iterable(self._written.values()))
        put = self._tables.extend if len(quads) <= FEW else self._tables.bulk_extend
        with self._said():
            for graph in self._emptied:
                self._tables.remove_graph(graph)
            put(quads)
        self._journal.clear()
        self._emptied.clear()
        self._written.clear()
        self._count = 0

    @contextmanager
    def _said(self) -> Iterator[None]:
        """What RocksDB cannot write is an error of the store."""
        try:
            yield
        except (OSError, RuntimeError) as error:
            raise StoreRejectedError(
                str(self._folder),
                f"cannot put into its tables what its journal has: {error}",
                remedy="make room; what was acknowledged is kept, and there when it is opened again",
            ) from None


@contextmanager
def reading(folder: Path) -> Iterator[None]:
    """What RocksDB cannot read in a directory is an error of the store."""
    try:
        yield
    except (OSError, RuntimeError) as error:
        raise damaged(folder, error) from None


def damaged(folder: Path, error: Exception) -> StoreRejectedError:
    """What is said of a directory of which RocksDB finds that it is not as it was written."""
    return StoreRejectedError(
        str(folder), f"is damaged: {error}", remedy="take a backup, or save to another place"
    )


def _whole(solutions: Solutions) -> Solutions:
    """The answer, read to its end: pyoxigraph finds damage only where it comes to it."""
    if isinstance(solutions, ox.QueryTriples):
        copy = ox.Store()
        copy.extend(ox.Quad(each.subject, each.predicate, each.object) for each in solutions)
        return copy.query("CONSTRUCT { ?s ?p ?o } WHERE { ?s ?p ?o }")
    if isinstance(solutions, ox.QuerySolutions):
        rows = solutions.serialize(format=ox.QueryResultsFormat.JSON)
        assert rows is not None, "no output was given"
        return ox.parse_query_results(rows, format=ox.QueryResultsFormat.JSON)
    return solutions
