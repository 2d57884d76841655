"""A Dask cluster that cannot judge says what it lacks; sweeps by one that can are in the soak."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from distributed import LocalCluster

from sdt_kg.errors import InputError, OracleUnavailableError
from services.sweep.executors import engines
from services.sweep.executors.engines import dask

# A cluster that is closed in its own process makes Dask warn.
pytestmark = pytest.mark.filterwarnings("ignore")


@pytest.fixture
def idle() -> Iterator[str]:
    """Address of a scheduler without workers."""
    how = {"n_workers": 0, "processes": False, "protocol": "tcp", "dashboard_address": None}
    cluster: Any = LocalCluster(**how)  # its types say that it may be a coroutine
    with cluster:
        yield cluster.scheduler_address


def test_a_scheduler_without_a_worker_says_how_to_start_one(idle: str) -> None:
    with pytest.raises(OracleUnavailableError) as refused, dask(idle):
        pass
    assert str(refused.value) == (
        f"the Dask scheduler at {idle} has no worker (dask worker {idle} --nthreads 1 starts one)"
    )


def test_where_nobody_can_judge_no_store_is_made(sdt, idle: str, tmp_path: Path) -> None:
    asked = ("sweep", "--kitchens", "b", "--robots", "pr2", "--dask", idle)
    done = sdt(*asked, "--save", str(tmp_path / "store"), "--parquet", str(tmp_path / "rows.parquet"))
    assert (done.code, list(tmp_path.iterdir())) == (4, [])
    assert "has no worker" in done.err
    assert "written at the end" in sdt(*asked, "--save", str(tmp_path / "store.trig")).err


def test_where_no_scheduler_answers_is_said_how_to_start_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(engines, "CONNECT", "0.2 s")
    said = r"no Dask scheduler answers at tcp://127\.0\.0\.1:1: .*\(dask scheduler starts one\)"
    with pytest.raises(OracleUnavailableError, match=said), dask("tcp://127.0.0.1:1"):
        pass


@pytest.mark.parametrize("address", ["127.0.0.1:8786", "tcp://127.0.0.1", "http://127.0.0.1:8786"])
def test_what_is_no_address_of_a_scheduler_is_refused(address: str) -> None:
    said = "is no address of a Dask scheduler; allowed: tcp://HOST:PORT"
    with pytest.raises(InputError, match=said), dask(address):
        pass
