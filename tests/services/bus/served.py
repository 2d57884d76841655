"""A server over a small kitchen, cheap enough to have several of."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import zenoh

from services.bus.server import Server
from services.bus.serving import serving
from services.http.judges import setup_of
from services.http.kitchens import open_kitchens
from services.http.memory import Memory, running
from services.http.world import World
from services.judging.workers.pool import Pool
from services.store.quads import QuadStore
from services.store.workers import Workers
from services.telemetry.told import Telemetry
from tests.small import FOLDER


@contextmanager
def small(
    session: zenoh.Session,
    telemetry: Telemetry | None = None,
    robots: tuple[str, ...] = (),
    kitchen: Path = FOLDER / "a.urdf",
    archive: QuadStore | None = None,
) -> Iterator[tuple[Memory, Server]]:
    """What it keeps, and the server; a process that judges is started when somebody asks for it."""
    world = World(open_kitchens((str(kitchen),), robots), Workers(1), archive)
    with running(world) as memory:
        pool = Pool(setup_of(world), 1, memory, telemetry=telemetry)
        try:
            with serving(session, pool, memory) as server:
                yield memory, server
        finally:
            pool.close()
