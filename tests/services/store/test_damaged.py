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
from predicates.record.seal import RECORD_HASH
from predicates.specification.results.record import task_record
from sdt_kg.errors import InputError, StoreRejectedError
from sdt_kg.iri import LAW, RDF, Iri
from sdt_kg.store import rows_of
from services.embodiment.recheck import Saved
from services.store.files import SavedVerdicts, opened, query_saved
from services.store.records import all_recalled, changed_since, graph_of
from services.why import why
from tests.competency.conftest import task_results
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


def edited(saved: SavedVerdicts, iri: Iri, predicate: Iri, value: ox.NamedNode | ox.Literal | None) -> None:
    """Another value of what a record says once, or none."""
    graph, subject, name = graph_of(iri), ox.NamedNode(iri), ox.NamedNode(predicate)
    (was,) = (each for each in saved.store.graph(graph) if (each.subject, each.predicate) == (subject, name))
    others = [each for each in saved.store.graph(graph) if each != was]
    more = [] if value is None else [ox.Quad(subject, name, value, was.graph_name)]
    saved.store.replace(graph, [*others, *more])


@pytest.mark.parametrize(
    ("predicate", "value"),
    [(RDF + "type", ox.NamedNode(LAW + "Note")), (RDF + "type", None), (RECORD_HASH, None)],
)
def test_a_record_that_says_to_be_something_else_or_has_no_hash_is_named(
    saved: SavedVerdicts, judged: Judged, predicate: Iri, value: ox.NamedNode | None
) -> None:
    first, *others = judged[1]
    for each in judged[1]:
        saved.add(each)
    edited(saved, first.iri, predicate, value)
    sound, damaged = all_recalled(saved.store.dump())
    assert {each.iri for each in sound} == {each.iri for each in others}
    assert list(damaged) == [first.iri]
    assert [graph for graph, _ in changed_since(saved.store.dump())] == [graph_of(first.iri)]
    assert saved.stored(first.iri) is None


@pytest.mark.parametrize(
    ("predicate", "value"),
    [
        (LAW + "taskOutcome", ox.NamedNode(LAW + "Certified")),
        (LAW + "taskOutcome", None),
        (RDF + "type", ox.NamedNode(LAW + "Note")),
        (RECORD_HASH, None),
    ],
)
def test_a_changed_result_of_a_task_is_named_and_tells_nothing_and_gives_way(
    saved: SavedVerdicts, predicate: Iri, value: ox.NamedNode | None
) -> None:
    broken, kept = task_results()
    assert broken.outcome is Outcome.NOT_CERTIFIED
    for each in (broken, kept):
        assert saved.add_record(task_record(each))
    edited(saved, broken.iri, predicate, value)
    assert list(all_recalled(saved.store.dump())[1]) == [broken.iri]
    assert [graph for graph, _ in changed_since(saved.store.dump())] == [graph_of(broken.iri)]
    with pytest.raises(InputError):
        why(saved.store.dump(), broken.iri)
    assert why(saved.store.dump(), kept.iri)
    was = saved.store.graph(graph_of(broken.iri))
    assert saved.add_record(task_record(broken))
    assert not all_recalled(saved.store.dump())[1]
    (row,) = rows_of(saved.store.query(ASIDE))[1]
    assert set(ox.parse(str(row["text"]), format=ox.RdfFormat.N_QUADS)) == set(was)


def test_a_text_that_is_given_a_language_is_seen(saved: SavedVerdicts, judged: Judged) -> None:
    first = judged[1][0]
    saved.add(first)
    graph = graph_of(first.iri)
    name = ox.NamedNode(LAW + "name")
    was = next(each for each in saved.store.graph(graph) if each.predicate == name)
    assert isinstance(was.object, ox.Literal)
    assert isinstance(was.subject, ox.NamedNode)
    spoken = ox.Quad(was.subject, name, ox.Literal(was.object.value, language="en"), was.graph_name)
    saved.store.replace(graph, [*(each for each in saved.store.graph(graph) if each != was), spoken])
    assert list(all_recalled(saved.store.dump())[1]) == [first.iri]


def test_who_else_calls_a_verdict_so_in_a_graph_of_his_own_does_not_hide_it(
    saved: SavedVerdicts, judged: Judged
) -> None:
    first = judged[1][0]
    saved.add(first)
    told = why(saved.store.dump(), first.iri)
    kind, verdict = ox.NamedNode(RDF + "type"), ox.NamedNode(LAW + "Verdict")
    saved.store.add([ox.Quad(ox.NamedNode(first.iri), kind, verdict, ox.NamedNode("https://my.org/notes"))])
    assert why(saved.store.dump(), first.iri) == told
    assert not all_recalled(saved.store.dump())[1]


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
