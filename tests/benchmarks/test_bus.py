"""Figures of the bus: round trips against the same question in process."""

import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import pytest

from services.app import Service, load
from services.bus.client import Connection
from services.bus.serving import alone
from services.bus.sessions import open_session
from tests.services.bus.conftest import free_endpoint

CLIENTS, EACH = 8, 250
ASK = "ASK { ?d a sdt:Drawer }"


@pytest.fixture(scope="module")
def endpoint() -> Iterator[str]:
    where = free_endpoint()
    with open_session(listen=where) as session, alone(session, ("b",), ("pr2",)):
        yield where


@pytest.fixture(scope="module")
def connection(endpoint: str) -> Iterator[Connection]:
    with open_session(connect=endpoint, mode="client") as session:
        yield Connection(session, "b")


@pytest.fixture(scope="module")
def here() -> Service:
    return load("b", ["pr2"])


@pytest.mark.benchmark(group="bus: satisfies")
def test_satisfies_in_process(benchmark, here: Service) -> None:
    benchmark(lambda: list(here.satisfies()))


@pytest.mark.benchmark(group="bus: satisfies")
def test_satisfies_over_the_bus(benchmark, connection: Connection) -> None:
    benchmark(connection.satisfies)


@pytest.mark.benchmark(group="bus: ask")
def test_ask_in_process(benchmark, here: Service) -> None:
    benchmark(lambda: here.query(ASK))


@pytest.mark.benchmark(group="bus: ask")
def test_ask_over_the_bus(benchmark, connection: Connection) -> None:
    benchmark(lambda: connection.ask(ASK))


@pytest.mark.benchmark(group="bus: 8 clients")
def test_requests_a_second_from_eight_clients(benchmark, endpoint: str) -> None:
    sessions = [open_session(connect=endpoint, mode="client") for _ in range(CLIENTS)]

    def ask(number: int) -> None:
        to = Connection(sessions[number], "b")
        for _ in range(EACH):
            assert to.ask(ASK)

    def all_at_once() -> float:
        began = time.perf_counter()
        with ThreadPoolExecutor(CLIENTS) as pool:
            list(pool.map(ask, range(CLIENTS)))
        return CLIENTS * EACH / (time.perf_counter() - began)

    rate = benchmark.pedantic(all_at_once, rounds=1)
    benchmark.extra_info["requests a second"] = rate
    for session in sessions:
        session.close()
