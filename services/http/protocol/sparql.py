"""`/sparql`: SPARQL 1.1 Protocol, the query operation; an update is refused, as the text allows."""

from starlette.requests import Request
from starlette.responses import Response

from sdt_kg.iri import Iri
from services.http.problems import RefusedError
from services.http.protocol.describe import description
from services.http.protocol.exchange import (
    UTF_8,
    Pairs,
    check_acceptable,
    check_spelling,
    content_type,
    own_url,
    pairs,
    query_string,
    respond,
    single,
)
from services.store.workers import Asked, Workers
from services.store.workers.evaluate import GRAPHS, TABLES

FORM = "application/x-www-form-urlencoded"
QUERY = "application/sparql-query"
UPDATE = "application/sparql-update"
DEFAULT, NAMED = "default-graph-uri", "named-graph-uri"
NO_UPDATE = "writes go through the verbs under /api/v1"


async def sparql(request: Request) -> Response:
    """Answer a query; without one, describe the service."""
    workers: Workers = request.app.state.world.workers
    url = query_string(request)
    if request.method in {"GET", "HEAD"}:
        text = _query_of(url)
        if text is None:
            return await description(request)
    else:
        text, url = await _posted(request, url)
    check_spelling(url, (DEFAULT, NAMED))
    taken = check_acceptable(request, (*TABLES, *GRAPHS))
    answered = await workers.ask(
        Asked(
            "query",
            text,
            accepted=taken,
            base=own_url(request),
            default_graphs=_graphs(url, DEFAULT),
            named_graphs=_graphs(url, NAMED),
        )
    )
    return respond(request, answered)


async def _posted(request: Request, url: Pairs) -> tuple[str, Pairs]:
    """The query of a POST, and all parameters; 2.1.2 and 2.1.3 of the recommendation."""
    media, charset = content_type(request)
    if media not in {FORM, QUERY, UPDATE}:
        raise RefusedError(
            415,
            f"a query cannot be sent as '{media or 'nothing'}'",
            allowed=f"{FORM}, {QUERY}",
            headers={"Accept-Post": f"{FORM}, {QUERY}"},
        )
    if charset not in UTF_8:
        raise RefusedError(415, f"the query is in {charset}", allowed="UTF-8")
    if media == UPDATE:
        raise RefusedError(403, "this endpoint does no updates", remedy=NO_UPDATE)
    body = await request.body()
    if media == FORM:
        parameters = url + pairs(body)
        text = _query_of(parameters, posted=True)
        if text is None:
            raise RefusedError(400, "there is no parameter 'query'", allowed="one")
        return text, parameters
    if any(name == "query" for name, _ in url):
        raise RefusedError(400, "there is a query in the URL and another in the body", allowed="one")
    try:
        return body.decode("utf-8"), url
    except UnicodeDecodeError:
        raise RefusedError(400, "the query is not UTF-8", allowed="UTF-8") from None


def _query_of(parameters: Pairs, *, posted: bool = False) -> str | None:
    """The one query among the parameters, if it is there and no update is."""
    names = {name for name, _ in parameters}
    updating = names & {"update", "using-graph-uri", "using-named-graph-uri"}
    if updating and (not posted or "query" in names):
        raise RefusedError(400, f"'{min(updating)}' is no parameter of a query", remedy=NO_UPDATE)
    if updating:
        raise RefusedError(403, "this endpoint does no updates", remedy=NO_UPDATE)
    return single(parameters, "query")


def _graphs(parameters: Pairs, name: str) -> tuple[Iri, ...]:
    return tuple(value for key, value in parameters if key == name)
