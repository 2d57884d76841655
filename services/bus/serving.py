"""Puts a bus server together: kitchens and robots loaded, workers warm, keys declared."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import pyoxigraph as ox
import zenoh

from sdt_kg.load import load_twin, model_name
from sdt_kg.twin import Twin
from services.bus.judging import Setup
from services.bus.server import Server
from services.bus.sessions import Reach, open_session
from services.bus.sweeps import Models, Sweeps
from services.bus.work.deadlines import Deadlines
from services.bus.work.memory import Memory, Queries
from services.bus.work.pool import Pool
from services.store.embedded import EmbeddedStore
from services.store.quads import QuadStore
from services.store.workers import Delta, bulk

WORKERS = 2
"""Processes that judge; each holds all kitchens and robots."""
WAITING = 64
"""Questions that may wait for a worker."""


@dataclass(frozen=True, slots=True)
class Options:
    """How a server works.

    Attributes:
        workers: Processes that judge.
        oracles: Whether they ask oracles on the bus rather than judge in process.
        config: Zenoh configuration file.
    """

    workers: int = WORKERS
    oracles: bool = False
    config: Path | None = None


@contextmanager
def listening(
    endpoint: str,
    kitchens: Sequence[str],
    robots: Sequence[str],
    store: QuadStore | None = None,
    options: Options = Options(),
) -> Iterator[Server]:
    """A server that listens for the bus at an endpoint, as `sdt serve --bus` does."""
    session = open_session(listen=endpoint, config=options.config)
    oracles = Reach(endpoint, options.config) if options.oracles else None
    setup = Setup(tuple(kitchens), tuple(robots), oracles)
    try:
        with serving(session, setup, workers=options.workers, store=store) as server:
            yield server
    finally:
        session.close()


@contextmanager
def serving(
    session: zenoh.Session, setup: Setup, *, workers: int = WORKERS, store: QuadStore | None = None
) -> Iterator[Server]:
    """A server that answers over the session until the context ends.

    Args:
        session: Listens or is connected.
        setup: Kitchens and robots; a twin's name in keys is the kitchen's.
        workers: Processes that judge.
        store: Where verdicts are kept; in memory without it.
    """
    twins = {model_name(each): load_twin(each, setup.robots) for each in setup.kitchens}
    store = store or EmbeddedStore(ox.Store(), lambda emptied: None)
    deadlines = Deadlines()
    queries = Queries().start([*(bulk(each.serialize("nquads")) for each in twins.values()), _kept(store)])
    memory = Memory(queries, store)
    pool = Pool(setup, workers, WAITING, deadlines, memory)
    sweeps = Sweeps(pool, {name: _models(twin) for name, twin in twins.items()})
    server = Server(session, pool, deadlines, memory, sweeps).start()
    try:
        yield server
    finally:
        server.close()
        sweeps.close()
        pool.close()
        deadlines.close()
        queries.close()


def _models(twin: Twin) -> Models:
    """What the twin can be swept over."""
    robots = tuple(twin.name(robot) for robot in twin.robots)
    return Models(robots, tuple(container.name for container in twin.containers()))


def _kept(store: QuadStore) -> Delta:
    """What the store has already."""
    quads = store.dump().dump(format=ox.RdfFormat.N_QUADS)
    assert quads is not None, "without an output, the bytes are returned"
    return bulk(quads)
