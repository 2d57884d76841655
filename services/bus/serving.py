"""Puts a bus server together: the world that is asked about, the processes that judge, the keys declared."""

import asyncio
import ctypes
import gc
import sys
import uuid
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import zenoh

from sdt_kg.twin import Twin
from services.bus.oracles.remote import OnBus
from services.bus.server import Server
from services.bus.sessions import Reach, open_session
from services.bus.sweeps import Models, Sweeps
from services.http.judges import setup_of
from services.http.kitchens import open_kitchens
from services.http.memory import Memory, running
from services.http.world import World
from services.judging.workers.pool import Pool
from services.store.workers import Workers

M_MMAP_THRESHOLD = -3  # of malloc.h
LARGE = 2**15
"""[bytes] Blocks from here on are mapped, each by itself: Zenoh cuts what is large into pieces of 64 KiB."""
TURN = 0.001
"""[s] A thread of Python may go on for, while another wants to."""


@dataclass(frozen=True, slots=True)
class BesideHttp:
    """What `sdt serve --bus` serves beside HTTP: the same world and the same processes, over Zenoh.

    Attributes:
        endpoint: Where it listens.
        config: Zenoh configuration file.
        ask_oracles: Whether the processes ask oracles on the bus rather than judge themselves.
    """

    endpoint: str
    config: Path | None = None
    ask_oracles: bool = False

    @property
    def oracles(self) -> OnBus | None:
        """How the processes that judge get their oracles."""
        return OnBus(Reach(self.endpoint, self.config)) if self.ask_oracles else None

    @contextmanager
    def __call__(self, world: World, pool: Pool, loop: asyncio.AbstractEventLoop) -> Iterator[Server]:
        """Serve until the context ends."""
        session = open_session(listen=self.endpoint, config=self.config)
        try:
            with serving(session, pool, Memory(world, loop)) as server:
                settle()
                yield server
        finally:
            session.close()


@contextmanager
def alone(
    session: zenoh.Session, kitchens: Sequence[str], robots: Sequence[str], oracles: OnBus | None = None
) -> Iterator[Server]:
    """A server over a world of its own, kept in memory, with one process that judges or asks the oracles."""
    world = World(open_kitchens(tuple(kitchens), tuple(robots)), Workers())
    with running(world) as memory:
        pool = Pool(replace(setup_of(world), oracles=oracles), 1, memory)
        pool.warm()
        try:
            with serving(session, pool, memory) as server:
                yield server
        finally:
            pool.close()


@contextmanager
def serving(session: zenoh.Session, pool: Pool, memory: Memory) -> Iterator[Server]:
    """A server that answers over the session until the context ends.

    Args:
        session: Listens or is connected.
        pool: Judges; a twin's name in keys is the kitchen's.
        memory: The world that is asked about, in which verdicts are kept.
    """
    _give_back()
    kitchens = memory.world.kitchens.items()
    models = {name: _models(name, kitchen.service.twin) for name, kitchen in kitchens}
    sweeps = Sweeps(pool, models, new_name())
    server = Server(session, pool, memory, sweeps).start()
    try:
        yield server
    finally:
        server.close()
        sweeps.close()


def new_name() -> str:
    """Of a server: two that begin at once have different ones."""
    return uuid.uuid4().hex[:12]


def settle() -> None:
    """What this process has loaded is there to stay: for a process that does nothing but serve.

    Python would look through all of it for garbage now and then, for a tenth of a second in which
    nobody is answered. Nor does who answers wait long for a thread that computes.
    """
    gc.collect()
    gc.freeze()
    sys.setswitchinterval(TURN)


def _give_back() -> None:
    """What a large request took goes back to the system when it is freed.

    glibc keeps what was freed in pieces: requests of 16 MiB would make the server grow.
    """
    libc = ctypes.CDLL(None)
    if hasattr(libc, "mallopt"):
        libc.mallopt(M_MMAP_THRESHOLD, LARGE)


def _models(name: str, twin: Twin) -> Models:
    """What the twin can be swept over."""
    robots = tuple(twin.name(robot) for robot in twin.robots)
    return Models(name, robots, tuple(container.name for container in twin.containers()))
