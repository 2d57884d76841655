"""Puts a bus server together: kitchens and robots loaded, workers warm, keys declared."""

import asyncio
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import zenoh

from sdt_kg.twin import Twin
from services.bus.judging import Setup
from services.bus.server import Server
from services.bus.sessions import Reach, open_session
from services.bus.sweeps import Models, Sweeps
from services.bus.work.deadlines import Deadlines
from services.bus.work.memory import Memory, running
from services.bus.work.pool import Pool
from services.http.kitchens import open_kitchens
from services.http.world import World
from services.store.workers import Workers

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


def beside_http(
    endpoint: str, options: Options
) -> Callable[[World, asyncio.AbstractEventLoop], AbstractContextManager[Server]]:
    """What `sdt serve --bus` serves beside HTTP: the same world, over Zenoh."""

    @contextmanager
    def beside(world: World, loop: asyncio.AbstractEventLoop) -> Iterator[Server]:
        session = open_session(listen=endpoint, config=options.config)
        oracles = Reach(endpoint, options.config) if options.oracles else None
        setup = replace(setup_of(world), reach=oracles)
        try:
            with serving(session, setup, Memory(world, loop), workers=options.workers) as server:
                yield server
        finally:
            session.close()

    return beside


def setup_of(world: World) -> Setup:
    """What the workers of a server over this world have to load."""
    kitchens = tuple(world.kitchens.values())
    return Setup(tuple(each.source for each in kitchens), kitchens[0].robots if kitchens else ())


@contextmanager
def alone(session: zenoh.Session, kitchens: Sequence[str], robots: Sequence[str]) -> Iterator[Server]:
    """A server over a world of its own, kept in memory, with one worker that judges."""
    world = World(open_kitchens(tuple(kitchens), tuple(robots)), Workers())
    with running(world) as memory, serving(session, setup_of(world), memory, workers=1) as server:
        yield server


@contextmanager
def serving(
    session: zenoh.Session, setup: Setup, memory: Memory, *, workers: int = WORKERS
) -> Iterator[Server]:
    """A server that answers over the session until the context ends.

    Args:
        session: Listens or is connected.
        setup: Kitchens and robots; a twin's name in keys is the kitchen's.
        memory: The world that is asked about, in which verdicts are kept.
        workers: Processes that judge.
    """
    deadlines = Deadlines()
    pool = Pool(setup, workers, WAITING, deadlines, memory)
    kitchens = memory.world.kitchens.items()
    sweeps = Sweeps(pool, {name: _models(kitchen.service.twin) for name, kitchen in kitchens})
    server = Server(session, pool, deadlines, memory, sweeps).start()
    try:
        yield server
    finally:
        server.close()
        sweeps.close()
        pool.close()
        deadlines.close()


def _models(twin: Twin) -> Models:
    """What the twin can be swept over."""
    robots = tuple(twin.name(robot) for robot in twin.robots)
    return Models(robots, tuple(container.name for container in twin.containers()))
