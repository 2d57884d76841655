"""The store answers queries that read what is loaded, and no others."""

import math

import pyoxigraph as ox
import pytest

from sdt_kg.errors import QueryError
from sdt_kg.iri import XSD
from sdt_kg.store import MemoryStore, checked_query, double, rows_of, term_of, value_of

G = "https://example.org/g"
H = "https://example.org/h"


def store() -> MemoryStore:
    made = MemoryStore()
    made.add(G, [("https://example.org/a", "https://example.org/p", term_of(1.5))])
    made.add(H, [("https://example.org/b", "https://example.org/p", term_of("text"))])
    return made


def test_the_default_graph_is_the_union_of_the_graphs_asked() -> None:
    query = "SELECT ?s ?v { ?s <https://example.org/p> ?v } ORDER BY ?s"
    columns, rows = rows_of(store().query(query, [G, H]))
    assert columns == ["s", "v"]
    assert rows == [{"s": "https://example.org/a", "v": 1.5}, {"s": "https://example.org/b", "v": "text"}]
    assert rows_of(store().query(query, [H]))[1] == rows[1:]


def test_other_graphs_cannot_be_named() -> None:
    query = "SELECT ?g { GRAPH ?g { ?s ?p ?o } }"
    assert rows_of(store().query(query, [G]))[1] == [{"g": G}]


def test_ask_and_construct_have_rows_too() -> None:
    assert rows_of(store().query("ASK { ?s ?p 1.5e0 }", [G])) == (["answer"], [{"answer": True}])
    _, rows = rows_of(store().query("CONSTRUCT WHERE { ?s ?p ?o }", [G]))
    assert rows == [{"subject": "https://example.org/a", "predicate": "https://example.org/p", "object": 1.5}]


def test_known_values_are_bound_and_must_be_selected() -> None:
    query = "SELECT ?s ?v { ?s <https://example.org/p> ?v }"
    known = {"s": term_of("https://example.org/a")}
    assert rows_of(store().query(query, [G, H], known))[1] == [{"s": "https://example.org/a", "v": 1.5}]
    with pytest.raises(QueryError):
        store().query(query, [G], {"other": term_of(1)})


@pytest.mark.parametrize("value", [0.1, 1e300, 5e-324, math.pi, -0.0, 1 / 3, math.inf, 0.9 * 0.4])
def test_doubles_read_back_exactly(value: float) -> None:
    made = MemoryStore()
    made.add(G, [("https://example.org/a", "https://example.org/p", double(value))])
    ((_, _, term),) = made.triples(G)
    assert value_of(term) == value


@pytest.mark.parametrize(
    ("text", "datatype"), [("0/4", "double"), ("1.5", "integer"), ("tru", "boolean"), ("-", "decimal")]
)
def test_a_literal_that_is_none_of_its_datatype_is_its_text(text: str, datatype: str) -> None:
    assert value_of(ox.Literal(text, datatype=ox.NamedNode(XSD + datatype))) == text


@pytest.mark.parametrize("value", [True, False, 3, 2.5, "text", "https://example.org/a"])
def test_values_become_terms_and_values_again(value: bool | float | str) -> None:
    back = value_of(term_of(value))
    assert back == value
    assert type(back) is type(value)


@pytest.mark.parametrize(
    "query",
    [
        "SELECT * { ?s ?p ?o }",
        "# a comment\nASK { ?s ?p 'INSERT DATA' }",
        "DESCRIBE <https://example.org/a>",
        "CONSTRUCT { ?s ?p ?o } WHERE { ?s ?p ?o }",
    ],
)
def test_queries_that_read_pass(query: str) -> None:
    assert checked_query(query) == query


@pytest.mark.parametrize(
    "query",
    [
        "SELECT * { SERVICE <http://127.0.0.1:9/> { ?s ?p ?o } }",
        "SELECT * { service silent <http://127.0.0.1:9/> { ?s ?p ?o } }",
        r"SELECT * { \u0053ERVICE <http://127.0.0.1:9/> { ?s ?p ?o } }",
        "PREFIX : <http://127.0.0.1:9/> SELECT * { SERVICE:x { ?s ?p ?o } }",
        "SELECT * { ?s ?p ?a FILTER(?a<?b)SERVICE?e#>\n{ ?s ?p ?o } }",
        "LOAD <http://127.0.0.1:9/x.ttl>",
        "INSERT DATA { <https://example.org/a> <https://example.org/p> 1 }",
        "DELETE WHERE { ?s ?p ?o }",
        "DROP ALL",
        "SELECT ?x { BIND(<https://example.org/f>(1) AS ?x) }",
        "SELECT (<https://example.org/aggregate>(?x) AS ?y) { ?x ?p ?o }",
        "SELECT * { ?s ?p",
        "",
    ],
)
def test_queries_that_write_fetch_or_do_not_parse_are_refused(query: str) -> None:
    with pytest.raises(QueryError):
        checked_query(query)


@pytest.mark.parametrize(
    "sparql",
    [
        "ASK { ?s ?p ?o FILTER (" + " || ".join(["?s = ?p"] * 10_000) + ") }",
        "ASK { " + "OPTIONAL { ?s ?p ?o } " * 4_000 + "}",
        "ASK { " + "BIND (1 AS ?v) " * 4_000 + "}",
        "ASK { " + "?s ?p ?o . " * 4_000 + "}",
        "ASK { ?s " + "/".join(["rdf:type"] * 4_000) + " ?o }",
        "ASK " + "{" * 8_000 + " ?s ?p ?o " + "}" * 8_000,
        "ASK { ?s ?p ?o FILTER (" + "!" * 20_000 + " true) }",
    ],
)
def test_a_query_of_which_the_parser_would_die_is_refused(sparql: str) -> None:
    with pytest.raises(QueryError, match=r"joins \d+ parts|nested too deeply"):
        checked_query(sparql)


def test_a_long_list_of_values_is_no_long_query() -> None:
    values = " ".join(f"<https://example.org/a+b/{n}.x> '{n} || {{ ; '" for n in range(5_000))
    sparql = f"SELECT ?v {{ VALUES ?v {{ {values} }} }}"
    assert checked_query(sparql) == sparql
