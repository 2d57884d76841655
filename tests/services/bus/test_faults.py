"""Five hundred mixed requests while workers die and clients misbehave; `make soak` asks ten thousand."""

import pytest

from services.bus.client import Connection
from services.bus.server import Server
from tests.services.bus.mixed import is_typed, run

pytestmark = pytest.mark.oracle


def test_every_request_ends_in_a_right_answer_or_a_typed_error(
    bus: tuple[str, Server], connection: Connection
) -> None:
    endpoint, server = bus
    found = run(endpoint, server, 500, kills=2)
    assert sum(found.counts.values()) == 500
    assert not found.wrong
    assert all(is_typed(end) for _, end in found.counts)
    assert found.counts["select", "answer"] > 50
    assert connection.satisfies(), "the service lives on"
