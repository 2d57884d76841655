"""Stores that cannot be written: what only reads them works and leaves them alone, what writes says so."""

import os
import shutil
from pathlib import Path

import pytest

from sdt_kg.errors import InputError, StoreRejectedError
from services.embodiment.recheck import Saved
from services.store.files import SavedVerdicts, opened, query_saved, readable
from services.store.on_disk import JOURNAL
from tests.services.store.test_every_store import Judged

COUNT = "SELECT (COUNT(*) AS ?n) { ?v a law:Verdict }"


@pytest.fixture
def unwritable(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of no file the system says that it may be written: root, whom it lets do anything, runs tests, too."""
    monkeypatch.setattr(os, "access", lambda path, mode: mode != os.W_OK)


def content(folder: Path) -> dict[str, tuple[bytes, int]]:
    return {each.name: (each.read_bytes(), each.stat().st_mtime_ns) for each in folder.iterdir()}


@pytest.mark.parametrize("killed", [False, True], ids=["closed", "killed"])
def test_a_directory_is_read_to_its_end_and_left_as_it_is(
    judged: Judged, tmp_path: Path, unwritable: None, killed: bool
) -> None:
    place, left = tmp_path / "kept", tmp_path / "left"
    with SavedVerdicts(place) as saved:
        for verdict in judged[1]:
            saved.add(verdict)
        if killed:
            shutil.copytree(place, left)  # as it lies there when the process is killed
    if not killed:
        shutil.copytree(place, left)
    assert (left / JOURNAL).exists() is killed
    before = content(left)
    assert query_saved(left, COUNT) == (["n"], [{"n": len(judged[1])}])
    store = readable(left)
    with pytest.raises(StoreRejectedError, match="can only be read"):
        store.drop("https://example.org/id/graph/verdict/1")
    store.close()
    found = Saved(left)
    assert {each.iri for each in found.entries()} == {each.iri for each in judged[1]}
    assert found.left_out == ""
    assert content(left) == before


def test_a_file_that_can_only_be_read_is_not_replaced(tmp_path: Path, unwritable: None) -> None:
    file = tmp_path / "kept.nq"
    file.write_bytes(b"")
    with pytest.raises(InputError, match="can only be read"):
        opened(file)
    assert [each.name for each in tmp_path.iterdir()] == ["kept.nq"]
    assert query_saved(file, COUNT) == (["n"], [{"n": 0}])
