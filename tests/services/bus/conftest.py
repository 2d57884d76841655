"""A server for kitchen B and a router with oracles, each started once."""

from collections.abc import Iterator

import pytest
import zenoh

from predicates.can_perform import can_perform
from predicates.case import Case
from services.app import Service, load
from services.bus.client import Connection
from services.bus.oracles.codec import Plain
from services.bus.server import Server
from services.bus.serving import alone
from services.bus.sessions import open_session
from tests.ports import free_endpoint
from tests.services.bus.replies import DRAWER, FREE, case_of, sent


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


@pytest.fixture(scope="session")
def here() -> Service:
    """Kitchen B with PR2, in this process."""
    return load("b", ["pr2"], policy=FREE)


@pytest.fixture(scope="session")
def asked(here: Service) -> tuple[Case, Plain]:
    """A case, and what an oracle rightly answers."""
    case = case_of(here, DRAWER)
    (answer,) = can_perform(case, here.embodiment)
    assert answer.holds
    return case, sent(answer)
