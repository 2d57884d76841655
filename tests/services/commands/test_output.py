"""What a command writes is whole or not there, and no letter of it stops the command."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from rich.console import Console

from sdt_kg.errors import InputError
from services.commands import terminal
from services.commands.show import print_rows
from services.store.output import write_file

FULL = Path("/dev/full")
needs_full = pytest.mark.skipif(not FULL.exists(), reason="no device that is always full")


def test_a_file_is_replaced_as_a_whole_and_nothing_is_left_beside_it(tmp_path: Path) -> None:
    path = tmp_path / "Öl.ttl"
    write_file(path, "Küche")
    write_file(path, b"1")
    assert path.read_bytes() == b"1"
    assert list(tmp_path.iterdir()) == [path]


def test_a_link_stays_a_link_and_a_pipe_a_pipe(tmp_path: Path) -> None:
    path, link, pipe = tmp_path / "a", tmp_path / "b", tmp_path / "c"
    path.write_text("before")
    link.symlink_to(path)
    write_file(link, "after")
    assert link.is_symlink()
    assert path.read_text() == "after"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    write_file(pipe, "through")
    assert os.read(reader, 100) == b"through"
    os.close(reader)


def test_what_cannot_be_written_is_said_and_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file or directory; make room"):
        write_file(tmp_path / "gone" / "a.ttl", "x")
    assert list(tmp_path.iterdir()) == []


@needs_full
def test_a_full_disk_is_said() -> None:
    with pytest.raises(InputError, match="cannot write /dev/full: no space left on device"):
        write_file(FULL, "x")


@needs_full
def test_an_answer_that_nobody_has_room_for_is_no_bug() -> None:
    words = [sys.executable, "-m", "services.cli", "containers", "b"]
    with FULL.open("wb") as full:
        done = subprocess.run(words, stdout=full, stderr=subprocess.PIPE, check=False)
    assert done.returncode == 2
    assert b"error: what was to be written cannot be: no space left on device" in done.stderr
    assert b"Traceback" not in done.stderr


def test_a_terminal_without_a_letter_gets_the_answer_all_the_same(tmp_path: Path) -> None:
    kitchen = tmp_path / "Küche.urdf"
    kitchen.write_text('<robot name="k"><link name="Tür"/></robot>', encoding="utf-8")
    words = [sys.executable, "-m", "services.cli", "containers"]
    ascii_only = {**os.environ, "PYTHONIOENCODING": "ascii"}
    told = subprocess.run([*words, str(kitchen), "--json"], env=ascii_only, capture_output=True, check=False)
    assert (told.returncode, json.loads(told.stdout)) == (0, [])
    gone = [*words, str(tmp_path / "Tür.urdf")]
    refused = subprocess.run(gone, env=ascii_only, capture_output=True, check=False)
    assert refused.returncode == 2
    assert b"error: no kitchen named" in refused.stderr


def test_names_of_columns_go_over_several_lines_before_a_table_does(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(terminal, "console", lambda: Console(width=24))
    print_rows([{"kitchen": "a", "not_certified": 1, "at": 2}], ("kitchen", "not_certified", "at"))
    lines = [line.rstrip() for line in capsys.readouterr().out.splitlines()]
    assert lines == ["         not_", "kitchen  certified  at", "a        1          2"]


@pytest.mark.parametrize(("width", "below"), [(60, False), (32, False), (31, True)])
def test_a_table_whose_words_do_not_fit_is_told_one_below_the_other(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], width: int, below: bool
) -> None:
    monkeypatch.setattr(terminal, "console", lambda: Console(width=width))
    rows = [{"name": "fridge_door", "why": "too far away", "at": 1.5}, {"name": "sink_area_left_drawer"}]
    print_rows(rows, ("name", "why", "at"))
    lines = [line.rstrip() for line in capsys.readouterr().out.splitlines()]
    if below:
        assert lines[:3] == ["name  fridge_door", "why   too far away", "at    1.5"]
        assert lines[4] == "name  sink_area_left_drawer"
    else:
        assert lines[0].split() == ["name", "why", "at"]
        assert lines[-1] == "sink_area_left_drawer"
    assert all(len(line) <= width for line in lines)
