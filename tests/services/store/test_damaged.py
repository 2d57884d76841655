"""A record that was changed in its store: told, set aside as text, and the case judged anew."""

import logging
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import pyoxigraph as ox
import pytest

from predicates.case import Diagnosis, Kind, Outcome, Verdict
from predicates.record import to_record
from sdt_kg.errors import StoreRejectedError
from sdt_kg.iri import LAW
from services.embodiment.recheck import Saved
from services.store.files import SavedVerdicts, opened, query_saved
from services.store.records import all_recalled, graph_of
from tests.services.store.test_every_store import Judged, place

__all__ = ["place"]
ASIDE = "SELECT ?v ?text { ?v law:setAside ?text }"
OUTCOMES = "SELECT ?outcome { ?v law:outcome ?outcome }"
TABLE = 10_000
"""[bytes] A table of quads has more; one of what RocksDB itself has to remember is read at the opening."""


def changed(saved: SavedVerdicts, verdict: Verdict) -> set[ox.Quad]:
    """What stands there now: a note was added by hand."""
    graph = ox.NamedNode(graph_of(verdict.iri))
    note = ox.Quad(ox.NamedNode(verdict.iri), ox.NamedNode(LAW + "note"), ox.Literal("by hand"), graph)
    saved.store.add([note])
    return set(saved.store.graph(graph.value))


@pytest.fixture
def saved(tmp_path: Path) -> Iterator[SavedVerdicts]:
    with SavedVerdicts(tmp_path / "kept.nq") as there:
        yield there


def test_a_changed_record_answers_nothing_and_gives_way_and_nothing_of_it_is_lost(
    place: str,
    judged: Judged,
    caplog: pytest.LogCaptureFixture,
) -> None:
    first, second, *_ = judged[1]
    with SavedVerdicts(place) as saved:
        saved.add(first)
        saved.add(second)
        was = changed(saved, first)
    with SavedVerdicts(place) as saved, caplog.at_level(logging.WARNING, "sdt.store"):
        assert saved.stored(first.iri) is None
        assert saved.stored(second.iri) is not None
        assert "was changed after it was written" in caplog.text
        assert saved.add_record(to_record(first))
        assert not saved.add_record(to_record(first))
    with SavedVerdicts(place) as saved:
        assert saved.stored(first.iri) is not None
    ((row,), outcomes) = query_saved(place, ASIDE)[1], query_saved(place, OUTCOMES)[1]
    assert row["v"] == first.iri
    assert set(ox.parse(str(row["text"]), format=ox.RdfFormat.N_QUADS)) == was
    assert len(outcomes) == 2


def test_even_a_refusal_takes_the_place_of_a_changed_certificate(
    saved: SavedVerdicts, judged: Judged
) -> None:
    certified = next(each for each in judged[1] if each.outcome is Outcome.CERTIFIED)
    refusal = Diagnosis(Kind.EMBODIMENT, "no gripper gets there")
    refused = replace(certified, outcome=Outcome.NOT_CERTIFIED, diagnoses=(refusal,))
    saved.add(certified)
    changed(saved, certified)
    assert saved.add_record(to_record(refused))
    stored = saved.stored(certified.iri)
    assert stored is not None
    assert stored.outcome is Outcome.NOT_CERTIFIED


def test_all_others_are_read_and_the_changed_one_is_named(saved: SavedVerdicts, judged: Judged) -> None:
    for each in judged[1]:
        saved.add(each)
    changed(saved, judged[1][0])
    sound, damaged = all_recalled(saved.store.dump())
    assert {each.iri for each in sound} == {each.iri for each in judged[1][1:]}
    assert list(damaged) == [judged[1][0].iri]


def test_a_directory_whose_bytes_were_changed_is_told_as_damaged_wherever_it_is_read(
    judged: Judged, tmp_path: Path
) -> None:
    place = tmp_path / "kept"
    with SavedVerdicts(place) as saved:
        for verdict in judged[1]:
            saved.add(verdict)
    for file in place.glob("*.sst"):
        content = bytearray(file.read_bytes())
        if len(content) < TABLE:
            continue
        content[20] ^= 1  # in its first block of data: RocksDB finds it when that is read
        file.write_bytes(content)
    graph = graph_of(judged[1][0].iri)
    for ask in (
        lambda: query_saved(place, "SELECT * { ?s ?p ?o }"),
        lambda: query_saved(place, "CONSTRUCT { ?s ?p ?o } WHERE { ?s ?p ?o }"),
        lambda: list(Saved(place).entries()),
    ):
        with pytest.raises(StoreRejectedError, match="is damaged: Corruption"):
            ask()
    store = opened(place)
    for read in (store.dump, lambda: store.graph(graph)):
        with pytest.raises(StoreRejectedError, match="is damaged: Corruption"):
            read()
    with suppress(StoreRejectedError):  # RocksDB may come to it again when it tidies up
        store.close()


def test_a_directory_that_cannot_be_opened_for_a_recheck_is_told_as_damaged(tmp_path: Path) -> None:
    place = tmp_path / "kept"
    opened(place).close()
    (place / "CURRENT").write_text("garbage")
    with pytest.raises(StoreRejectedError, match="is damaged"):
        Saved(place)
