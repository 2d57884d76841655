"""A real SPARQL server on a free port, and verdicts that `law` really gave."""

import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from predicates.case import Case, Verdict
from predicates.law import law
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.physics.oracle import Kinematics
from tests.ports import free_port
from tests.small import small_twin
from tests.small.lift import Lift

OXIGRAPH = Path(sys.executable).with_name("oxigraph")
START_TIMEOUT = 20.0
"""[s] For a server to listen."""


@dataclass
class Server:
    """`oxigraph serve` over a directory or in memory; it may be killed and started again on the same port."""

    folder: Path | None
    port: int
    process: subprocess.Popen[bytes] | None = field(default=None)

    @property
    def address(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    def start(self, *options: str) -> None:
        place = [] if self.folder is None else ["-l", str(self.folder)]
        command = [str(OXIGRAPH), "serve", "-b", f"127.0.0.1:{self.port}", *place, *options]
        self.process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def wait(self) -> None:
        end = time.monotonic() + START_TIMEOUT
        while True:
            try:
                socket.create_connection(("127.0.0.1", self.port), timeout=1).close()
            except OSError:
                assert time.monotonic() < end, "the server does not start"
                time.sleep(0.02)
            else:
                return

    def seconds(self) -> float:
        """CPU time of the process [s], as finely as the kernel counts it."""
        assert self.process is not None, "started"
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def kill(self) -> None:
        if self.process is not None:
            self.process.kill()
            self.process.wait()
            self.process = None


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Server]:
    """A server of its own for each test."""
    made = Server(tmp_path / "served", free_port())
    made.start()
    try:
        made.wait()
        yield made
    finally:
        made.kill()


@pytest.fixture(scope="session")
def judged() -> tuple[tuple[Twin, ...], tuple[Verdict, ...]]:
    """Two small kitchens with two lifts: open() in both, close() in b with its drawer half open."""
    a, b = (small_twin(kitchen, ("pr2", "stretch")) for kitchen in ("a", "b"))
    half_open = b.at({b.container("top_drawer").joint: 0.25})
    cases = [Case(twin, task=Task(Verb.OPEN)) for twin in (a, b)] + [Case(half_open, task=Task(Verb.CLOSE))]
    return (a, b, half_open), tuple(each for case in cases for each in law(case, Kinematics(), Lift()))
