"""A query about something that is known: the same rows as of the whole answer, found from there."""

import pyoxigraph as ox
import pytest

from sdt_kg.errors import QueryError
from sdt_kg.store import rows_of
from services.store.known import restricted

EX = "https://example.org/"
ONE = {"kitchen": ox.NamedNode(EX + "one")}


@pytest.fixture
def store() -> ox.Store:
    """Three robots in two kitchens."""
    held = ox.Store()
    for robot, kitchen in (("r", "one"), ("s", "one"), ("t", "two")):
        held.add(ox.Quad(ox.NamedNode(EX + robot), ox.NamedNode(EX + "in"), ox.NamedNode(EX + kitchen)))
    return held


@pytest.mark.parametrize(
    "sparql",
    [
        "SELECT ?kitchen (COUNT(?r) AS ?n) { ?r <https://example.org/in> ?kitchen } GROUP BY ?kitchen",
        "SELECT(COUNT(?r) AS ?n){?r <https://example.org/in> ?kitchen}",
        "PREFIX select: <https://example.org/> # {\nselect (COUNT(*) AS ?n) WHERE{?r select:in ?kitchen}",
        "SELECT ('{' AS ?b) (COUNT(?r) AS ?n) { ?r ex:in ?kitchen FILTER(STR(?r) != '''}'\"''') }",
        "SELECT (COUNT(?r) AS ?n) { { SELECT ?r ?kitchen { ?r ex:in ?kitchen } } }HAVING (COUNT(?r) > 0)",
        "SELECT (SUM(IF(EXISTS { ?r ex:in ?kitchen }, 1, 0)) AS ?n) { ?r ex:in ?kitchen }",
        'SELECT (COUNT(?r) AS ?n) { ?r ex:in ?kitchen FILTER("""a"}"{""" != "\\"}") }',
    ],
)
def test_what_is_counted_is_counted_about_what_is_known(store: ox.Store, sparql: str) -> None:
    text = sparql if "PREFIX" in sparql else f"PREFIX ex: <{EX}> {sparql}"
    (row,) = rows_of(store.query(restricted(text, ONE)))[1]
    assert row["n"] == 2


def test_two_known_values_hold_together(store: ox.Store) -> None:
    known = {**ONE, "r": ox.NamedNode(EX + "t")}
    text = restricted(f"SELECT ?r ?kitchen {{ ?r <{EX}in> ?kitchen }}", known)
    assert rows_of(store.query(text))[1] == []


@pytest.mark.parametrize(
    "sparql",
    [
        "ASK { ?r ?p ?kitchen }",
        "CONSTRUCT { ?r ?p ?kitchen } WHERE { ?r ?p ?kitchen }",
        "SELECT ?r { ?r ?p ?elsewhere }",
        "SELECT ?r { ?r ?p ?o FILTER(?kitchen = ?o) }",
        "SELECT ?r { ?r ?p ?o { SELECT ?r { ?r ?p ?kitchen } } }",
        "SELECT (1 AS ?kitchen) { ?r ?p ?o }",
        "SELECT ?kitchen",
        "",
    ],
)
def test_a_value_that_would_restrict_nothing_is_refused(sparql: str) -> None:
    with pytest.raises(QueryError):
        restricted(sparql, ONE)


def test_a_value_that_the_pattern_computes_is_no_query(store: ox.Store) -> None:
    with pytest.raises(SyntaxError):
        store.query(restricted("SELECT ?kitchen { BIND(1 AS ?kitchen) }", ONE))


def test_a_value_is_written_not_pasted(store: ox.Store) -> None:
    text = restricted("SELECT ?kitchen { ?r ?p ?kitchen }", {"kitchen": ox.Literal('") } DROP ALL # \n')})
    assert rows_of(store.query(text))[1] == []
