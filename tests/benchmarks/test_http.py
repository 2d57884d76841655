"""Figures of the HTTP service over a loopback socket: `make bench`. Ratios hold, absolute times do not."""

import http.client
import itertools
import statistics
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from urllib.parse import urlencode

import pytest
import uvicorn

from services.http.app import create_app
from services.http.run import bound
from services.http.settings import Address, Settings
from services.http.world import World
from services.store.known import restricted
from services.store.workers import Limits, Workers, bulk
from tests.benchmarks.test_store import QUERIES, SIZES, known, text

Ask = Callable[[str], bytes]
ROUNDS = 10


class Preloaded(Workers):
    """Workers that begin with some quads."""

    quads = b""

    async def start(self, deltas=()):
        began = time.perf_counter()
        await super().start([bulk(self.quads), *deltas])
        self.seconds = time.perf_counter() - began
        return self


@pytest.fixture(scope="module", params=SIZES)
def service(request: pytest.FixtureRequest) -> Iterator[tuple[int, Ask, Preloaded]]:
    workers = Preloaded(2, Limits(seconds=60))
    workers.quads = text(request.param)
    listening = bound(Address("127.0.0.1", 0))
    app = create_app(World({}, workers), Settings())
    server = uvicorn.Server(uvicorn.Config(app, log_level="warning", access_log=False))
    thread = threading.Thread(target=server.run, args=([listening],))
    thread.start()
    while not server.started:
        time.sleep(0.05)
    connection = http.client.HTTPConnection("127.0.0.1", listening.getsockname()[1])

    def ask(query: str) -> bytes:
        connection.request("GET", "/sparql?" + urlencode({"query": query}))
        answer = connection.getresponse()
        body = answer.read()
        assert answer.status == 200, body
        return body

    yield request.param, ask, workers
    connection.close()
    server.should_exit = True
    thread.join()


def test_start_with_that_many_quads(benchmark, service) -> None:
    """Loading, merging into the default graph and forking two workers [quads/s], as extra_info."""
    size, ask, workers = service
    benchmark.extra_info["quads_per_second"] = round(size / workers.seconds)
    benchmark(ask, "ASK {}")


@pytest.mark.parametrize("query", QUERIES, ids=lambda query: query.stem[:4])
def test_competency_query_over_loopback(benchmark, service, query) -> None:
    _, ask, _ = service
    sparql = restricted(query.read_text(), known(query))
    benchmark.pedantic(ask, (sparql,), rounds=ROUNDS, warmup_rounds=2)


def test_first_time_that_a_query_with_from_is_asked(benchmark, service) -> None:
    """Each text is new, so that it is parsed by rdflib too."""
    _, ask, _ = service
    texts = itertools.count()
    benchmark.pedantic(
        lambda: ask(f"SELECT ?g {{ GRAPH ?g {{ ?s law:outcome ?from }} }} LIMIT 1 # service {next(texts)}"),
        rounds=ROUNDS,
    )


def test_median_of_the_competency_set(service, benchmark) -> None:
    """Of each question: wall time, and CPU time of client, server and workers together [ms], as extra_info.

    On a shared machine the CPU time is what can be compared.
    """
    size, ask, workers = service
    wall, cpu = {}, {}
    for query in QUERIES:
        sparql = restricted(query.read_text(), known(query))
        ask(sparql)
        times = [_timed(ask, sparql, workers) for _ in range(5)]
        wall[query.stem[:4]], cpu[query.stem[:4]] = map(statistics.median, zip(*times, strict=True))
    slowest = sorted(cpu, key=cpu.__getitem__)[-5:]
    benchmark.extra_info |= {
        "quads": size,
        "median_wall_ms": round(statistics.median(wall.values()), 2),
        "median_cpu_ms": round(statistics.median(cpu.values()), 2),
        "slowest_cpu_ms": {name: round(cpu[name], 1) for name in slowest},
    }
    benchmark.pedantic(ask, ("ASK {}",), rounds=ROUNDS)


def _timed(ask: Ask, sparql: str, workers: Preloaded) -> tuple[float, float]:
    """Wall and CPU time of a question [ms]."""
    before, began = time.process_time() + _used(workers), time.perf_counter()
    ask(sparql)
    seconds = time.perf_counter() - began
    return 1e3 * seconds, 1e3 * (time.process_time() + _used(workers) - before)


def _used(workers: Preloaded) -> float:
    """CPU time of the workers [s], as finely as the scheduler counts it."""
    paths = [path for pid in workers.pids for path in Path(f"/proc/{pid}/task").glob("*/schedstat")]
    return sum(int(path.read_text().split()[0]) for path in paths) / 1e9
