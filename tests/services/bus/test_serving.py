"""`sdt serve --bus` says that it serves when it does, and else why not, in one line."""

import signal
import socket
from collections.abc import Callable, Iterator

import pytest

from services.commands.exits import Exit
from tests.services.conftest import Done


@pytest.fixture
def taken() -> Iterator[str]:
    """An endpoint at which somebody else listens."""
    with socket.create_server(("127.0.0.1", 0)) as other:
        yield f"tcp/127.0.0.1:{other.getsockname()[1]}"


@pytest.mark.parametrize(
    ("endpoint", "why"),
    [
        ("foo", "'foo' is no endpoint; allowed: PROTOCOL/HOST:PORT"),
        ("tcp/", "'tcp/' is no endpoint; allowed: PROTOCOL/HOST:PORT"),
        ("tcp/127.0.0.1:99999", "cannot listen at tcp/127.0.0.1:99999: invalid port value"),
        ("taken", "Address already in use"),
    ],
)
def test_an_endpoint_where_it_cannot_listen_is_bad_input_and_nothing_is_announced(
    sdt: Callable[..., Done], taken: str, endpoint: str, why: str
) -> None:
    before = signal.getsignal(signal.SIGTERM)
    done = sdt("serve", "--http", "127.0.0.1:0", "--bus", taken if endpoint == "taken" else endpoint)
    assert signal.getsignal(signal.SIGTERM) is before
    (line,) = done.err.splitlines()
    assert (done.code, done.out) == (Exit.BAD_INPUT, "")
    assert line.startswith("error: ")
    assert why in line
