"""What this service is and what it holds: SPARQL 1.1 Service Description and VoID."""

from collections.abc import Iterator
from functools import lru_cache
from typing import Final

import pyoxigraph as ox
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response

from sdt_kg.iri import DCTERMS, PREFIXES, RDF, RDFS, XSD, Iri
from services.http.protocol.exchange import check_acceptable, respond, serialized
from services.http.protocol.negotiate import HTML
from services.store.workers import Asked
from services.store.workers.evaluate import GRAPHS, TABLES

SD: Final = "http://www.w3.org/ns/sparql-service-description#"
VOID: Final = "http://rdfs.org/ns/void#"
FORMATS: Final = "http://www.w3.org/ns/formats/"
FORMAT_NAMES: Final = (
    "SPARQL_Results_JSON", "SPARQL_Results_XML", "SPARQL_Results_CSV", "SPARQL_Results_TSV",
    "Turtle", "N-Triples", "TriG", "JSON-LD",
)  # fmt: skip
MOST_GRAPHS: Final = 1000
"""Named graphs that are described one by one; their number is always given."""
COUNTS: Final = "SELECT ?g (COUNT(*) AS ?n) { GRAPH ?g { ?s ?p ?o } } GROUP BY ?g"
DEFAULT_COUNT: Final = "SELECT (COUNT(*) AS ?n) { ?s ?p ?o }"

Triples = Iterator[tuple[Iri, Iri, ox.NamedNode | ox.Literal]]


async def description(request: Request) -> Response:
    """The service described, as RDF; for people, the console."""
    taken = check_acceptable(request, (*GRAPHS, HTML))
    if taken[0] == HTML:
        return RedirectResponse("/console", 303, {"Vary": "Accept"})
    endpoint = f"{request.url.scheme}://{request.headers['host']}/sparql"
    counts, whole = await _counts(request)
    triples = [
        ox.Triple(ox.NamedNode(subject), ox.NamedNode(predicate), value)
        for subject, predicate, value in (*_service(endpoint), *_dataset(endpoint, counts, whole))
    ]
    return respond(request, serialized(triples, taken[0], PREFIXES | {"sd": SD, "void": VOID}))


async def _counts(request: Request) -> tuple[dict[Iri, int], int]:
    """Triples of each named graph, and of the default graph; counted once for each change."""
    world = request.app.state.world
    known = getattr(request.app.state, "counts", None)
    if known is None or known[0] != world.version:
        version = world.version
        rows = await _rows(request, COUNTS)
        whole = await _rows(request, DEFAULT_COUNT)
        counts = {row["g"].value: int(row["n"].value) for row in rows}
        known = request.app.state.counts = (version, counts, int(whole[0]["n"].value))
    return known[1], known[2]


async def _rows(request: Request, query: str) -> list[ox.QuerySolution]:
    answered = await request.app.state.world.workers.ask(Asked("query", query, accepted=tuple(TABLES)))
    parsed = ox.parse_query_results(answered.body, format=TABLES[answered.media])
    assert isinstance(parsed, ox.QuerySolutions), "a SELECT"
    return list(parsed)


def _service(endpoint: str) -> Triples:
    service = endpoint + "#service"
    yield service, RDF + "type", ox.NamedNode(SD + "Service")
    yield service, SD + "endpoint", ox.NamedNode(endpoint)
    yield service, SD + "supportedLanguage", ox.NamedNode(SD + "SPARQL11Query")
    for name in FORMAT_NAMES:
        yield service, SD + "resultFormat", ox.NamedNode(FORMATS + name)
    yield service, SD + "defaultDataset", ox.NamedNode(endpoint + "#dataset")


def _dataset(endpoint: str, counts: dict[Iri, int], whole: int) -> Triples:
    dataset, default = endpoint + "#dataset", endpoint + "#default"
    for kind in (SD + "Dataset", VOID + "Dataset"):
        yield dataset, RDF + "type", ox.NamedNode(kind)
    yield dataset, DCTERMS + "title", ox.Literal("Semantic digital twins and verdicts about them")
    yield dataset, VOID + "sparqlEndpoint", ox.NamedNode(endpoint)
    yield dataset, VOID + "triples", _integer(sum(counts.values()))
    yield dataset, VOID + "uriSpace", ox.Literal(PREFIXES["id"])
    for prefix in ("sdt", "tee", "law"):
        yield dataset, VOID + "vocabulary", ox.NamedNode(PREFIXES[prefix])
    yield dataset, SD + "defaultGraph", ox.NamedNode(default)
    yield default, RDF + "type", ox.NamedNode(SD + "Graph")
    yield default, VOID + "triples", _integer(whole)
    yield (
        default,
        RDFS + "comment",
        ox.Literal("Entities, present states, verdicts and observations, merged."),
    )
    yield dataset, RDFS + "comment", ox.Literal(f"{len(counts)} named graphs")
    for graph, count in sorted(counts.items())[:MOST_GRAPHS]:
        part = f"{endpoint}#graph-{_key(graph)}"
        yield dataset, SD + "namedGraph", ox.NamedNode(part)
        yield part, RDF + "type", ox.NamedNode(SD + "NamedGraph")
        yield part, SD + "name", ox.NamedNode(graph)
        yield part, SD + "graph", ox.NamedNode(part + "-content")
        yield part + "-content", RDF + "type", ox.NamedNode(SD + "Graph")
        yield part + "-content", VOID + "triples", _integer(count)


@lru_cache(MOST_GRAPHS)
def _key(graph: Iri) -> str:
    """A fragment for a graph's own node in the description."""
    return "".join(each if each.isalnum() else "-" for each in graph.partition("://")[2] or graph)


def _integer(value: int) -> ox.Literal:
    return ox.Literal(str(value), datatype=ox.NamedNode(XSD + "integer"))
