"""What a server keeps: verdicts, found again by IRI, and the queries over them."""

import asyncio
import threading
from collections.abc import Callable, Iterable
from concurrent.futures import Future
from typing import Protocol, Self

import pyoxigraph as ox

from predicates.record import Record
from services.bus.work.jobs import Kept
from services.store.files import SavedVerdicts, graph_of
from services.store.quads import QuadStore
from services.store.workers import Answered, Asked, Delta, Workers, bulk, drop


class Keeper(Protocol):
    """What workers' verdicts are kept in."""

    def recall(self, iri: str) -> bytes | None:
        """The verdict's graph as N-Quads, if it is kept."""
        ...

    def keep(self, kept: Iterable[Kept]) -> None:
        """The verdicts are stored; what was there already stays as it is."""
        ...


class NoMemory:
    """Of an oracle: it makes no verdicts."""

    def recall(self, iri: str) -> None:
        """Nothing."""
        del iri

    def keep(self, kept: Iterable[Kept]) -> None:
        """Nothing is ever given to be kept."""
        del kept


class Memory:
    """Verdicts by IRI, in a store, and query workers that see them.

    Attributes:
        queries: Over the twins and everything that is kept.
    """

    def __init__(self, queries: "Queries", store: QuadStore) -> None:
        self.queries = queries
        self._saved = SavedVerdicts(store)
        self._lock = threading.Lock()
        self._listeners: list[Callable[[Kept], None]] = []

    def listen(self, listener: Callable[[Kept], None]) -> None:
        """Call the listener with every verdict that is kept from now on."""
        self._listeners.append(listener)

    def recall(self, iri: str) -> bytes | None:
        """The verdict's graph as N-Quads, if it is kept."""
        with self._lock:
            quads = self._saved.store.graph(graph_of(iri))
        return _nquads(quads) if quads else None

    def keep(self, kept: Iterable[Kept]) -> None:
        """The verdicts are stored and asked about; what was there already stays as it is."""
        with self._lock:
            new = [each for each in kept if self._saved.add_record(_record(*each))]
        self.queries.add(new)
        for each in new:
            for listener in self._listeners:
                listener(each)


class Queries:
    """Query workers, driven from threads; an event loop of their own runs beside."""

    def __init__(self, workers: Workers | None = None) -> None:
        self.workers = Workers() if workers is None else workers
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name="queries", daemon=True)

    def start(self, deltas: Iterable[Delta]) -> Self:
        """The data is loaded and queries can be asked."""
        self._thread.start()
        asyncio.run_coroutine_threadsafe(self.workers.start(deltas), self._loop).result()
        return self

    def ask(self, asked: Asked, done: Callable[["Future[Answered]"], None]) -> None:
        """Ask, and call `done` from the loop's thread."""
        asyncio.run_coroutine_threadsafe(self.workers.ask(asked), self._loop).add_done_callback(done)

    def add(self, kept: Iterable[Kept]) -> None:
        """Verdicts are asked about from now on."""
        for iri, quads in kept:
            for delta in (drop(graph_of(iri)), bulk(quads)):
                asyncio.run_coroutine_threadsafe(self.workers.apply(delta), self._loop).result()

    def close(self) -> None:
        """No worker is left."""
        asyncio.run_coroutine_threadsafe(self.workers.close(), self._loop).result()
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()


def _record(iri: str, quads: bytes) -> Record:
    triples: list[tuple[str, str, ox.NamedNode | ox.Literal]] = []
    for quad in ox.parse(quads, format=ox.RdfFormat.N_QUADS):
        assert isinstance(quad.subject, ox.NamedNode), "no blank nodes in data"
        assert isinstance(quad.object, ox.NamedNode | ox.Literal), "no blank nodes in data"
        triples.append((quad.subject.value, quad.predicate.value, quad.object))
    return Record(iri, graph_of(iri), tuple(triples))


def _nquads(quads: Iterable[ox.Quad]) -> bytes:
    dumped = ox.serialize(quads, format=ox.RdfFormat.N_QUADS)
    assert dumped is not None, "without an output, the bytes are returned"
    return dumped
