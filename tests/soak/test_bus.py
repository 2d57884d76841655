"""Ten thousand mixed requests with faults: right or typed, never long after the deadline, memory flat."""

import multiprocessing as mp
import threading
from collections.abc import Iterator
from multiprocessing.connection import Connection as Pipe
from pathlib import Path

import numpy as np
import pytest

from services.bus.client import Connection
from services.bus.serving import alone
from services.bus.sessions import open_session
from tests.services.bus.conftest import free_endpoint
from tests.services.bus.mixed import is_typed, run

pytestmark = pytest.mark.oracle

GROWTH = 1.05
"""[1] Of the server's own memory, from the first thousand requests to the last."""
SETTLING = 500
"""Small questions before memory is read: Zenoh's buffers of 16 MiB requests are given back late."""


def _serve(endpoint: str, pipe: Pipe) -> None:
    """Main of the server's process: says which processes judge, and its own resident pages."""
    with open_session(listen=endpoint) as session, alone(session, ("b",), ("pr2",)) as server:
        pipe.send(None)
        while pipe.recv():
            pipe.send((server.pids(), int(Path("/proc/self/statm").read_text().split()[1])))


class Far:
    """The server in its process."""

    def __init__(self, pipe: Pipe) -> None:
        self._pipe, self._lock = pipe, threading.Lock()

    def pids(self) -> list[int]:
        """Processes that judge."""
        return self._asked()[0]

    def resident(self) -> int:
        """[pages] Of the server's own process."""
        return self._asked()[1]

    def _asked(self) -> tuple[list[int], int]:
        with self._lock:
            self._pipe.send(True)
            return self._pipe.recv()


@pytest.fixture(scope="module")
def server() -> Iterator[tuple[str, Far]]:
    endpoint = free_endpoint()
    context = mp.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=_serve, args=(endpoint, theirs))
    process.start()
    ours.recv()
    yield endpoint, Far(ours)
    ours.send(False)
    process.join()


def _settled(endpoint: str, far: Far) -> int:
    with open_session(connect=endpoint, mode="client") as session:
        for _ in range(SETTLING):
            assert Connection(session, "b").ask("ASK { ?d a sdt:Door }")
    return far.resident()


def test_ten_thousand_mixed_requests(server: tuple[str, Far]) -> None:
    endpoint, far = server
    first = run(endpoint, far, 1000, kills=4)
    before = _settled(endpoint, far)
    rest = run(endpoint, far, 9000, kills=30, seed=1)
    for found in (first, rest):
        assert not found.wrong
        assert all(is_typed(end) for _, end in found.counts)
    assert _settled(endpoint, far) < GROWTH * before
    late = np.array(first.late + rest.late)
    assert late.max() < 1.0
    assert np.quantile(late, 0.999) < 0.1
