# ruff: noqa: S608 - the queries are the subject
"""What a query may ask for; every trick that we could think of to ask for more."""

import pyoxigraph as ox
import pytest

import ontology
from sdt_kg.errors import QueryError
from sdt_kg.iri import PREFIXES
from services.store.guard import RefusedQueryError, guarded

HERE = "http://here.example/graph"
SERVICE = "SERVICE <http://127.0.0.1:9/> { ?a ?b ?c }"

REFUSED = {
    "plain": f"SELECT * {{ {SERVICE} }}",
    "silent": "SELECT * { SERVICE SILENT ?x { ?a ?b ?c } }",
    "case": "SELECT * { sErViCe <http://127.0.0.1:9/> { ?a ?b ?c } }",
    "no space": "SELECT*{SERVICE<http://127.0.0.1:9/>{?a ?b ?c}}",
    "prefixed": "PREFIX e: <http://127.0.0.1:9/> SELECT * { SERVICE e:x { ?a ?b ?c } }",
    "optional": f"SELECT * {{ OPTIONAL {{ {SERVICE} }} }}",
    "union": f"SELECT * {{ {{ ?a ?b ?c }} UNION {{ {SERVICE} }} }}",
    "minus": f"SELECT * {{ MINUS {{ {SERVICE} }} }}",
    "graph": f"SELECT * {{ GRAPH ?g {{ {SERVICE} }} }}",
    "subquery": f"SELECT * {{ {{ SELECT * {{ {SERVICE} }} }} }}",
    "subquery in a subquery": f"SELECT * {{ {{ SELECT * {{ {{ SELECT ?a {{ {SERVICE} }} LIMIT 1 }} }} }} }}",
    "beside many values": f"ASK {{ VALUES ?x {{ {'1 ' * 500}}} {SERVICE} }}",
    "filter": f"SELECT * {{ ?a ?b ?c FILTER EXISTS {{ {SERVICE} }} }}",
    "not exists": f"SELECT * {{ ?a ?b ?c FILTER(1 = 1 && NOT EXISTS {{ {SERVICE} }}) }}",
    "bind": f"SELECT * {{ BIND(EXISTS {{ {SERVICE} }} AS ?x) }}",
    "projection": f"SELECT (EXISTS {{ {SERVICE} }} AS ?x) {{ ?a ?b ?c }}",
    "having": f"SELECT ?a {{ ?a ?b ?c }} GROUP BY ?a HAVING (EXISTS {{ {SERVICE} }})",
    "order": f"SELECT ?a {{ ?a ?b ?c }} ORDER BY (EXISTS {{ {SERVICE} }})",
    "construct": f"CONSTRUCT {{ ?a ?b ?c }} WHERE {{ {SERVICE} }}",
    "describe": f"DESCRIBE ?a {{ {SERVICE} }}",
    "ask": f"ASK {{ {SERVICE} }}",
    "after a comment": f"ASK {{ # nothing\n {SERVICE} }}",
    "after a quote": f'ASK {{ BIND("\\"" AS ?x) {SERVICE} }}',
    "after a long string": f"ASK {{ BIND('''a''' AS ?x) {SERVICE} }}",
    "from": "SELECT * FROM <http://127.0.0.1:9/> { ?a ?b ?c }",
    "from named": "SELECT * FROM NAMED <http://127.0.0.1:9/> { ?a ?b ?c }",
    "from file": "SELECT * FROM <file:///etc/passwd> { ?a ?b ?c }",
    "from, one here": f"SELECT * FROM <{HERE}> FROM <http://127.0.0.1:9/> {{ ?a ?b ?c }}",
    "from by prefix": "PREFIX e: <http://127.0.0.1:9/> ASK FROM e:x {}",
    "from by base": "BASE <http://127.0.0.1:9/> ASK FROM <x> {}",
    "from without space": "SELECT*FROM<http://127.0.0.1:9/>{?a ?b ?c}",
}
"""Read as what they are, and refused."""

MISREAD = {
    "escaped keyword": "SELECT * { \\u0053ERVICE <http://127.0.0.1:9/> { ?a ?b ?c } }",
    "escaped twice": "SELECT * { \\u005Cu0053ERVICE <http://127.0.0.1:9/> { ?a ?b ?c } }",
    "escaped, long": "SELECT * { \\U00000053ERVICE <http://127.0.0.1:9/> { ?a ?b ?c } }",
    "long s": "SELECT * { \u017fERVICE <http://127.0.0.1:9/> { ?a ?b ?c } }",
    # One parser sees a comment until the line feed, the other until the carriage return.
    "carriage return": f"ASK {{ # nothing \r {SERVICE} \n }}",
    # One parser sees the string end at the escape, the other after it.
    "escaped quote": f'ASK {{ BIND("\\u0022) }} #" AS ?x) {SERVICE} }}',
    "escaped line end": f"ASK {{ # \\u000A {SERVICE}\n }}",
    "update": "INSERT DATA { <a:a> <a:b> <a:c> }",
    "load": "LOAD <http://127.0.0.1:9/>",
    "load behind a comment": "ASK {} # nothing\nLOAD <http://127.0.0.1:9/>",
    "load of a file": "LOAD <file:///etc/passwd> INTO GRAPH <http://here.example/graph>",
    "load into a string": 'ASK { BIND("a\nLOAD <http://127.0.0.1:9/>" AS ?x) }',
    "load after query": "ASK {} ; LOAD <http://127.0.0.1:9/>",
    "drop": "DROP ALL",
    "two queries": "ASK {} ASK {}",
    "keyword run together": "ASKFROM<http://127.0.0.1:9/>{}",
    "service in a service": f"SELECT * {{ SERVICE <{HERE}> {{ {SERVICE} }} }}",
    "nested": "ASK { FILTER(" + "(" * 400 + '"service"' + ")" * 400 + ") }",
}
"""Refused as no SPARQL that reads, by one parser or the other."""

HARMLESS = {
    "in a string": 'SELECT ("SERVICE <http://x/> {" AS ?x) { }',
    "in a single quoted string": "SELECT ('it is a service' AS ?x) { }",
    "in an IRI": "SELECT * { ?a <http://here.example/service> ?c }",
    "in a comment": "SELECT * { ?a ?b ?c } # SERVICE <http://127.0.0.1:9/> { }",
    "in a comment with both line ends": "SELECT * { # service\r\n ?a ?b ?c }",
    "from a variable": "SELECT ?from { ?from sdt:openFrom ?c }",
    "from here": f"SELECT * FROM <{HERE}> {{ ?a ?b ?c }}",
    "from named here": f"SELECT * FROM NAMED <{HERE}> {{ GRAPH ?g {{ ?a ?b ?c }} }}",
}


def is_here(graph: str) -> bool:
    return graph == HERE


def evaluated(text: str) -> object:
    return ox.Store().query(guarded(text, is_here).text, prefixes=PREFIXES)


@pytest.mark.parametrize("name", REFUSED)
def test_what_fetches_is_refused_as_such(name: str) -> None:
    with pytest.raises(RefusedQueryError):
        guarded(REFUSED[name], is_here)


@pytest.mark.parametrize("name", MISREAD)
def test_what_the_parsers_may_read_differently_is_refused(name: str) -> None:
    with pytest.raises((QueryError, SyntaxError)):
        evaluated(MISREAD[name])


@pytest.mark.parametrize("name", HARMLESS)
def test_the_words_alone_are_no_crime(name: str) -> None:
    evaluated(HARMLESS[name])


def test_the_word_reaches_the_evaluator_only_as_an_escape_and_means_what_it_meant() -> None:
    checked = guarded('SELECT ("a service, a SERVICE" AS ?x) { } # service', is_here)
    assert "service" not in checked.text.lower()
    (row,) = ox.Store().query(checked.text)  # pyright: ignore[reportGeneralTypeIssues]
    assert row["x"].value == "a service, a SERVICE"


def test_the_evaluator_takes_no_escape_for_a_keyword() -> None:
    """What the mask rests on: outside strings and IRIs, pyoxigraph does not decode escapes."""
    for text in ("\\u0041SK {}", "SELECT * { \\u0053ERVICE <http://127.0.0.1:9/> { ?a ?b ?c } }"):
        with pytest.raises(SyntaxError):
            ox.Store().query(text)


def test_the_dataset_of_a_query_is_read() -> None:
    checked = guarded(f"PREFIX h: <http://here.example/> ASK FROM h:graph FROM NAMED <{HERE}> {{}}", is_here)
    assert (checked.default_graphs, checked.named_graphs) == ((HERE,), (HERE,))


def test_our_own_queries_pass() -> None:
    files = sorted(ontology.path("queries").glob("*.rq"))
    assert files
    for file in files:
        text = file.read_text()
        assert guarded(text, is_here).text == text, file.name
