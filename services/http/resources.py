"""`/id/…`: every resource of the graphs, as a page for people and as RDF for machines."""

import pyoxigraph as ox
from starlette.requests import Request
from starlette.responses import Response

from sdt_kg.iri import ID, LAW, RDF, Iri
from services.http.pages.graph.entity import entity
from services.http.pages.verdicts.one import verdict
from services.http.pages.verdicts.results import result
from services.http.pages.view import MEDIA, View, answered, path_of
from services.http.problems import RefusedError
from services.http.protocol.exchange import check_acceptable, respond
from services.http.protocol.graphs import graph_quads, graph_response
from services.http.protocol.negotiate import HTML
from services.store.workers import Asked, Workers
from services.store.workers.evaluate import GRAPHS

RDF_MEDIA = {
    "ttl": "text/turtle",
    "nt": "application/n-triples",
    "trig": "application/trig",
    "jsonld": "application/ld+json",
}
"""Ending of an address → format, for who cannot send an Accept header."""
MOST = 2000
"""Quads of a page, each way."""


async def identified(request: Request) -> Response:
    """The resource whose IRI ends like this URL; with `.json` or `.csv` after it, the data of its page."""
    workers: Workers = request.app.state.world.workers
    iri = ID + path_of(request).removeprefix("/id/")
    taken = check_acceptable(request, (*GRAPHS, HTML))
    stem, _, ending = iri.rpartition(".")
    if iri.startswith(f"{ID}graph/") and taken[0] != HTML:
        return await _graph_in(request, iri, stem, RDF_MEDIA.get(ending))
    quads = await _about(workers, iri)
    if not quads and ending in {*MEDIA, *RDF_MEDIA}:
        if ending in RDF_MEDIA and stem.startswith(f"{ID}graph/"):
            return await _graph_in(request, iri, stem, RDF_MEDIA[ending])
        quads, iri = await _about(workers, stem), stem
        if quads and ending in MEDIA:
            return answered(request, await _view(request, iri, quads), MEDIA[ending])
        taken = (RDF_MEDIA.get(ending, taken[0]),)
    if not quads:
        raise RefusedError(404, f"nothing is known about <{iri}>", remedy="/sparql answers what is")
    if taken[0] == HTML:
        return answered(request, await _view(request, iri, quads), HTML)
    return await _present(request, iri, taken[0])


async def _present(request: Request, iri: Iri, media: str) -> Response:
    """What holds now of the resource: other states, models and branches are there by name alone."""
    workers: Workers = request.app.state.world.workers
    found = await workers.ask(Asked("present", iri, accepted=(media,)))
    if not found.found:
        raise RefusedError(
            404,
            f"nothing holds now of <{iri}>: it is in named graphs alone, of another state or branch say",
            remedy="its page, or SELECT with GRAPH ?g at /sparql, says in which; /graphs?graph=IRI has each",
        )
    return respond(request, found)


async def _graph_in(request: Request, iri: Iri, stem: Iri, media: str | None) -> Response:
    """A graph as the reader accepts it, or as the ending of its address has it."""
    if media is not None:
        workers: Workers = request.app.state.world.workers
        found = await workers.ask(Asked("graph", stem, accepted=(media,)))
        if found.found:
            return respond(request, found)
    return await graph_response(request, iri)


async def about(request: Request) -> View:
    """The page of whatever has the IRI of the parameter: of a term of a vocabulary, say."""
    iri = request.query_params.get("iri", "")
    if not iri or any(each in iri for each in ' <>"{}|\\^`'):
        raise RefusedError(400, f"'{iri[:200]}' is no IRI", allowed="the parameter 'iri'")
    quads = await _about(request.app.state.world.workers, iri)
    if not quads:
        raise RefusedError(404, f"nothing is known about <{iri}>", remedy="/console answers what is")
    return await _view(request, iri, quads)


async def _about(workers: Workers, iri: Iri) -> list[ox.Quad]:
    """Quads that mention an IRI, and if it is a graph's, what is in it."""
    asked = await workers.ask(Asked("about", iri, rows=MOST))
    quads = list(dict.fromkeys(ox.parse(asked.body, format=ox.RdfFormat.N_QUADS)))
    return quads + (await _graph(workers, iri) if iri.startswith(f"{ID}graph/") else [])


async def _view(request: Request, iri: Iri, quads: list[ox.Quad]) -> View:
    """The page of a verdict, of a task's result, or of anything else."""
    workers: Workers = request.app.state.world.workers
    judged, task = (
        (ox.NamedNode(iri), ox.NamedNode(RDF + "type"), ox.NamedNode(LAW + kind))
        for kind in ("Verdict", "TaskResult")
    )
    for quad in quads:
        said = (quad.subject, quad.predicate, quad.object)
        if said in {judged, task} and isinstance(quad.graph_name, ox.NamedNode):
            record = await graph_quads(workers, quad.graph_name.value)
            return (verdict if said == judged else result)(request, iri, record)
    return entity(request, iri, quads, MOST)


async def _graph(workers: Workers, iri: Iri) -> list[ox.Quad]:
    """The subjects of a graph, as if the graph mentioned each: a page that leads on."""
    answered = await workers.ask(Asked("graph", iri, accepted=("application/n-triples",)))
    subjects = {quad.subject: None for quad in ox.parse(answered.body, format=ox.RdfFormat.N_TRIPLES)}
    node, says = ox.NamedNode(iri), ox.NamedNode("http://purl.org/dc/terms/subject")
    return [ox.Quad(node, says, subject, node) for subject in list(subjects)[:MOST]]
