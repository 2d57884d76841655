"""A server for kitchen B and a router with oracles, each started once."""

import socket
from collections.abc import Iterator

import pytest
import zenoh

from services.bus.client import Connection
from services.bus.server import Server
from services.bus.serving import alone
from services.bus.sessions import open_session


def free_endpoint() -> str:
    """An endpoint on loopback where nobody listens."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return f"tcp/127.0.0.1:{probe.getsockname()[1]}"


@pytest.fixture(scope="session")
def bus() -> Iterator[tuple[str, Server]]:
    """Endpoint and server of kitchen B with PR2, one worker."""
    endpoint = free_endpoint()
    session = open_session(listen=endpoint)
    with alone(session, ("b",), ("pr2",)) as server:
        yield endpoint, server
    session.close()


@pytest.fixture
def session(bus: tuple[str, Server]) -> Iterator[zenoh.Session]:
    """A plain Zenoh session of a client."""
    opened = open_session(connect=bus[0], mode="client")
    yield opened
    opened.close()


@pytest.fixture
def connection(session: zenoh.Session) -> Connection:
    """Kitchen B on the bus."""
    return Connection(session, "b", deadline=120.0)
