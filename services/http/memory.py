"""What a server keeps: verdicts, found again by IRI, and the queries over them."""

import asyncio
import threading
from asyncio import Future
from collections.abc import Callable, Coroutine, Iterable, Iterator
from contextlib import contextmanager
from typing import TypeVar

import pyoxigraph as ox

from predicates.record import Record
from services.http.world import World, lines
from services.judging.workers.jobs import Kept
from services.store.records import graph_of
from services.store.workers import Answered, Asked

T = TypeVar("T")


class Memory:
    """A world, driven from threads: its verdicts, and queries over all that it serves.

    Attributes:
        world: Its workers belong to the loop.
        loop: Runs in another thread.
    """

    def __init__(self, world: World, loop: asyncio.AbstractEventLoop) -> None:
        self.world, self.loop = world, loop
        self._tasks: set[asyncio.Task[Answered]] = set()

    def listen(self, listener: Callable[[Kept], None]) -> None:
        """Call the listener with every verdict that is kept from now on, by whomever."""
        self.world.listeners.append(lambda record: listener((record.verdict, lines(record.quads()))))

    def recall(self, iri: str) -> bytes | None:
        """The verdict's graph as N-Quads, if it is kept; the beginning of its hash will do."""
        return self._run(self.world.told(iri)) or None

    def quads(self, graph: str) -> bytes:
        """A named graph as N-Quads; empty where there is none."""
        return self._run(self.world.quads(graph))

    def keep(self, kept: Iterable[Kept]) -> None:
        """The verdicts are stored and asked about; what was there already stays as it is."""
        for iri, quads in kept:
            self._run(self.world.write_verdict(_record(iri, quads)))

    def ask(self, asked: Asked, seconds: float, done: Callable[[Future[Answered]], None]) -> None:
        """Ask, and call `done` from the loop's thread; after so many seconds nobody waits any more."""
        self.loop.call_soon_threadsafe(self._begin, asked, seconds, done)

    def _begin(self, asked: Asked, seconds: float, done: Callable[[Future[Answered]], None]) -> None:
        task = self.loop.create_task(self.world.workers.ask(asked, seconds))
        self._tasks.add(task)  # the loop holds no task by itself
        task.add_done_callback(self._tasks.discard)
        task.add_done_callback(done)

    def _run(self, doing: Coroutine[object, object, T]) -> T:
        return asyncio.run_coroutine_threadsafe(doing, self.loop).result()


@contextmanager
def running(world: World) -> Iterator[Memory]:
    """A world with an event loop of its own, in a thread of its own."""
    loop = asyncio.new_event_loop()
    thread = threading.Thread(target=loop.run_forever, name="world", daemon=True)
    thread.start()
    try:
        asyncio.run_coroutine_threadsafe(world.start(), loop).result()
        yield Memory(world, loop)
    finally:
        asyncio.run_coroutine_threadsafe(world.close(), loop).result()
        loop.call_soon_threadsafe(loop.stop)
        thread.join()
        loop.close()


def _record(iri: str, quads: bytes) -> Record:
    triples: list[tuple[str, str, ox.NamedNode | ox.Literal]] = []
    for quad in ox.parse(quads, format=ox.RdfFormat.N_QUADS):
        assert isinstance(quad.subject, ox.NamedNode), "no blank nodes in data"
        assert isinstance(quad.object, ox.NamedNode | ox.Literal), "no blank nodes in data"
        triples.append((quad.subject.value, quad.predicate.value, quad.object))
    return Record(iri, graph_of(iri), tuple(triples))
