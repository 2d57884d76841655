"""On a full disk a command says which file it cannot write; of the file nothing is left, or what was."""

import resource
import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from sdt_kg.errors import InputError, StoreRejectedError
from sdt_kg.motion import Motion
from services.commands.exits import Exit
from services.motions import write_motion
from services.store.files import opened
from services.sweep.parquet import parquet
from tests.services.conftest import Done

ROOM = 2**9
"""[bytes] More is not written to a file."""
WHY = "file too large; make room, or write to another place"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Where a file has little room."""
    # Python would cut what it imports meanwhile off there, and keep that for the next run.
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    before = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (ROOM, limits[1]))
    yield tmp_path
    resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    signal.signal(signal.SIGXFSZ, before)


@pytest.mark.parametrize("name", ["kitchen.trig", "kitchen.nq"])
def test_a_branch(sdt: Callable[..., Done], folder: Path, name: str) -> None:
    done = sdt("branch", "b", "move:iai_fridge_door=open", "-o", str(folder / name))
    assert done.code == Exit.BAD_INPUT
    assert done.err.endswith(f"error: cannot write {folder / name}: {WHY}\n")
    assert list(folder.iterdir()) == []


@pytest.mark.parametrize("name", ["motion.npz", "motion.json", "motion.csv"])
def test_a_motion(folder: Path, name: str) -> None:
    (folder / name).write_text("before")
    samples = np.random.default_rng(0).random((100, 1))
    motion = Motion("joint", np.arange(100.0), samples)
    with pytest.raises(InputError, match=f"{name}: {WHY}"):
        write_motion(folder / name, motion)
    assert [each.read_text() for each in folder.iterdir()] == ["before"]


def test_a_store(folder: Path) -> None:
    place = folder / "verdicts"
    with pytest.raises(
        StoreRejectedError, match="verdicts cannot be opened: File too large; make room there"
    ):
        opened(place)


def test_a_table_of_a_sweep(folder: Path) -> None:
    with pytest.raises(InputError, match=r"cannot write .*rows\.parquet: "), parquet(folder / "rows.parquet"):
        pass
    assert list(folder.iterdir()) == []


def test_a_table_where_nothing_can_be_written(tmp_path: Path) -> None:
    file = tmp_path / "gone" / "rows.parquet"
    with pytest.raises(InputError, match=r"cannot write .*rows\.parquet: "), parquet(file):
        pass
