"""Figures of the bus: round trips against the same question in process."""

import multiprocessing as mp
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.connection import Connection as Pipe
from typing import Any

import numpy as np
import pytest

from services.app import Service, load
from services.bus.client import Connection
from services.bus.serving import alone, settle
from services.bus.sessions import open_session
from tests.ports import free_endpoint

CLIENTS, EACH = 8, 250
ASK = "ASK { ?d a sdt:Drawer }"


ROUNDS = 1000


def serve(endpoint: str, pipe: Pipe) -> None:
    """Main of the server's process."""
    with open_session(listen=endpoint) as session, alone(session, ("b",), ("pr2",)):
        settle()
        pipe.send(None)
        pipe.recv()


@pytest.fixture(scope="module")
def endpoint() -> Iterator[str]:
    where, context = free_endpoint(), mp.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=serve, args=(where, theirs))
    process.start()
    ours.recv()
    yield where
    ours.send(None)
    process.join()


def timed(benchmark: Any, question: Callable[[], object]) -> None:
    """Median as the library tells it, and what 99 of 100 questions take at most."""
    benchmark.pedantic(question, rounds=ROUNDS, warmup_rounds=50)
    benchmark.extra_info["p99 [ms]"] = round(1000 * float(np.quantile(benchmark.stats.stats.data, 0.99)), 3)


@pytest.fixture(scope="module")
def connection(endpoint: str) -> Iterator[Connection]:
    with open_session(connect=endpoint, mode="client") as session:
        yield Connection(session, "b")


@pytest.fixture(scope="module")
def here() -> Service:
    return load("b", ["pr2"])


@pytest.mark.benchmark(group="bus: satisfies")
def test_satisfies_in_process(benchmark, here: Service) -> None:
    timed(benchmark, lambda: list(here.satisfies()))


@pytest.mark.benchmark(group="bus: satisfies")
def test_satisfies_over_the_bus(benchmark, connection: Connection) -> None:
    timed(benchmark, connection.satisfies)


@pytest.mark.benchmark(group="bus: ask")
def test_ask_in_process(benchmark, here: Service) -> None:
    timed(benchmark, lambda: here.query(ASK))


@pytest.mark.benchmark(group="bus: ask")
def test_ask_over_the_bus(benchmark, connection: Connection) -> None:
    timed(benchmark, lambda: connection.ask(ASK))


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

    rate = benchmark.pedantic(all_at_once, rounds=3)
    benchmark.extra_info["requests a second"] = rate
    for session in sessions:
        session.close()
