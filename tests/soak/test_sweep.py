"""A Dask cluster of several processes judges as one process does, also when a worker is killed."""

import os
import signal
from collections.abc import Iterator
from contextlib import closing

import pytest
from distributed import LocalCluster

from predicates.record.recall import nothing_stored
from services.sweep.cell import CellResult, Found
from services.sweep.executors.engines import dask
from services.sweep.plan import Axes, grid
from services.sweep.run import run
from services.sweep.worker import judge

pytestmark = [
    pytest.mark.oracle,
    # Workers that are killed, and a cluster that is closed in its own process, make Dask warn.
    pytest.mark.filterwarnings("ignore"),
]


@pytest.fixture(scope="module")
def cluster() -> Iterator[LocalCluster]:
    with LocalCluster(
        n_workers=2, threads_per_worker=2, processes=True, dashboard_address=None, host="127.0.0.1"
    ) as one:
        yield one


def iris(found: Iterator[Found]) -> dict[str, object]:
    return {
        each.cell.task: each.verdict["iri"] if isinstance(each, CellResult) else each.reason for each in found
    }


@pytest.fixture(scope="module")
def here() -> dict[str, object]:
    """Task → verdict, judged in this process."""
    return iris(map(judge, grid(["b"], ["pr2"], Axes(("close",))).cells))


def test_a_cluster_of_two_processes_gives_the_same_verdicts(
    cluster: LocalCluster, here: dict[str, object]
) -> None:
    with dask(cluster.scheduler_address) as engine:
        assert iris(run(grid(["b"], ["pr2"], Axes(("close",))).cells, engine, nothing_stored)) == here


def test_a_worker_that_is_killed_takes_no_case_with_it(
    cluster: LocalCluster, here: dict[str, object]
) -> None:
    with dask(cluster.scheduler_address) as engine:
        found = run(grid(["b"], ["pr2"], Axes(("close",))).cells, engine, nothing_stored)
        with closing(found):
            first = next(found)
            os.kill(next(iter(cluster.workers.values())).process.pid, signal.SIGKILL)
            rest = iris(found)
    assert {**iris(iter([first])), **rest} == here
