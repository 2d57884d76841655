"""Ten million quads in a directory: competency questions about one kitchen stay as quick as with few.

It takes some three gigabytes of disk and a quarter of an hour; SDT_SOAK_QUADS=1000000 asks for less.
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
from services.store.folder import FolderStore
from services.store.on_disk import in_folder
from tests.benchmarks.test_store import QUERIES, judged, known
from tests.services.store.multiplied import multiplied

SMALL = 100_000
LARGE = int(os.environ.get("SDT_SOAK_QUADS", "10000000"))
CHUNKS = 1_000
"""Pieces of text that are loaded at once."""

ABOUT_ONE = [query for query in QUERIES if known(query)]

AS_FLAT = 10.0
"""Times as long as in the small store: a question that grows with the store takes a hundred times."""


def filled(folder: Path, size: int) -> FolderStore:
    """A store in a directory, closed and opened again, so that nothing is left in memory."""
    held, began = ox.Store(str(folder)), time.process_time()
    pieces = multiplied(size, *judged())
    while chunk := b"".join(islice(pieces, CHUNKS)):
        held.bulk_load(chunk, format=ox.RdfFormat.N_QUADS)
    held.flush()
    held.optimize()
    seconds = time.process_time() - began
    print(f"{len(held)} quads in {seconds:.0f} s of CPU time, with what makes them")  # noqa: T201 - figure
    del held
    return in_folder(folder)


@pytest.fixture(scope="module")
def stores(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[FolderStore, FolderStore]]:
    folder = tmp_path_factory.mktemp("stores")
    small, large = filled(folder / "small", SMALL), filled(folder / "large", LARGE)
    yield small, large
    small.close()
    large.close()


def asked(store: FolderStore, query: Path) -> tuple[list[Row], float]:
    """The answer, and the median of the CPU time of this thread [s]."""
    times: list[float] = []
    answer: list[Row] = []
    for _ in range(15):
        began = time.thread_time()
        answer = rows_of(store.query(query.read_text(), known=known(query)))[1]
        times.append(time.thread_time() - began)
    return answer, statistics.median(times)


@pytest.mark.slow
def test_questions_about_one_are_flat(stores: tuple[FolderStore, FolderStore]) -> None:
    assert len(ABOUT_ONE) >= 20
    grown: dict[str, float] = {}
    for query in ABOUT_ONE:
        (few, before), (many, after) = (asked(store, query) for store in stores)
        assert many == few, query.stem
        print(f"{query.stem} {1e3 * before:.2f} ms {1e3 * after:.2f} ms")  # noqa: T201 - the figure of this test
        grown[query.stem] = after / before
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    print(f"median {statistics.median(grown.values()):.2f} times, {peak:.1f} GiB")  # noqa: T201 - figure
    assert {name: ratio for name, ratio in grown.items() if ratio > AS_FLAT} == {}
