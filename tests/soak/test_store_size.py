"""Ten million quads: questions about one kitchen keep their rows, and stay as quick as with few.

It takes some ten gigabytes of memory and a quarter of an hour; SDT_SOAK_QUADS=1000000 asks for less.
"""

import os
import statistics
import time
from collections.abc import Callable
from itertools import islice
from pathlib import Path

import pyoxigraph as ox
import pytest

from predicates.case import Verdict
from sdt_kg.iri import model_iri
from sdt_kg.store import rows_of
from sdt_kg.twin import Twin
from services.store.embedded import EmbeddedStore
from tests.services.store.conftest import judged
from tests.services.store.multiplied import multiplied

__all__ = ["judged"]

SMALL = 100_000
LARGE = int(os.environ.get("SDT_SOAK_QUADS", "10000000"))
CHUNKS = 1_000
"""Pieces of text that are loaded at once."""

AS_FLAT = 10.0
"""Times as long as in the small store: a question that grows with the store takes a hundred times."""

QUERIES = sorted((Path(__file__).parents[2] / "ontology" / "queries").glob("cq*.rq"))
ABOUT_ONE = [
    query
    for query in QUERIES
    if "?environment" in query.read_text().partition("WHERE")[0] and "GROUP BY" not in query.read_text()
]


def filled(size: int, twins: tuple[Twin, ...], verdicts: tuple[Verdict, ...]) -> EmbeddedStore:
    held = ox.Store()
    pieces = multiplied(size, twins, verdicts)
    while chunk := b"".join(islice(pieces, CHUNKS)):
        held.bulk_load(chunk, format=ox.RdfFormat.N_QUADS)
    return EmbeddedStore(held, lambda _: None)


def seconds(ask: Callable[[], object]) -> float:
    """[s] Median of the CPU time of this thread."""
    times: list[float] = []
    for _ in range(15):
        began = time.thread_time()
        ask()
        times.append(time.thread_time() - began)
    return statistics.median(times)


@pytest.mark.slow
def test_questions_about_one_kitchen_are_flat(judged: tuple[tuple[Twin, ...], tuple[Verdict, ...]]) -> None:
    assert len(ABOUT_ONE) >= 5
    small, large = filled(SMALL, *judged), filled(LARGE, *judged)
    grown: dict[str, float] = {}
    for query in ABOUT_ONE:
        sparql = query.read_text()

        def ask(store: EmbeddedStore, text: str = sparql) -> list[dict[str, object]]:
            return rows_of(store.query(text, known={"environment": ox.NamedNode(model_iri("a"))}))[1]

        assert ask(large) == ask(small), query.stem
        took = [seconds(lambda of=store: ask(of)) for store in (small, large)]
        print(query.stem, *(f"{1000 * each:.2f} ms" for each in took))  # noqa: T201 - the figure of this test
        grown[query.stem] = took[1] / took[0]
    assert {name: ratio for name, ratio in grown.items() if ratio > AS_FLAT} == {}
