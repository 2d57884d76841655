"""A hundred thousand, a million and ten million quads: the competency questions stay as quick as they were.

In memory and in a directory, each question about the one kitchen, container, … that its head names. It takes
three gigabytes of disk, eight of memory and a quarter of an hour; SDT_SOAK_QUADS=1000000 ends with a million.
"""

import os
import resource
import statistics
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from itertools import islice
from multiprocessing import get_context
from pathlib import Path

import pyoxigraph as ox
import pytest

from sdt_kg.store import Row, rows_of
from services.store.embedded import EmbeddedStore
from services.store.on_disk import in_folder
from services.store.quads import QuadStore
from tests.benchmarks.test_store import QUERIES, judged, known
from tests.services.store.multiplied import multiplied

LARGEST = int(os.environ.get("SDT_SOAK_QUADS", "10000000"))
SIZES = sorted({size for size in (100_000, 1_000_000) if size < LARGEST} | {LARGEST})
CHUNKS = 1_000
"""Pieces of text that are loaded at once."""

ROUNDS = 15
AS_FLAT = 5.0
"""Times as long as in the smallest store: a question that grows with the store takes a hundred times."""


def loaded(store: ox.Store, size: int) -> None:
    """Fill it; tells the CPU time of that."""
    pieces, seconds = multiplied(size, *judged()), 0.0
    while chunk := b"".join(islice(pieces, CHUNKS)):
        began = time.process_time()
        store.bulk_load(chunk, format=ox.RdfFormat.N_QUADS)
        seconds += time.process_time() - began
    print(f"{len(store)} quads: {seconds:.0f} s of CPU time", flush=True)  # noqa: T201 - figure


def on_disk(folder: Path, size: int) -> None:
    tables = ox.Store(str(folder))
    loaded(tables, size)
    tables.optimize()
    tables.flush()


def in_a_directory(folder: Path, size: int) -> QuadStore:
    """Filled by another process: what loading leaves of a heap makes each question allocate for longer."""
    with ProcessPoolExecutor(1, get_context("spawn")) as filling:
        filling.submit(on_disk, folder, size).result()
    return in_folder(folder)


def in_this_process(_: Path, size: int) -> QuadStore:
    memory = ox.Store()
    loaded(memory, size)
    return EmbeddedStore(memory)


@pytest.fixture(scope="module", params=[in_a_directory, in_this_process], ids=["directory", "memory"])
def stores(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[dict[int, QuadStore]]:
    """One of each size; in a directory first, since beside large ones in memory it takes twice as long."""
    folder = tmp_path_factory.mktemp("stores")
    held = {size: request.param(folder / str(size), size) for size in SIZES}
    yield held
    for store in held.values():
        store.close()


def asked(store: QuadStore, query: Path) -> tuple[list[Row], float]:
    """The answer, and the median of the CPU time of this thread [s]."""
    times: list[float] = []
    answer: list[Row] = []
    text, about = query.read_text(), known(query)
    for _ in range(ROUNDS):
        began = time.thread_time()
        answer = rows_of(store.query(text, known=about))[1]
        times.append(time.thread_time() - began)
    return answer, statistics.median(times)


@pytest.mark.slow
def test_questions_about_one_are_flat(stores: dict[int, QuadStore]) -> None:
    assert len(QUERIES) >= 28
    grown: dict[str, float] = {}
    print(" ".join(f"{size:.0e}" for size in SIZES), "quads")  # noqa: T201 - head of the figures
    for query in QUERIES:
        answers, times = zip(*(asked(stores[size], query) for size in SIZES), strict=True)
        assert all(answer == answers[0] for answer in answers), query.stem
        print(f"{query.stem[:4]} {' '.join(f'{1e3 * each:.2f}' for each in times)} ms")  # noqa: T201 - figure
        grown[query.stem] = times[-1] / times[0]
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    print(f"median {statistics.median(grown.values()):.2f} times, {peak:.1f} GiB")  # noqa: T201 - figure
    assert {name: ratio for name, ratio in grown.items() if ratio > AS_FLAT} == {}
