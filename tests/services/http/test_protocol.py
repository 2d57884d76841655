"""What the texts of the recommendations say and the W3C's tests leave out, and who may ask at all."""

import pytest

from services.specifications.find import ready
from services.store.workers import put

SELECT = "SELECT ?o { <http://e/s> <http://e/p> ?o }"
CONSTRUCT = "CONSTRUCT WHERE { <http://e/s> ?p ?o }"
FORM = {"content-type": "application/x-www-form-urlencoded"}
DIRECT = {"content-type": "application/sparql-query"}
LATIN = {"content-type": "application/sparql-query; charset=latin-1"}


@pytest.fixture(scope="module")
def served(serve):
    served = serve()
    served.apply(
        put("http://e/one", b'<http://e/s> <http://e/p> "one" .'),
        put("http://e/two", b'<http://e/s> <http://e/p> "two" .', shown=False),
    )
    return served


def values(answer) -> set[str]:
    return {row["o"]["value"] for row in answer.json()["results"]["bindings"]}


NEGOTIATED = [
    (SELECT, None, "application/sparql-results+json"),
    (SELECT, "*/*", "application/sparql-results+json"),
    (SELECT, "application/sparql-results+xml", "application/sparql-results+xml"),
    (SELECT, "text/csv", "text/csv; charset=utf-8"),
    (SELECT, "text/tab-separated-values", "text/tab-separated-values; charset=utf-8"),
    (SELECT, "application/json", "application/json"),
    (SELECT, "text/csv;q=0.5, application/sparql-results+xml;q=0.9", "application/sparql-results+xml"),
    (SELECT, "text/*", "text/csv; charset=utf-8"),
    (SELECT, "application/sparql-results+json;q=0, */*", "application/sparql-results+xml"),
    (SELECT, "TEXT/CSV", "text/csv; charset=utf-8"),
    (SELECT, "text/turtle, text/csv;q=0.1", "text/csv; charset=utf-8"),
    ("ASK {}", "application/sparql-results+xml", "application/sparql-results+xml"),
    (CONSTRUCT, None, "text/turtle; charset=utf-8"),
    (CONSTRUCT, "application/n-triples", "application/n-triples"),
    (CONSTRUCT, "application/trig", "application/trig"),
    (CONSTRUCT, "application/ld+json", "application/ld+json"),
    (CONSTRUCT, "text/html, application/xhtml+xml, */*;q=0.8", "text/turtle; charset=utf-8"),
    ("DESCRIBE <http://e/s>", "text/turtle;q=0.2, application/n-triples;q=0.3", "application/n-triples"),
]


@pytest.mark.parametrize(("query", "accept", "expected"), NEGOTIATED)
def test_the_client_gets_what_it_likes_best(served, query: str, accept: str | None, expected: str) -> None:
    answer = served.query(query, headers={"accept": accept} if accept else {})
    assert (answer.status_code, answer.headers["content-type"]) == (200, expected)
    assert answer.headers["vary"] == "Accept"
    assert answer.content


@pytest.mark.parametrize(
    ("query", "accept"),
    [
        (SELECT, "text/turtle"),
        (SELECT, "image/png"),
        (SELECT, "*/*;q=0"),
        ("ASK {}", "text/csv"),
        (CONSTRUCT, "text/csv"),
        (CONSTRUCT, "application/rdf+xml"),
        (SELECT, "nonsense"),
    ],
)
def test_what_cannot_be_given_is_not_acceptable(served, query: str, accept: str) -> None:
    answer = served.query(query, headers={"accept": accept})
    assert answer.status_code == 406
    assert answer.json()["allowed"]


def test_several_accept_headers_are_one_list(served) -> None:
    accept = [("accept", "text/turtle, text/csv;q=0.5"), ("accept", "text/tab-separated-values")]
    answer = served.query(SELECT, headers=accept)
    assert answer.headers["content-type"] == "text/tab-separated-values; charset=utf-8"


def test_the_default_graph_holds_what_is_shown_and_the_rest_is_there_by_name(served) -> None:
    assert values(served.query(SELECT)) == {"one"}
    assert values(served.query("SELECT ?o { GRAPH ?g { <http://e/s> <http://e/p> ?o } }")) == {"one", "two"}


def test_the_protocol_says_the_dataset_before_the_query_does(served) -> None:
    both = {"query": SELECT, "default-graph-uri": ["http://e/one", "http://e/two"]}
    assert values(served.get("/sparql", params=both)) == {"one", "two"}
    from_one = SELECT.replace("{", "FROM <http://e/one> {", 1)
    assert values(served.query(from_one)) == {"one"}
    overruled = {"query": from_one, "default-graph-uri": "http://e/two"}
    assert values(served.get("/sparql", params=overruled)) == {"two"}
    named = {"query": "SELECT ?o { GRAPH ?g { ?s ?p ?o } }", "named-graph-uri": "http://e/two"}
    assert values(served.get("/sparql", params=named)) == {"two"}
    only_named = {"query": SELECT, "named-graph-uri": "http://e/two"}
    assert values(served.get("/sparql", params=only_named)) == set()


BAD = {
    "no query": (("POST", "/sparql", {"headers": FORM, "content": "default-graph-uri=http%3A%2F%2Fe"}), 400),
    "query twice": (("POST", "/sparql", {"headers": FORM, "content": "query=ASK{}&query=ASK{}"}), 400),
    "query in URL and body": (
        ("POST", "/sparql?query=ASK%7B%7D", {"headers": DIRECT, "content": "ASK {}"}), 400,
    ),
    "query and update": (("POST", "/sparql", {"headers": FORM, "content": "query=ASK{}&update=x"}), 400),
    "update": (("POST", "/sparql", {"headers": FORM, "content": "update=CLEAR+ALL"}), 403),
    "update in the body": (
        ("POST", "/sparql", {"headers": {"content-type": "application/sparql-update"}, "content": "x"}), 403,
    ),
    "update by GET": (("GET", "/sparql?update=CLEAR%20ALL", {}), 400),
    "no SPARQL": (("GET", "/sparql?query=SELEKT", {}), 400),
    "empty query": (("GET", "/sparql?query=", {}), 400),
    "bytes that are no UTF-8": (("POST", "/sparql", {"headers": DIRECT, "content": b"ASK {} #\xff"}), 400),
    "escapes that are no UTF-8": (("GET", "/sparql?query=ASK%7B%7D%23%FF", {}), 400),
    "other charset": (("POST", "/sparql", {"headers": LATIN, "content": "ASK {}"}), 415),
    "other type": (
        ("POST", "/sparql", {"headers": {"content-type": "application/json"}, "content": "{}"}), 415,
    ),
    "no type": (("POST", "/sparql", {"content": b"ASK {}"}), 415),
    "PUT": (("PUT", "/sparql", {"content": b"x"}), 405),
    "DELETE of a graph": (("DELETE", "/graphs?graph=http://e/one", {}), 405),
    "PATCH of a graph": (("PATCH", "/graphs?default", {"content": b"x"}), 405),
    "graph and default": (("GET", "/graphs?graph=http://e/one&default", {}), 400),
    "graph twice": (("GET", "/graphs?graph=http://e/one&graph=http://e/two", {}), 400),
    "empty graph": (("GET", "/graphs?graph=", {}), 400),
    "relative graph": (("GET", "/graphs?graph=one", {}), 400),
    "misspelled default graph": (("GET", "/sparql?query=ASK%7B%7D&default-graph=e:one", {}), 400),
    "relative default graph": (("GET", "/sparql?query=ASK%7B%7D&default-graph-uri=one", {}), 400),
    "unknown graph": (("GET", "/graphs?graph=http://e/three", {}), 404),
    "unknown graph, directly": (("HEAD", "/graphs/three", {}), 404),
    "unknown resource": (("GET", "/id/nobody", {}), 404),
    "RDF/XML of a graph": (("GET", "/graphs?default", {"headers": {"accept": "application/rdf+xml"}}), 406),
    "unknown path": (("GET", "/admin", {}), 404),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_a_bad_request_gets_its_status_and_a_problem_document(served, name: str) -> None:
    (method, path, parts), status = BAD[name]
    answer = served.request(method, path, **parts)
    assert answer.status_code == status, answer.text
    if method != "HEAD":
        assert answer.headers["content-type"] == "application/problem+json"
        assert answer.json()["status"] == status
        assert "Traceback" not in answer.text
    if status == 405:
        assert "GET" in answer.headers["allow"]


def test_a_function_that_is_not_there_is_named(served) -> None:
    asked = {"query": "SELECT ?x { BIND(<http://e/f>(1) AS ?x) }"}
    told = served.get("/sparql", params=asked).json()
    assert (told["title"], told["status"]) == ("Query", 400)
    assert "<http://e/f> is not supported" in told["detail"]


def test_head_is_get_without_a_body(served) -> None:
    for path in ("/sparql?query=ASK%7B%7D", "/graphs?default", "/graphs?graph=http://e/one"):
        head, get = served.request("HEAD", path), served.get(path)
        assert head.status_code == get.status_code == 200
        assert head.content == b""
        for name in ("content-type", "content-length"):
            assert head.headers[name] == get.headers[name]


FOREIGN = [
    ({"host": "evil.example"}, 421),
    ({"host": "www.example.evil.example"}, 421),
    ({"host": "www.example:8080"}, 200),
    ({"host": "WWW.EXAMPLE"}, 200),
    ({"host": ""}, 400),
    ({"origin": "http://evil.example"}, 403),
    ({"origin": "null"}, 403),
    ({"origin": "http://www.example"}, 200),
    ({"origin": "https://www.example"}, 403),
]


@pytest.mark.parametrize(("headers", "status"), FOREIGN)
def test_other_hosts_and_origins_are_turned_away(served, headers: dict[str, str], status: int) -> None:
    answer = served.query("ASK {}", headers=headers)
    assert answer.status_code == status
    assert "access-control-allow-origin" not in answer.headers


def test_cors_is_for_named_origins_only(serve) -> None:
    named = serve(origins=frozenset({"https://friend.example"}))
    answer = named.query("ASK {}", headers={"origin": "https://friend.example"})
    assert answer.headers["access-control-allow-origin"] == "https://friend.example"
    preflight = {"origin": "https://friend.example", "access-control-request-method": "POST"}
    assert named.request("OPTIONS", "/sparql", headers=preflight).status_code == 204
    preflight["origin"] = "https://other.example"
    assert named.request("OPTIONS", "/sparql", headers=preflight).status_code == 403


def test_the_description_tells_what_is_there(served) -> None:
    text = served.get("/graphs", headers={"accept": "application/n-triples"}).text
    assert "<http://www.w3.org/ns/sparql-service-description#name> <http://e/two>" in text
    assert "<http://rdfs.org/ns/void#sparqlEndpoint> <http://www.example/sparql>" in text
    people = served.get("/sparql", headers={"accept": "text/html,*/*;q=0.5"})
    assert (people.status_code, people.headers["location"]) == (303, "/console")


def test_openapi_tells_of_protocols_verbs_and_token(served) -> None:
    paths = served.get("/openapi.json").json()["paths"]
    assert {"/sparql", "/graphs", "/api/v1/achieve", "/api/v1/why"} <= set(paths)
    assert all(item["post"]["security"] for path, item in paths.items() if "/api/" in path and "post" in item)


def test_the_task_that_openapi_gives_as_an_example_is_ready(served) -> None:
    models = served.get("/openapi.json").json()["components"]["schemas"]
    assert set(models["TaskBody"]["properties"]["task"]["examples"]) <= ready().keys()


def test_openapi_tells_how_each_verb_refuses(served) -> None:
    document = served.get("/openapi.json").json()
    fields = document["components"]["schemas"]["Problem"]
    for path, method in (
        ("/api/v1/why", "GET"),
        ("/api/v1/verdicts/0", "GET"),
        ("/sparql?query=nothing", "GET"),
    ):
        answer = served.request(method, path)
        assert answer.headers["content-type"] == "application/problem+json"
        assert set(fields["required"]) <= set(answer.json()) <= set(fields["properties"])
    for path, item in document["paths"].items():
        for method, verb in item.items():
            assert list(verb["responses"]["default"]["content"]) == ["application/problem+json"], (
                path,
                method,
            )
            assert "422" not in verb["responses"], (path, method)


def test_health_readiness_version_and_openapi_answer(served) -> None:
    for path in ("/healthz", "/readyz", "/version", "/openapi.json", "/"):
        assert served.get(path).status_code == 200, path
