"""`sdt router` and `sdt oracle` are stopped as `sdt serve` is."""

import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from services.commands.exits import Exit
from tests.ports import free_endpoint
from tests.services.http.test_interrupted import heard

SDT = (sys.executable, "-m", "services.cli")
STOPS = {
    signal.SIGINT: (Exit.INTERRUPTED, "interrupted"),
    signal.SIGTERM: (Exit.TERMINATED, "terminated"),
    signal.SIGHUP: (Exit.TERMINATED, "terminated"),
}
"""Signal → exit code, and the last line."""


@contextmanager
def started(*words: str) -> "Iterator[subprocess.Popen[str]]":
    """A command that has said that it is there."""
    with subprocess.Popen([*SDT, *words], stderr=subprocess.PIPE, text=True, preexec_fn=heard) as process:  # noqa: PLW1509
        try:
            assert process.stderr is not None
            assert " at tcp/" in process.stderr.readline()
            yield process
        finally:
            process.kill()


@pytest.fixture
def router() -> Iterator[str]:
    """Its endpoint."""
    endpoint = free_endpoint()
    with started("router", "--listen", endpoint):
        yield endpoint


@pytest.mark.parametrize("number", STOPS)
def test_a_router_ends_with_the_code_of_what_stopped_it(number: signal.Signals) -> None:
    with started("router", "--listen", free_endpoint()) as process:
        process.send_signal(number)
        said = process.communicate(timeout=60)[1]
    assert (process.returncode, said.splitlines()[-1]) == STOPS[number]


@pytest.mark.parametrize("number", STOPS)
def test_an_oracle_ends_with_the_code_of_what_stopped_it(router: str, number: signal.Signals) -> None:
    with started("oracle", "causes", "--connect", router) as process:
        process.send_signal(number)
        said = process.communicate(timeout=60)[1]
    assert (process.returncode, said.splitlines()[-1]) == STOPS[number]
