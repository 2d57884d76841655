"""Where no file can be written, a command says so before its work begins, and so it makes nothing."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from sdt_kg.errors import InputError
from services.commands.exits import Exit
from services.store.output import check_file, check_folder
from tests.services.conftest import Done

NOWHERE = "/proc/file"
"""The kernel lets nobody make files there."""
WORK = {
    "graph": ("graph", "gone", "-o", f"{NOWHERE}.ttl"),
    "motion": ("achieve", "--kitchen", "gone", "--robot", "pr2", "--task", "open", "--motion-out",
        f"{NOWHERE}.npz"),
    "certificate": ("achieve", "--kitchen", "gone", "--robot", "pr2", "--task", "open", "--certificate",
        NOWHERE),
    "motion of no robot": ("causes", "gone", "--task", "open", "--motion-out", f"{NOWHERE}.csv"),
    "table": ("table", "--kitchens", "gone", "--csv", NOWHERE),
    "motions of a table": ("table", "--kitchens", "gone", "--motions", NOWHERE),
    "rows of a sweep": ("sweep", "--kitchens", "gone", "--parquet", NOWHERE),
    "branch": ("branch", "gone", "move:door=open", "-o", f"{NOWHERE}.trig"),
    "history": ("branch", "gone", "move:door=open", "--history", f"{NOWHERE}.trig"),
    "patch": ("diff", "gone", "b", "--patch", NOWHERE),
    "patched": ("patch", "/dev/null", "gone", "-o", f"{NOWHERE}.trig"),
    "inferred": ("reason", "gone", "-o", f"{NOWHERE}.nq"),
    "learned": ("learn", "gone.csv", "--kitchen", "b", "--accept", "-o", f"{NOWHERE}.trig"),
    "ontology": ("ontology", "-o", NOWHERE),
    "robot": ("robot", "describe", __file__, "-o", f"{NOWHERE}.ttl"),
    "covers": ("codesign", "--kitchens", "gone", "--csv", NOWHERE),
    "grid": ("whatif", "--grid", "--kitchen", "gone", "--robot", "pr2", "--task", "open", "--csv", NOWHERE),
    "settings": ("config", "init", "-o", NOWHERE),
    "tour": ("tour", "--keep", NOWHERE),
    "spans": ("serve", "--kitchen", "gone", "--http", "127.0.0.1:0", "--spans", NOWHERE),
    "report": ("report", "feasibility", "-p", "kitchen=a", "-o", f"{NOWHERE}.html"),
    "figures of a report": ("report", "feasibility", "-p", "kitchen=a", "--assets", NOWHERE),
}  # fmt: skip


@pytest.mark.parametrize("name", WORK)
def test_it_is_said_before_the_work(
    sdt: Callable[..., Done], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.chdir(tmp_path)
    done = sdt(*WORK[name])
    assert (done.code, done.out) == (Exit.BAD_INPUT, "")
    assert f"error: cannot write {NOWHERE}" in done.err
    assert "make room, or write to another place" in done.err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("words", [("report", "feasibility", "-p", "kitchen=a"), ("config", "init")])
def test_of_a_name_that_nobody_typed_too(
    sdt: Callable[..., Done], monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...]
) -> None:
    monkeypatch.chdir("/proc")
    assert "error: cannot write " in sdt(*words).err


def test_looking_changes_nothing(tmp_path: Path) -> None:
    there, pipe = tmp_path / "there", tmp_path / "pipe"
    there.write_text("before")
    os.mkfifo(pipe)
    check_file(there)
    check_file(tmp_path / "new")
    check_file(pipe)  # nobody reads yet
    check_folder(tmp_path / "some" / "where")
    assert sorted(tmp_path.iterdir()) == [pipe, there]
    assert there.read_text() == "before"


def test_a_folder_below_a_file_is_none(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=r"cannot write .*/file/below: not a directory"):
        check_folder(tmp_path / "file" / "below")
