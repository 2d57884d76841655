"""Five hundred mixed requests while workers die and clients misbehave; `make soak` asks ten thousand."""

import contextlib
import os
import signal

import pytest

from services.bus.client import Connection
from services.bus.server import Server
from tests.services.bus.mixed import DRAWER, is_typed, run, scattered

pytestmark = pytest.mark.oracle


def test_every_request_ends_in_a_right_answer_or_a_typed_error(
    bus: tuple[str, Server], connection: Connection
) -> None:
    endpoint, server = bus
    task = f"open:{DRAWER}"
    (said,) = connection.achieve(task, "pr2").objects
    assert said["outcome"] == "certified"

    def kill() -> None:
        for pid in server.pids():
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)

    harm = scattered(500, {kill: 2})
    found = run(endpoint, 500, harm, {(task, 0): (said["iri"], said["outcome"])})
    assert sum(found.counts.values()) == 500
    assert not found.wrong
    assert all(is_typed(end) for _, end in found.counts)
    assert found.counts["select", "answer"] > 50
    assert found.counts["achieve", "answer"]
    assert connection.satisfies(), "the service lives on"
