"""Files and directories: what was acknowledged survives a killed process, and two processes do not mix."""

import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pyoxigraph as ox
import pytest

from sdt_kg.errors import InputError, StoreRejectedError, StoreUnavailableError
from services.store.files import opened
from services.store.on_disk import JOURNAL, in_file, in_folder

WRITER = """
import itertools, sys
import pyoxigraph as ox
from pathlib import Path
from services.store import folder as tables
from services.store.on_disk import in_folder

folder, how = sys.argv[1:]
tables.BATCH = 5_000
store, p = in_folder(Path(folder)), ox.NamedNode("urn:p")

def quads(index, count):
    graph = ox.NamedNode(f"urn:g{index}")
    return (ox.Quad(ox.NamedNode(f"urn:s{n}"), p, ox.Literal(n), graph) for n in range(count))

for index in itertools.count():
    if how == "add":
        store.add(quads(index, 60))
    elif how == "replace":
        fresh = (ox.Quad(q.subject, p, ox.Literal(index), q.graph_name) for q in quads(0, 60))
        store.replace("urn:g0", fresh)
    else:
        store.add(quads(index, 200_000))
    print(index, flush=True)
"""
"""Writes graph after graph of 60 quads, or one graph again and again, or 200,000 quads at once."""


SOME_BATCHES = 1_000_000
"""[bytes] In the journal, when several batches of a long load are there."""


def written(folder: Path) -> int:
    """Bytes in a directory's journal."""
    journal = folder / JOURNAL
    return journal.stat().st_size if journal.exists() else 0


def killed_writer(folder: Path, how: str, seconds: float) -> int:
    """The last graph that was acknowledged by a process which is killed in the middle of its work."""
    command = [sys.executable, "-c", WRITER, str(folder), how]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as writer:
        assert writer.stdout is not None
        first = b"" if how == "bulk" else writer.stdout.readline()
        while how == "bulk" and written(folder) < SOME_BATCHES:
            time.sleep(0.01)
        time.sleep(seconds)
        assert writer.poll() is None, "it was done before it was killed"
        writer.send_signal(signal.SIGKILL)
        lines = (first + writer.stdout.read()).decode().splitlines()
    return int(lines[-1]) if lines else -1


@pytest.mark.parametrize("seconds", [0.03, 0.1, 0.25])
def test_a_verdict_that_was_acknowledged_survives_kill_9(tmp_path: Path, seconds: float) -> None:
    last = killed_writer(tmp_path / "store", "add", seconds)
    store = in_folder(tmp_path / "store")
    sizes = [len(store.graph(f"urn:g{index}")) for index in range(last + 2)]
    assert last >= 0
    assert sizes[: last + 1] == [60] * (last + 1)
    assert sizes[last + 1] in {0, 60}, "a verdict is there or is not"


def test_a_verdict_that_is_replaced_is_never_half_there_after_kill_9(tmp_path: Path) -> None:
    last = killed_writer(tmp_path / "store", "replace", 0.2)
    quads = in_folder(tmp_path / "store").graph("urn:g0")
    values = {quad.object for quad in quads}
    assert len(quads) == 60
    assert values in ({ox.Literal(last)}, {ox.Literal(last + 1)})


def test_kill_9_in_a_long_load_leaves_whole_batches_and_a_sound_store(tmp_path: Path) -> None:
    assert killed_writer(tmp_path / "store", "bulk", 0.1) == -1, "the load was not over"
    store = in_folder(tmp_path / "store")
    total = len(store.dump())
    assert total > 0
    assert total % 5_000 == 0
    store.add([ox.Quad(ox.NamedNode("urn:s"), ox.NamedNode("urn:p"), ox.Literal(1), ox.NamedNode("urn:new"))])
    assert len(store.graph("urn:new")) == 1


HOLDER = """
import sys
from services.store.files import opened

store = opened(sys.argv[1])
print("open", flush=True)
sys.stdin.readline()
store.close()
"""


@pytest.mark.parametrize("name", ["folder", "file.trig"])
def test_a_place_that_another_process_holds_is_refused_until_it_is_closed(tmp_path: Path, name: str) -> None:
    place = tmp_path / name
    command = [sys.executable, "-c", HOLDER, str(place)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stdin=subprocess.PIPE) as holder:
        assert holder.stdout is not None
        assert holder.stdin is not None
        assert holder.stdout.readline() == b"open\n"
        with pytest.raises(StoreUnavailableError, match="another process") as caught:
            opened(place)
        assert caught.value.place == str(place)
        holder.stdin.close()
        holder.wait()
    opened(place).close()


def test_a_file_is_as_it_was_when_its_process_is_killed(tmp_path: Path) -> None:
    path = tmp_path / "verdicts.nq"
    path.write_text('<urn:s> <urn:p> "1" <urn:g> .\n')
    command = [sys.executable, "-c", HOLDER, str(path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stdin=subprocess.PIPE) as holder:
        assert holder.stdout is not None
        assert holder.stdout.readline() == b"open\n"
        holder.kill()
    assert path.read_text() == '<urn:s> <urn:p> "1" <urn:g> .\n'
    store = in_file(path)
    assert len(store.graph("urn:g")) == 1
    store.close()
    assert [each.name for each in tmp_path.iterdir()] == ["verdicts.nq"]


@pytest.mark.parametrize(
    "left", [("LOCK", "LOG"), ("000001.dbtmp", "IDENTITY", "LOCK", "LOG", "MANIFEST-000001")]
)
def test_a_directory_whose_making_was_cut_off_becomes_a_store(tmp_path: Path, left: tuple[str, ...]) -> None:
    for name in left:
        (tmp_path / name).touch()
    store = in_folder(tmp_path)
    store.add([ox.Quad(*(ox.NamedNode(f"urn:{each}") for each in "spog"))])
    store.close()
    assert len(in_folder(tmp_path).graph("urn:g")) == 1


def damaged(folder: Path) -> None:
    in_folder(folder).close()
    (folder / "CURRENT").write_text("garbage")


BAD: dict[str, tuple[str, Callable[[Path], object], type[Exception], str]] = {
    "a folder of other things": (
        "folder", lambda path: (path.mkdir(), (path / "thesis.tex").touch()), InputError, "something else",
    ),
    "a damaged store": ("folder", damaged, StoreRejectedError, "damaged"),
    "a file where a folder should be": ("folder", lambda path: path.touch(), InputError, "something else"),
    "a file that is no RDF": ("x.trig", lambda path: path.write_text("{ no"), InputError, "not valid RDF"),
    "a folder that is not there": ("gone/x.trig", lambda path: None, InputError, "cannot write"),
    "an ending of something else": ("x.json", lambda path: None, InputError, "FILE.trig, FILE.nq"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_what_is_no_store_is_refused_and_left_alone(tmp_path: Path, name: str) -> None:
    at, prepare, error, said = BAD[name]
    prepare(tmp_path / at)
    before = sorted(str(each) for each in tmp_path.rglob("*"))
    with pytest.raises(error, match=said):
        opened(tmp_path / at)
    after = sorted(str(each) for each in tmp_path.rglob("*"))
    assert error is StoreRejectedError or after == before
