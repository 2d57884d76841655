"""A directory's journal: what was acknowledged is there, also after a process that was killed."""

import gc
import resource
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pyoxigraph as ox
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sdt_kg.errors import StoreRejectedError
from services.store import folder as folders
from services.store.embedded import EmbeddedStore
from services.store.folder import FolderStore
from services.store.journal import Entry, Journal
from services.store.on_disk import JOURNAL, in_file, in_folder
from tests.services.store.test_every_store import LITERALS

GRAPHS = [f"https://example.org/g{index}" for index in range(3)]
Step = tuple[str, str, list[ox.Literal]]


def quads(graph: str, literals: list[ox.Literal]) -> list[ox.Quad]:
    about = ox.NamedNode("https://example.org/s")
    return [ox.Quad(about, about, each, ox.NamedNode(graph)) for each in literals]


class Place:
    """Tables and a journal, which outlive a process that is killed: here, a store that is forgotten."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / JOURNAL
        self._tables = ox.Store()
        self.opened()

    def opened(self) -> FolderStore:
        self._journal = Journal(self.path)
        self.store = FolderStore(self._journal.path.parent, self._tables, self._journal)
        return self.store

    def killed(self) -> FolderStore:
        self._journal.close()
        return self.opened()


STEPS = st.lists(
    st.tuples(
        st.sampled_from(["add", "replace", "drop", "read", "dump", "die"]),
        st.sampled_from(GRAPHS),
        st.lists(LITERALS, max_size=6),
    ),
    max_size=12,
)


@settings(
    max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture], database=None
)
@given(steps=STEPS)
@pytest.mark.parametrize(("few", "most"), [(10_000, 50_000), (1, 8)])
def test_a_directory_is_a_store_in_memory_that_also_survives(
    tmp_path_factory: pytest.TempPathFactory,
    monkeypatch: pytest.MonkeyPatch,
    steps: list[Step],
    few: int,
    most: int,
) -> None:
    monkeypatch.setattr(folders, "FEW", few)
    monkeypatch.setattr(folders, "MOST", most)
    place, memory = Place(tmp_path_factory.mktemp("store")), EmbeddedStore(ox.Store())
    for what, graph, literals in steps:
        if what == "die":
            place.killed()
        elif what == "read":
            assert (graph in place.store) == (graph in memory)
            assert set(place.store.graph(graph)) == set(memory.graph(graph))
        elif what == "dump":
            assert set(place.store.dump()) == set(memory.dump())
        else:
            for store in (place.store, memory):
                _do(store, what, graph, literals)
    place.store.close()
    assert not place.path.exists()
    assert set(place.opened().dump()) == set(memory.dump())


def _do(store: object, what: str, graph: str, literals: list[ox.Literal]) -> None:
    made = quads(graph, literals)
    arguments = {"add": (made,), "replace": (graph, made), "drop": (graph,)}[what]
    getattr(store, what)(*arguments)


FIRST, SECOND = (Entry(ox.NamedNode(graph), quads(graph, [ox.Literal("ö\n")])) for graph in GRAPHS[:2])


def test_an_entry_that_was_cut_anywhere_is_not_there_and_the_next_one_is(tmp_path: Path) -> None:
    place = Place(tmp_path)
    place.store.replace(GRAPHS[0], FIRST.quads)
    whole = place.path.stat().st_size
    place.store.replace(GRAPHS[1], SECOND.quads)
    text = place.path.read_bytes()
    for end in range(whole, len(text)):
        place.path.write_bytes(text[:end])
        assert list(Journal(place.path).entries()) == [FIRST], end
    assert set(place.killed().dump()) == set(FIRST.quads)
    place.store.add(SECOND.quads)
    assert set(place.killed().dump()) == {*FIRST.quads, *SECOND.quads}


@pytest.mark.parametrize(
    "damage",
    [
        lambda text: b"\0" * len(text),
        lambda text: text.replace(b"\xc3", b"\xc4"),
        lambda text: text[:1] + text,
    ],
)
def test_a_journal_that_was_changed_is_refused_and_left_alone(
    tmp_path: Path, damage: Callable[[bytes], bytes]
) -> None:
    folder = tmp_path / "store"
    in_folder(folder).close()
    journal = Journal(folder / JOURNAL)
    journal.add(FIRST)
    journal.close()
    (folder / JOURNAL).write_bytes(damage((folder / JOURNAL).read_bytes()))
    before = (folder / JOURNAL).read_bytes()
    with pytest.raises(StoreRejectedError, match="is damaged at byte 0; take a backup"):
        in_folder(folder)
    assert (folder / JOURNAL).read_bytes() == before


@contextmanager
def files_of_at_most(size: int) -> Iterator[None]:
    """What is written beyond so many bytes of a file fails, as on a full disk."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_tables_that_cannot_grow_are_said_and_nothing_acknowledged_is_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(folders, "MOST", 50)
    folder = tmp_path / "store"
    store, written = in_folder(folder), list[ox.Quad]()
    with files_of_at_most(100_000), pytest.raises(StoreRejectedError, match="what its journal has"):
        fill(store, written)
    for what in ("dump", "close"):
        with pytest.raises(StoreRejectedError, match="make room"):
            getattr(store, what)()
    del store
    gc.collect()  # what was raised may hold it still
    again = in_folder(folder)
    assert len(written) > 100
    assert set(written) <= set(again.dump())
    again.close()


def fill(store: FolderStore, written: list[ox.Quad]) -> None:
    """Add and add; what was acknowledged is in the list."""
    for number in range(10_000):
        fresh = quads(
            f"https://example.org/g{number}", [ox.Literal(f"{number} {index}") for index in range(10)]
        )
        store.add(fresh)
        written += fresh


def test_a_file_for_which_there_is_no_room_is_as_it_was(tmp_path: Path) -> None:
    path = tmp_path / "x.nq"
    path.write_text('<urn:s> <urn:p> "1" <urn:g> .\n')
    store = in_file(path)
    store.add(FIRST.quads)
    with files_of_at_most(10), pytest.raises(StoreRejectedError, match="as it was before; make room"):
        store.close()
    assert [each.name for each in tmp_path.iterdir()] == ["x.nq"]
    assert path.read_text() == '<urn:s> <urn:p> "1" <urn:g> .\n'


def test_what_does_not_fit_on_the_disk_is_not_acknowledged_and_harms_nothing(tmp_path: Path) -> None:
    place = Place(tmp_path)
    place.store.add(FIRST.quads)
    size = place.path.stat().st_size
    with files_of_at_most(size + 20), pytest.raises(StoreRejectedError, match="cannot be written"):
        place.store.add(SECOND.quads)
    assert place.path.stat().st_size == size
    more = quads(GRAPHS[2], [ox.Literal(3)])
    place.store.add(more)
    assert set(place.killed().dump()) == {*FIRST.quads, *more}


def test_a_directory_that_is_gone_takes_nothing_and_says_so(tmp_path: Path) -> None:
    place = tmp_path / "store"
    store = in_folder(place)
    shutil.rmtree(place)
    with pytest.raises(StoreRejectedError, match="cannot be written: No such file or directory"):
        store.add(quads(GRAPHS[0], [ox.Literal("one")]))
