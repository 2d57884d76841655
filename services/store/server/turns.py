"""Turns at a named graph of a server that others write to."""

import random
import time
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final, Protocol

import pyoxigraph as ox

from sdt_kg.errors import StoreUnavailableError
from sdt_kg.iri import LAW, Iri, graph_iri

WRITERS: Final = graph_iri("writers", "now")
"""Who is about to write which graph."""

LEASE: Final = 30.0
"""[s] After which a writer that did not end is taken for dead; a write takes milliseconds."""

PATIENCE: Final = 10 * LEASE
"""[s] After which the graph is given up."""

PAUSE: Final = 0.02
"""[s] At most, before the first further attempt; each may take twice as long as the one before."""

LONGEST_PAUSE: Final = 0.5


class Shared(Protocol):
    """What a turn needs of a server."""

    def insert(self, quad: ox.Quad) -> None:
        """Have a quad, once this returns."""
        ...

    def remove(self, quad: ox.Quad) -> None:
        """Have it no more."""
        ...

    def about(self, subject: ox.NamedNode, graph: Iri) -> list[ox.Quad]:
        """What a named graph says of a subject."""
        ...


@contextmanager
def turn(server: Shared, graph: Iri, place: str) -> Iterator[None]:
    """Nobody else who takes turns writes the graph meanwhile.

    A writer first says which graph it is about to write, then looks whether another has said so: of two,
    at least the later sees the other, withdraws and waits. This needs no transactions: those of an Oxigraph
    over a directory are each written whole, but two that write a graph at once leave the quads of both.

    Raises:
        StoreUnavailableError: Others did not come to an end.
    """
    subject = ox.NamedNode(graph)
    own = ox.Quad(subject, ox.NamedNode(LAW + "writer"), ox.Literal(uuid.uuid4().hex), ox.NamedNode(WRITERS))
    since: dict[ox.Quad, float] = {}
    began, pause = time.monotonic(), PAUSE
    server.insert(own)
    try:
        while others := [each for each in server.about(subject, WRITERS) if each != own]:
            server.remove(own)
            now = time.monotonic()
            if now - began > PATIENCE:
                raise StoreUnavailableError(
                    place, f"has others who write {graph} all the time", remedy="try again"
                )
            since = {each: since.get(each, now) for each in others}
            for dead in (each for each, seen in since.items() if now - seen > LEASE):
                server.remove(dead)
            time.sleep(random.uniform(0, pause))  # noqa: S311 - two that wait must not wait alike
            pause = min(2 * pause, LONGEST_PAUSE)
            server.insert(own)
        yield
    finally:
        server.remove(own)
