"""The W3C's tests of the SPARQL 1.1 Protocol and Graph Store Protocol, read from their manifests.

Updates and writes are not done over HTTP: those requests must be refused, and what a later request of
the same test reads is put there through the store.
"""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

import pyoxigraph as ox
import pytest
import rdflib
from rdflib.collection import Collection
from rdflib.compare import isomorphic

from services.store.workers import DEFAULT_GRAPH, drop, put

MF = rdflib.Namespace("http://www.w3.org/2001/sw/DataAccess/tests/test-manifest#")
HT = rdflib.Namespace("http://www.w3.org/2011/http#")
CNT = rdflib.Namespace("http://www.w3.org/2011/content#")
UT = rdflib.Namespace("http://www.w3.org/2009/sparql/tests/test-update#")
STATUS = {"OK": 200, "Created": 201, "NoContent": 204, "NotFound": 404}
PROTOCOL_TESTS = 34
GRAPH_STORE_TESTS = 13
DATA = "http://kasei.us/2009/09/sparql/data/data{}.rdf"
CREATED = "http://www.example/graphs/new"
UPDATES = ("update=", "INSERT", "CLEAR", "DELETE")
FORMATS = {
    "boolean": {"application/sparql-results+json", "application/sparql-results+xml"},
    "tabular": {"application/sparql-results+json", "application/sparql-results+xml", "text/csv"},
    "RDF": {"text/turtle", "application/n-triples"},
}


@dataclass(frozen=True)
class Step:
    """One request of a test, and what the test wants to see."""

    method: str
    path: str
    headers: dict[str, str]
    body: bytes
    status: list[str]
    form: str | None
    truth: bool | None
    type: str | None
    graph: str | None

    @property
    def writes(self) -> bool:
        """Whether it asks for an update or a write."""
        text = self.path + self.body.decode("utf-8", "replace")
        return self.method in {"PUT", "POST", "DELETE"} and any(word in text for word in UPDATES)


def manifest(folder: Path, names: list[str]) -> dict[str, list[Step]]:
    """Test name → its requests, in order."""
    graph = rdflib.Graph()
    for name in names:
        graph.parse(folder / name, publicID=f"http://manifest/{name}")
    lists = [Collection(graph, each) for each in graph.objects(None, MF.entries)]
    return {
        str(entry).rpartition("#")[2]: [
            _step(graph, request)
            for action in graph.objects(entry, MF.action)
            for request in Collection(graph, graph.value(action, HT.requests))
        ]
        for entries in lists
        for entry in entries
        if graph.value(entry, MF.action)
    }


def _step(graph: rdflib.Graph, request: Any) -> Step:
    def headers(of: Any) -> dict[str, str]:
        listed = graph.value(of, HT.headers)
        fields = Collection(graph, listed) if listed else []
        return {str(graph.value(f, HT.fieldName)): str(graph.value(f, HT.fieldValue)) for f in fields}

    def text(of: Any) -> tuple[str, str] | None:
        body = graph.value(of, HT.body)
        if body is None:
            return None
        return str(graph.value(body, CNT.chars)), str(graph.value(body, CNT.characterEncoding))

    sent, response = text(request), graph.value(request, HT.resp)
    wanted, truth = text(response), graph.value(response, MF.expectedBoolean)
    form = graph.value(response, MF.expectedFormat)
    return Step(
        str(graph.value(request, HT.methodName)),
        str(graph.value(request, HT.absolutePath)),
        headers(request),
        b"" if sent is None else sent[0].encode(sent[1]),
        [str(each).rpartition("#")[2] for each in graph.objects(response, MF.expectedStatus)],
        None if form is None else str(form),
        None if truth is None else bool(truth.toPython()),  # pyright: ignore[reportAttributeAccessIssue]
        headers(response).get("content-type"),
        None if wanted is None else wanted[0],
    )


@pytest.fixture(scope="module")
def served(serve):
    return serve()


@pytest.fixture(scope="module")
def protocol(reference: Path) -> dict[str, list[Step]]:
    return manifest(reference / "w3c" / "sparql11" / "protocol", ["manifest.ttl"])


@pytest.fixture(scope="module")
def graph_store(reference: Path) -> dict[str, list[Step]]:
    names = ["manifest-direct.ttl", "manifest-indirect.ttl"]
    return manifest(reference / "w3c" / "sparql11" / "graph-store-protocol", names)


def send(served, step: Step, path: str):
    headers = step.headers | {"accept": step.headers.get("accept", "*/*")}
    return served.request(step.method, path, headers=headers, content=step.body)


def fits(status: int, expected: list[str]) -> bool:
    return any(f"StatusCode{status // 100}xx" == each or STATUS.get(each) == status for each in expected)


@pytest.mark.reference
def test_every_protocol_test_passes_or_is_refused_as_an_update(served, protocol, reference: Path) -> None:
    folder = reference / "w3c" / "sparql11" / "protocol"
    for number in (1, 2, 3):
        served.apply(put(DATA.format(number), (folder / f"data{number}.nt").read_bytes(), shown=False))
    served.apply(put(DATA.format(0), b""))
    assert len(protocol) == PROTOCOL_TESTS
    failed, updating = [], set()
    for name, steps in protocol.items():
        for step in steps:
            answer = send(served, step, step.path)
            if name.startswith("update_"):
                updating.add(name)
                refused = 403 if step.writes else None
                if refused and answer.status_code != refused:
                    failed.append(f"{name}: {answer.status_code}, not the refusal {refused}")
                continue
            failed += [f"{name}: {fault}" for fault in faults(step, answer)]
    assert failed == []
    assert len(updating) == 7


def faults(step: Step, answer) -> list[str]:
    """What the answer lacks."""
    found = []
    if not fits(answer.status_code, step.status):
        found.append(f"{answer.status_code}, not {step.status}: {answer.text[:200]}")
    media = answer.headers["content-type"].partition(";")[0]
    if step.form is not None and media not in FORMATS[step.form]:
        found.append(f"{media}, not {step.form}")
    if step.truth is not None and answer.json()["boolean"] is not step.truth:
        found.append(f"{answer.text}, not {step.truth}")
    return found


@pytest.mark.reference
def test_every_get_and_head_of_the_graph_store_passes(served, graph_store) -> None:
    assert len(graph_store) == GRAPH_STORE_TESTS
    failed, read = [], 0
    for name, steps in graph_store.items():
        written = set[str]()
        for step in steps:
            path = step.path.replace("/gsp", "/graphs", 1).replace("$LOCATION$", CREATED)
            if step.method not in {"GET", "HEAD"}:
                answer = send(served, step, path)
                if answer.status_code != 405:
                    failed.append(f"{name}: {step.method} gets {answer.status_code}, not 405")
                written.add(seed(served, step, CREATED if path == "/graphs" else path))
                continue
            read += 1
            answer = send(served, step, path)
            failed += [f"{name}: {fault}" for fault in (*faults(step, answer), *differences(step, answer))]
        served.apply(*(drop(graph) for graph in written - {DEFAULT_GRAPH}))
    assert failed == []
    assert read == 18


def seed(served, step: Step, path: str) -> str:
    """What the write would have done, through the store; the graph that it is about."""
    url = urlsplit(path)
    indirect = parse_qs(url.query).get("graph")
    graph = indirect[0] if indirect else f"http://www.example{url.path}" if url.path.startswith("/") else path
    graph = DEFAULT_GRAPH if url.query == "default" else graph
    if step.method != "POST" and graph != DEFAULT_GRAPH:
        served.apply(drop(graph))
    for document in turtle_of(step):
        quads = list(ox.parse(document, format=ox.RdfFormat.TURTLE, rename_blank_nodes=True))
        triples = ox.serialize([quad.triple for quad in quads], format=ox.RdfFormat.N_TRIPLES)
        served.apply(put(graph, triples or b"", shown=False))
    return graph


def turtle_of(step: Step) -> list[bytes]:
    """The document, or the parts of a form."""
    media, _, boundary = step.headers.get("content-type", "").partition("boundary=")
    if not boundary:
        return [step.body] if media else []
    parts = step.body.split(f"--{boundary}".encode())[1:-1]
    return [re.split(rb"\r?\n\r?\n", part, maxsplit=1)[1] for part in parts]


def differences(step: Step, answer) -> list[str]:
    """Where type or triples are not those expected."""
    found = []
    if step.type is not None and answer.headers["content-type"] != step.type:
        found.append(f"{answer.headers['content-type']}, not {step.type}")
    if step.method == "HEAD" and answer.content:
        found.append("HEAD has a body")
    if step.graph is not None and answer.status_code == 200:
        got = rdflib.Graph().parse(data=answer.text, format="turtle")
        wanted = rdflib.Graph().parse(data=step.graph, format="turtle")
        if not isomorphic(got, wanted):
            found.append(f"{len(got)} triples, not the {len(wanted)} expected")
    return found


@pytest.mark.reference
def test_the_service_description_is_rdf_and_names_its_endpoint(served) -> None:
    answer = served.get("/sparql/")
    graph = rdflib.Graph().parse(data=answer.text, format="turtle")
    sd = rdflib.Namespace("http://www.w3.org/ns/sparql-service-description#")
    (service,) = graph.subjects(rdflib.RDF.type, sd.Service)
    assert set(graph.objects(service, sd.endpoint)) == {rdflib.URIRef("http://www.example/sparql")}
    assert set(graph.objects(service, sd.supportedLanguage)) == {sd.SPARQL11Query}
    (dataset,) = graph.objects(service, sd.defaultDataset)
    assert (dataset, rdflib.RDF.type, sd.Dataset) in graph
    assert graph.value(dataset, sd.defaultGraph) is not None
    for named in graph.objects(dataset, sd.namedGraph):
        assert graph.value(named, sd.name) is not None
        assert (graph.value(named, sd.graph), rdflib.RDF.type, sd.Graph) in graph
