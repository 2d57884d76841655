"""What a recheck looks at: all that was acknowledged, wherever it is kept."""

import shutil
from pathlib import Path

from services.embodiment.recheck import Saved
from services.store.files import SavedVerdicts
from services.store.on_disk import JOURNAL
from tests.services.store.conftest import Server
from tests.services.store.test_every_store import Judged


def test_what_a_killed_process_left_in_the_journal_is_looked_at(judged: Judged, tmp_path: Path) -> None:
    place, left = tmp_path / "kept", tmp_path / "left"
    with SavedVerdicts(place) as saved:
        for verdict in judged[1]:
            saved.add(verdict)
        shutil.copytree(place, left)  # as it lies there when the process is killed
        held = Saved(place)
        assert f"{JOURNAL} is not looked at: the store {place} is open in another process" in held.left_out
    assert (left / JOURNAL).stat().st_size
    found = Saved(left)
    assert found.left_out == ""
    assert {each.iri for each in found.entries()} == {each.iri for each in judged[1]}


def test_a_server_is_looked_at(server: Server, judged: Judged) -> None:
    with SavedVerdicts(server.address) as saved:
        for verdict in judged[1]:
            saved.add(verdict)
    entries = list(Saved(server.address).entries())
    assert {each.iri for each in entries} == {each.iri for each in judged[1]}
    assert not any(each.damage for each in entries)
