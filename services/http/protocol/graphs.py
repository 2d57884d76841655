"""`/graphs`: SPARQL 1.1 Graph Store HTTP Protocol, GET and HEAD.

Indirect: `/graphs?graph=IRI` and `/graphs?default`. Direct: `/graphs/NAME`, where the URL itself is the
IRI of the graph.
"""

import pyoxigraph as ox
from starlette.requests import Request
from starlette.responses import Response

from sdt_kg.iri import Iri
from services.http.problems import RefusedError
from services.http.protocol.describe import description
from services.http.protocol.exchange import check_acceptable, own_url, query_string, respond, single
from services.store.workers import DEFAULT_GRAPH, Asked, Workers
from services.store.workers.evaluate import GRAPHS


async def graphs(request: Request) -> Response:
    """One whole graph; without parameters, what there is."""
    parameters = query_string(request)
    names = {name for name, _ in parameters}
    if "default" in names and "graph" in names:
        raise RefusedError(400, "'graph' and 'default' are both there", allowed="one of them")
    if "default" in names:
        return await graph_response(request, DEFAULT_GRAPH)
    graph = single(parameters, "graph")
    if graph == "":
        raise RefusedError(400, "the parameter 'graph' is empty", allowed="an absolute IRI, or 'default'")
    if graph is not None:
        return await graph_response(request, graph)
    if request.scope["path"].rstrip("/") == "/graphs":
        return await description(request)
    return await graph_response(request, own_url(request))


async def graph_response(request: Request, graph: str) -> Response:
    """A graph in the format that the client likes best."""
    workers: Workers = request.app.state.world.workers
    taken = check_acceptable(request, tuple(GRAPHS))
    answered = await workers.ask(Asked("graph", graph, accepted=taken))
    if not answered.found:
        raise RefusedError(404, f"there is no graph <{graph}>", remedy="/graphs describes what there is")
    return respond(request, answered)


async def graph_quads(workers: Workers, graph: Iri) -> list[ox.Quad]:
    """The quads of a named graph."""
    answered = await workers.ask(Asked("graph", graph, accepted=("application/n-triples",)))
    node = ox.NamedNode(graph)
    parsed = ox.parse(answered.body, format=ox.RdfFormat.N_TRIPLES)
    return [ox.Quad(quad.subject, quad.predicate, quad.object, node) for quad in parsed]
