"""Puts a bus server together: kitchens and robots loaded, workers warm, keys declared."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import pyoxigraph as ox
import zenoh

from sdt_kg.load import load_twin, model_name
from services.bus.server import Server
from services.bus.work.deadlines import Deadlines
from services.bus.work.memory import Memory, Queries
from services.bus.work.pool import Pool
from services.bus.work.verbs import Setup
from services.store.embedded import EmbeddedStore
from services.store.quads import QuadStore
from services.store.workers import Delta, bulk

WORKERS = 2
"""Processes that judge; each holds all kitchens and robots."""
WAITING = 64
"""Questions that may wait for a worker."""


@contextmanager
def serving(
    session: zenoh.Session,
    kitchens: Sequence[str],
    robots: Sequence[str],
    *,
    workers: int = WORKERS,
    store: QuadStore | None = None,
) -> Iterator[Server]:
    """A server that answers over the session until the context ends.

    Args:
        session: Listens or is connected.
        kitchens: Names or paths; a twin's name in keys is the kitchen's.
        robots: Names or paths, loaded with every kitchen.
        workers: Processes that judge.
        store: Where verdicts are kept; in memory without it.
    """
    deadlines = Deadlines()
    store = store or EmbeddedStore(ox.Store(), lambda emptied: None)
    queries = Queries().start([*_twins(kitchens, robots), _kept(store)])
    memory = Memory(queries, store)
    pool = Pool(Setup(tuple(kitchens), tuple(robots)), workers, WAITING, deadlines, memory)
    names = [model_name(kitchen) for kitchen in kitchens]
    server = Server(session, names, pool, deadlines, memory).start()
    try:
        yield server
    finally:
        server.close()
        pool.close()
        deadlines.close()
        queries.close()


def _twins(kitchens: Sequence[str], robots: Sequence[str]) -> Iterator[Delta]:
    for kitchen in kitchens:
        yield bulk(load_twin(kitchen, robots).serialize("nquads"))


def _kept(store: QuadStore) -> Delta:
    """What the store has already."""
    quads = store.dump().dump(format=ox.RdfFormat.N_QUADS)
    assert quads is not None, "without an output, the bytes are returned"
    return bulk(quads)
