"""Ten thousand mixed requests with faults: right or typed, never long after the deadline, memory flat."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from services.bus.server import Server
from services.bus.serving import alone
from services.bus.sessions import open_session
from tests.services.bus.conftest import free_endpoint
from tests.services.bus.mixed import is_typed, run

pytestmark = pytest.mark.oracle

GROWTH = 1.05
"""[1] Of the server's own memory, from the first thousand requests to the last."""


@pytest.fixture(scope="module")
def server() -> Iterator[tuple[str, Server]]:
    endpoint = free_endpoint()
    with (
        open_session(listen=endpoint) as session,
        alone(session, ("b",), ("pr2",)) as one,
    ):
        yield endpoint, one


def _resident() -> int:
    """[pages] Of this process, in which the server runs."""
    return int(Path("/proc/self/statm").read_text().split()[1])


def test_ten_thousand_mixed_requests(server: tuple[str, Server]) -> None:
    endpoint, one = server
    first = run(endpoint, one, 1000, kills=4)
    before = _resident()
    rest = run(endpoint, one, 9000, kills=30, seed=1)
    for found in (first, rest):
        assert not found.wrong
        assert all(is_typed(end) for _, end in found.counts)
    late = np.array(first.late + rest.late)
    assert late.max() < 1.0
    assert np.quantile(late, 0.999) < 0.1
    assert _resident() < GROWTH * before
