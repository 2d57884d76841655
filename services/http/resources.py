"""`/id/…`: every resource of the graphs, as a page for people and as RDF for machines."""

import pyoxigraph as ox
from starlette.requests import Request
from starlette.responses import Response

from sdt_kg.errors import InputError
from sdt_kg.iri import ID, LAW, PREFIXES, RDF, Iri
from services.http.pages import resource
from services.http.problems import RefusedError
from services.http.protocol.exchange import check_acceptable, respond, serialized
from services.http.protocol.graphs import graph_response
from services.http.protocol.negotiate import HTML
from services.store.workers import Asked, Workers
from services.store.workers.evaluate import GRAPHS
from services.why import why

MOST = 2000
"""Quads of a page, each way."""


async def identified(request: Request) -> Response:
    """The resource whose IRI ends like this URL."""
    workers: Workers = request.app.state.world.workers
    raw: bytes = request.scope.get("raw_path") or request.scope["path"].encode()
    iri = ID + raw.decode("ascii", "replace").partition("?")[0].removeprefix("/id/")
    taken = check_acceptable(request, (*GRAPHS, HTML))
    if iri.startswith(f"{ID}graph/") and taken[0] != HTML:
        return await graph_response(request, iri)
    answered = await workers.ask(Asked("about", iri, rows=MOST))
    quads = list(ox.parse(answered.body, format=ox.RdfFormat.N_QUADS))
    if iri.startswith(f"{ID}graph/"):
        quads += await _graph(workers, iri)
    if not quads:
        raise RefusedError(404, f"nothing is known about <{iri}>", remedy="/sparql answers what is")
    if taken[0] == HTML:
        return resource(iri, quads, await _story(workers, iri, quads))
    triples = list(dict.fromkeys(quad.triple for quad in quads))
    return respond(request, serialized(triples, taken[0], PREFIXES))


async def _graph(workers: Workers, iri: Iri) -> list[ox.Quad]:
    """The subjects of a graph, as if the graph mentioned each: a page that leads on."""
    answered = await workers.ask(Asked("graph", iri, accepted=("application/n-triples",)))
    subjects = {quad.subject: None for quad in ox.parse(answered.body, format=ox.RdfFormat.N_TRIPLES)}
    node, says = ox.NamedNode(iri), ox.NamedNode("http://purl.org/dc/terms/subject")
    return [ox.Quad(node, says, subject, node) for subject in list(subjects)[:MOST]]


async def _story(workers: Workers, iri: Iri, quads: list[ox.Quad]) -> str:
    """A verdict in plain words; empty for anything else."""
    kind = (ox.NamedNode(iri), ox.NamedNode(RDF + "type"), ox.NamedNode(LAW + "Verdict"))
    for quad in quads:
        if (quad.subject, quad.predicate, quad.object) == kind and isinstance(quad.graph_name, ox.NamedNode):
            try:
                return why(await verdict_quads(workers, quad.graph_name.value), iri)
            except InputError as error:
                return f"This record cannot be read: {error}"
    return ""


async def verdict_quads(workers: Workers, graph: Iri) -> list[ox.Quad]:
    """The quads of a named graph."""
    answered = await workers.ask(Asked("graph", graph, accepted=("application/n-triples",)))
    node = ox.NamedNode(graph)
    parsed = ox.parse(answered.body, format=ox.RdfFormat.N_TRIPLES)
    return [ox.Quad(quad.subject, quad.predicate, quad.object, node) for quad in parsed]
