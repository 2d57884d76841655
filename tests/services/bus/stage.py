"""A routed bus, each part a process of its own, so that each can be killed while it is asked."""

import contextlib
import multiprocessing as mp
import os
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import cycle
from multiprocessing.connection import Connection as Pipe
from multiprocessing.process import BaseProcess
from pathlib import Path

from services.bus.oracles.remote import BusOracles, OnBus
from services.bus.serving import alone, settle
from services.bus.sessions import Reach, open_session
from tests.services.bus.routed import START, route, serve_oracle, wait_for

BACK = 10.0
"""[s] After a router has come back, until everybody has found it again."""


def _serve(endpoint: str, pipe: Pipe) -> None:
    """Main of the server's process: says which processes judge, and its own resident pages."""
    oracles = OnBus(Reach(endpoint))
    with (
        open_session(connect=endpoint, mode="client") as session,
        alone(session, ("b",), ("pr2",), oracles) as server,
    ):
        settle()
        pipe.send(None)
        while pipe.recv():
            pipe.send((server.pids(), int(Path("/proc/self/statm").read_text().split()[1])))


class Stage:
    """Router, server and oracles.

    Args:
        endpoint: Free.
        kinds: Of the oracles; where there are two of one, the other answers when one dies.

    Attributes:
        endpoint: Of the router.
        restarts: From when to when there was no router, or not everybody had found it again.
    """

    def __init__(self, endpoint: str, kinds: tuple[str, ...]) -> None:
        self._kinds = kinds
        self.endpoint, self.restarts = endpoint, list[tuple[float, float]]()
        self._context = mp.get_context("forkserver")
        self._context.set_forkserver_preload(["tests.services.bus.routed", "services.judging.judge"])
        self._lock = threading.Lock()
        self._router = self._started(route)
        wait_for(endpoint)
        self._oracles = [self._oracle(kind) for kind in kinds]
        self._next = cycle(range(len(kinds)))
        self._pipe, theirs = self._context.Pipe()
        self._server = self._started(_serve, theirs)
        self._pipe.recv()
        self._all_there()

    def pids(self) -> list[int]:
        """Processes that judge."""
        return self._told()[0]

    def resident(self) -> int:
        """[pages] Of the server's own process."""
        return self._told()[1]

    def kill_worker(self) -> None:
        """Processes that judge get a -9."""
        for pid in self.pids():
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)

    def kill_oracle(self) -> None:
        """One oracle after the other gets a -9, and another comes in its place."""
        with self._lock:
            index = next(self._next)
            _killed(self._oracles[index])
            self._oracles[index] = self._oracle(self._kinds[index])

    def restart_router(self) -> None:
        """The router gets a -9 and is started again at the same endpoint."""
        with self._lock:
            began = time.monotonic()
            self.restarts.append((began, float("inf")))
            _killed(self._router)
            self._router = self._started(route)
            wait_for(self.endpoint)
            self.restarts[-1] = (began, time.monotonic() + BACK)

    def is_excused(self, silence: tuple[float, float]) -> bool:
        """Whether nobody could be reached in that time."""
        began, ended = silence
        return any(began < back and ended > gone for gone, back in self.restarts)

    def close(self) -> None:
        """No process is left."""
        self._pipe.send(False)
        self._server.join(START)
        for each in (*self._oracles, self._router, self._server):
            _killed(each)

    def _told(self) -> tuple[list[int], int]:
        with self._lock:
            self._pipe.send(True)
            return self._pipe.recv()

    def _oracle(self, kind: str) -> BaseProcess:
        return self._started(serve_oracle, kind)

    def _started(self, main: object, *given: object) -> BaseProcess:
        process = self._context.Process(target=main, args=(self.endpoint, *given))  # pyright: ignore[reportArgumentType]  # callables
        process.start()
        return process

    def _all_there(self) -> None:
        with open_session(connect=self.endpoint, mode="client") as session:
            oracles, until = BusOracles.on(session), time.monotonic() + START
            while sum(len(each.instances()) for each in (oracles.causes, oracles.canperform)) < len(
                self._kinds
            ):
                assert time.monotonic() < until, "the oracles did not come"
                time.sleep(0.2)


def _killed(process: BaseProcess) -> None:
    process.kill()
    process.join()


@contextmanager
def staged(endpoint: str, kinds: tuple[str, ...]) -> Iterator[Stage]:
    """Everything is there until the context ends."""
    stage = Stage(endpoint, kinds)
    try:
        yield stage
    finally:
        stage.close()
