"""A hundred thousand, a million and ten million quads: the competency questions stay as quick as they were.

In memory and in a directory, each question about the one kitchen, container, … that its head names. It takes
three gigabytes of disk, eight of memory and a quarter of an hour; SDT_SOAK_QUADS=1000000 ends with a million.
"""

import os
import resource
import statistics
import time
from collections.abc import Iterator
from itertools import islice
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


def loaded(stores: dict[str, ox.Store], size: int) -> None:
    """Fill them with the same; tells the CPU time of each."""
    pieces, seconds = multiplied(size, *judged()), dict.fromkeys(stores, 0.0)
    while chunk := b"".join(islice(pieces, CHUNKS)):
        for where, store in stores.items():
            began = time.process_time()
            store.bulk_load(chunk, format=ox.RdfFormat.N_QUADS)
            seconds[where] += time.process_time() - began
    told = ", ".join(f"{where} {spent:.0f} s of CPU time" for where, spent in seconds.items())
    print(f"{len(next(iter(stores.values())))} quads: {told}")  # noqa: T201 - figure


def filled(folder: Path, size: int) -> dict[str, QuadStore]:
    """One in memory; one in a directory, closed and opened again, so that nothing of it is left in memory."""
    memory, tables = ox.Store(), ox.Store(str(folder))
    loaded({"memory": memory, "directory": tables}, size)
    tables.optimize()
    tables.flush()
    del tables
    return {"memory": EmbeddedStore(memory, lambda _: None), "directory": in_folder(folder)}


@pytest.fixture(scope="module")
def stores(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[int, dict[str, QuadStore]]]:
    folder = tmp_path_factory.mktemp("stores")
    held = {size: filled(folder / str(size), size) for size in SIZES}
    yield held
    for both in held.values():
        for store in both.values():
            store.close()


def asked(store: QuadStore, query: Path) -> tuple[list[Row], float]:
    """The answer, and the median of the CPU time of this thread [s]."""
    times: list[float] = []
    answer: list[Row] = []
    for _ in range(ROUNDS):
        began = time.thread_time()
        answer = rows_of(store.query(query.read_text(), known=known(query)))[1]
        times.append(time.thread_time() - began)
    return answer, statistics.median(times)


@pytest.mark.slow
@pytest.mark.parametrize("where", ["memory", "directory"])
def test_questions_about_one_are_flat(stores: dict[int, dict[str, QuadStore]], where: str) -> None:
    assert len(QUERIES) >= 28
    grown: dict[str, float] = {}
    print(f"{where}, {' '.join(f'{size:.0e}' for size in SIZES)} quads")  # noqa: T201 - head of the figures
    for query in QUERIES:
        answers, times = zip(*(asked(stores[size][where], query) for size in SIZES), strict=True)
        assert all(answer == answers[0] for answer in answers), query.stem
        print(f"{query.stem[:4]} {' '.join(f'{1e3 * each:.2f}' for each in times)} ms")  # noqa: T201 - figure
        grown[query.stem] = times[-1] / times[0]
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    print(f"median {statistics.median(grown.values()):.2f} times, {peak:.1f} GiB")  # noqa: T201 - figure
    assert {name: ratio for name, ratio in grown.items() if ratio > AS_FLAT} == {}
