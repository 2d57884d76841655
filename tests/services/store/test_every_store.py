"""What holds for a file, a directory and a server alike."""

from dataclasses import replace
from pathlib import Path

import pyoxigraph as ox
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import ontology
from predicates.case import Diagnosis, Kind, Outcome, Search, Verdict
from predicates.record import to_record, write
from sdt_kg.errors import InputError, QueryError
from sdt_kg.iri import PREFIXES
from sdt_kg.store import Row, rows_of
from sdt_kg.twin import Twin
from services.store.files import SavedVerdicts, opened, query_saved
from services.store.quads import QuadStore

QUERIES = sorted(Path(str(ontology.path("queries"))).glob("cq*.rq"))
KINDS = ("file.trig", "file.nq", "folder", "server")
G, H = "https://example.org/g", "https://example.org/h"
Judged = tuple[tuple[Twin, ...], tuple[Verdict, ...]]


@pytest.fixture(params=KINDS)
def place(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """Where a store is or will be."""
    if request.param == "server":
        return request.getfixturevalue("server").address
    return str(tmp_path / request.param)


def quad(subject: str, value: ox.NamedNode | ox.Literal, graph: str = G) -> ox.Quad:
    name = ox.NamedNode("https://example.org/p")
    return ox.Quad(ox.NamedNode(f"https://example.org/{subject}"), name, value, ox.NamedNode(graph))


def reopened(store: QuadStore, place: str) -> QuadStore:
    store.close()
    return opened(place)


def ordered(answer: tuple[list[str], list[Row]]) -> tuple[list[str], list[str]]:
    return answer[0], sorted(str(row) for row in answer[1])


def test_competency_questions_have_the_rows_of_one_store_in_memory(place: str, judged: Judged) -> None:
    twins, verdicts = judged
    memory = ox.Store()
    with SavedVerdicts(place) as saved:
        for twin in twins:
            saved.add_twin(twin)
            memory.extend(twin.entities.store.dump(twin.graphs()))
        for verdict in verdicts:
            saved.add(verdict)
            write(memory, to_record(verdict))
    answered = 0
    for path in QUERIES:
        sparql = path.read_text()
        expected = rows_of(memory.query(sparql, use_default_graph_as_union=True, prefixes=PREFIXES))
        assert ordered(query_saved(place, sparql)) == ordered(expected), path.stem
        answered += bool(expected[1])
    assert answered >= 9


def test_a_verdict_is_found_by_its_iri_and_given_back(place: str, judged: Judged) -> None:
    first, second, *_ = judged[1]
    with SavedVerdicts(place) as saved:
        saved.add(first)
    with SavedVerdicts(place) as saved:
        assert first.iri in saved
        assert second.iri not in saved
        assert saved.stored(second.iri) is None
        stored = saved.stored(first.iri)
        assert stored is not None
        assert (stored.iri, stored.outcome, stored.inputs) == (first.iri, first.outcome, first.inputs)


def test_only_a_searched_refusal_gives_way(place: str, judged: Judged) -> None:
    made = judged[1][0]
    assert made.outcome is Outcome.CERTIFIED
    search = Search(seeds=5, branches=2, placements=3, seconds=1.0)
    refused = replace(
        made,
        outcome=Outcome.NOT_CERTIFIED,
        diagnoses=(Diagnosis(Kind.EMBODIMENT, "no placement found", search=search),),
    )
    outcomes = []
    with SavedVerdicts(place) as saved:
        for each in (refused, made, refused):
            saved.add(each)
            stored = saved.stored(made.iri)
            assert stored is not None
            outcomes.append(stored.outcome)
    assert outcomes == [Outcome.NOT_CERTIFIED, Outcome.CERTIFIED, Outcome.CERTIFIED]


def test_another_version_of_a_model_replaces_its_graph(place: str, judged: Judged) -> None:
    twin = judged[0][1]
    joint = twin.container("top_drawer").joint
    edited = twin.with_edit(joint, upperLimit=0.3)
    limits = f"SELECT ?upper {{ <{joint}> sdt:upperLimit ?upper }}"
    with SavedVerdicts(place) as saved:
        saved.add_twin(twin)
        saved.add_twin(edited)
    assert query_saved(place, limits) == (["upper"], [{"upper": 0.3}])


def test_replace_and_drop_change_one_graph_and_are_kept(place: str) -> None:
    store = opened(place)
    store.add([quad("a", ox.Literal(1)), quad("b", ox.Literal(2)), quad("a", ox.Literal(3), H)])
    store.replace(G, [quad("a", ox.Literal(4))])
    store = reopened(store, place)
    assert store.graph(G) == [quad("a", ox.Literal(4))]
    assert H in store
    store.drop(H)
    store.drop(H)
    store = reopened(store, place)
    assert H not in store
    assert list(store.dump()) == [quad("a", ox.Literal(4))]
    store.close()


def test_a_query_sees_the_graphs_it_is_given_or_all(place: str) -> None:
    store = opened(place)
    store.add([quad("a", ox.Literal(1)), quad("b", ox.Literal(2), H)])
    sparql = "SELECT ?s ?v { ?s <https://example.org/p> ?v } ORDER BY ?v"
    all_rows = rows_of(store.query(sparql))[1]
    assert [row["v"] for row in all_rows] == [1, 2]
    assert rows_of(store.query(sparql, [H]))[1] == all_rows[1:]
    assert rows_of(store.query(sparql, known={"s": ox.NamedNode("https://example.org/a")}))[1] == all_rows[:1]
    assert rows_of(store.query("SELECT ?g { GRAPH ?g { ?s ?p ?o } }", [G]))[1] == [{"g": G}]
    assert rows_of(store.query("ASK { ?s ?p 2 }"))[1] == [{"answer": True}]
    assert rows_of(store.query("ASK { ?s ?p 2 }", [G]))[1] == [{"answer": False}]
    constructed = rows_of(store.query("CONSTRUCT { ?s ?p ?o } WHERE { ?s ?p ?o }", [H]))[1]
    assert [row["object"] for row in constructed] == [2]
    store.close()


def test_a_known_value_must_be_selected_and_a_query_must_parse(place: str) -> None:
    store = opened(place)
    store.add([quad("a", ox.Literal(1))])
    for sparql, name in (
        ("SELECT ?v { ?s ?p ?v } # a remark", "typo"),
        ("SELECT (1 AS ?v) {}", "v"),
        ("ASK { ?s ?p ?v }", "v"),
        ("SELEKT", "v"),
    ):
        with pytest.raises(QueryError):
            store.query(sparql, known={name: ox.Literal(1)})
    remarked = store.query("SELECT ?v { ?s ?p ?v } # a remark", known={"v": ox.Literal(1)})
    assert rows_of(remarked)[1] == [{"v": 1}]
    with pytest.raises(QueryError):
        store.query("SELEKT")
    store.close()


@pytest.mark.parametrize(
    "refused",
    [
        ox.Quad(ox.BlankNode("b"), ox.NamedNode(G), ox.Literal(1), ox.NamedNode(G)),
        ox.Quad(ox.NamedNode(G), ox.NamedNode(G), ox.BlankNode("b"), ox.NamedNode(G)),
        ox.Quad(ox.NamedNode(G), ox.NamedNode(G), ox.Literal(1)),
    ],
)
def test_blank_nodes_and_the_default_graph_are_refused(place: str, refused: ox.Quad) -> None:
    store = opened(place)
    with pytest.raises(InputError):
        store.add([quad("a", ox.Literal(1)), refused])
    assert list(store.dump()) == []
    store.close()


LITERALS = st.one_of(
    st.text(st.characters(exclude_categories=["Cs"]), max_size=20).map(ox.Literal),
    st.floats(allow_nan=False).map(ox.Literal),
    st.integers(-(2**62), 2**62).map(ox.Literal),
    st.booleans().map(ox.Literal),
    st.text("ab\"'\\\n\r\t{}<>#\u0085\u2028\x00\x7f", max_size=12).map(
        lambda text: ox.Literal(text, language="en")
    ),
)


def test_what_looks_like_an_escape_is_read_back(place: str) -> None:
    """SPARQL decodes \\uXXXX wherever it stands, before it looks for the ends of texts."""
    texts = ["a\\u0041", "\\\\u0022", "\\U00000041", '\x00 """ \' \\', "ö+&%=\u0301"]
    quads = {quad(str(index), ox.Literal(each)) for index, each in enumerate(texts)}
    store = opened(place)
    store.add(quads)
    store.replace(H, [quad("x", ox.Literal(each), H) for each in texts])
    store = reopened(store, place)
    assert set(store.graph(G)) == quads
    assert {str(each.object) for each in store.graph(H)} == {str(ox.Literal(each)) for each in texts}
    store.close()


@settings(
    max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture], database=None
)
@given(literals=st.lists(LITERALS, min_size=1, max_size=20))
def test_any_literal_is_read_back(place: str, literals: list[ox.Literal]) -> None:
    store = opened(place)
    quads = {quad(str(index), literal) for index, literal in enumerate(literals)}
    store.drop(G)
    store.add(quads)
    assert set(store.graph(G)) == quads
    store.replace(G, quads)
    store = reopened(store, place)
    assert set(store.graph(G)) == quads
    store.close()
