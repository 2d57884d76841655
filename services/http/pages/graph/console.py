"""The SPARQL console: a query in the URL, its answer as a table, and as CSV, JSON or Turtle."""

import json
import re
from dataclasses import dataclass
from functools import cache, partial
from itertools import islice
from typing import Any, Final
from urllib.parse import urlencode

import pyoxigraph as ox
from starlette.requests import Request
from starlette.responses import HTMLResponse, Response
from starlette.routing import Route

import ontology
from sdt_kg.errors import InputError
from sdt_kg.iri import PREFIXES
from services.http.pages.terms import cell
from services.http.pages.view import SCRIPTED, Json, View, page
from services.http.problems import RefusedError, status_of
from services.http.protocol.exchange import query_string, respond, single
from services.http.world import World
from services.ontology_page.spelling import absences, unknown_terms
from services.store.workers import Answered, Asked, LimitError

FORMS: Final = {
    "csv": "text/csv",
    "json": "application/sparql-results+json",
    "xml": "application/sparql-results+xml",
    "tsv": "text/tab-separated-values",
    "ttl": "text/turtle",
    "nt": "application/n-triples",
}
"""Ending of the address of an answer → media type."""
TABLE_FORMS: Final = ("csv", "json", "tsv", "xml")
GRAPH_FORMS: Final = ("ttl", "nt")
MOST: Final = 5000
"""Rows or triples that a page takes; downloads take as many as the service does."""
SIZE: Final = 8 * 2**20
"""[bytes] Of the answer on a page."""
ENTITIES: Final = 20
"""That a query names and that are looked for, to tell what is not there."""
PAGE: Final = 200
"""Rows shown at a time."""
START: Final = """SELECT ?container ?robot ?outcome WHERE {
  ?verdict law:container ?container ;
    law:outcome ?outcome ;
    law:robot ?robot .
}
ORDER BY ?container ?robot
LIMIT 100
"""
_PREFIXED: Final = re.compile(r"(?<![\w<])([a-z]\w*):(?=[\w])")
_DECLARED: Final = re.compile(r"^\s*PREFIX\s+(\w*)\s*:", re.IGNORECASE | re.MULTILINE)
_NOT_NAMES: Final = re.compile(r"<[^<>\s]*>|\"[^\"\n]*\"|'[^'\n]*'|#.*$", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Example:
    """A competency question.

    Attributes:
        name: File stem.
        question: In words.
        text: SPARQL.
    """

    name: str
    question: str
    text: str


def console_routes() -> list[Route]:
    """The console, and the answer alone at each ending."""
    return [
        *(Route(f"/console.{form}", partial(_download, media)) for form, media in FORMS.items()),
        Route("/console", _console),
    ]


async def _download(media: str, request: Request) -> Response:
    """The answer alone, whole, to be kept as a file."""
    text = _query(request)
    if text is None:
        raise RefusedError(400, "there is no parameter 'query'", allowed="one")
    asked = Asked("query", with_prefixes(text), accepted=(media,))
    answer = respond(request, await request.app.state.world.workers.ask(asked))
    ending = next(form for form, each in FORMS.items() if each == media)
    answer.headers["Content-Type"] = f"{media}; charset=utf-8" if media.startswith("text/") else media
    answer.headers["Content-Disposition"] = f'attachment; filename="answer.{ending}"'
    return answer


async def _console(request: Request) -> Response:
    """The page; a query that is wrong or too much is told on it, with the status that it has elsewhere."""
    text = _query(request)
    shown: Json = {"query": with_prefixes(START if text is None else text), "examples": examples()}
    shown |= {"example_links": _example_links(), "answer": None, "problem": None, "forms": [], "notes": []}
    status = 200
    if text is not None and text.strip():
        try:
            shown["answer"] = await _answer(request, shown["query"])
            shown["notes"] = await _notes(request, shown["query"])
        except LimitError as error:
            status, shown["problem"] = status_of(error), _told(error)
            shown["problem"]["download"] = _links(shown["query"], (*TABLE_FORMS[:2], GRAPH_FORMS[0]))
        except InputError as error:
            status, shown["problem"] = status_of(error), _told(error)
    view = View("console", {}, None, (), shown, script=True)
    return HTMLResponse(page(request, view), status, {"Content-Security-Policy": SCRIPTED})


def _told(error: InputError) -> Json:
    return {"what": error.what, "allowed": error.allowed, "remedy": error.remedy, "download": []}


async def _answer(request: Request, text: str) -> Json:
    """The answer to a query, for a template."""
    world: World = request.app.state.world
    accepted = (FORMS["json"], FORMS["nt"])
    answered = await world.workers.ask(Asked("query", text, accepted=accepted, rows=MOST, size=SIZE))
    if answered.media == FORMS["nt"]:
        columns, rows = ["subject", "predicate", "object"], _triples(answered)
        return _page_of(request, "triples", columns, rows, _links(text, GRAPH_FORMS))
    parsed = json.loads(answered.body)
    if "boolean" in parsed:
        return {"kind": "truth", "truth": parsed["boolean"], "links": _links(text, ("json", "xml"))}
    found = ox.parse_query_results(answered.body, format=ox.QueryResultsFormat.JSON)
    assert isinstance(found, ox.QuerySolutions), "a SELECT"
    columns = [variable.value for variable in found.variables]
    rows = [[None if each[name] is None else cell(each[name]) for name in columns] for each in found]
    return _page_of(request, "rows", columns, rows, _links(text, TABLE_FORMS))


async def _notes(request: Request, text: str) -> list[str]:
    """What in a query can match nothing: no rows about that are no "no"."""
    workers, notes = request.app.state.world.workers, list(unknown_terms(text))
    for ask, absent in islice(absences(text).items(), ENTITIES):
        found = await workers.ask(Asked("query", ask, accepted=(FORMS["json"],)))
        notes += [] if json.loads(found.body)["boolean"] else [absent]
    return notes


def _triples(answered: Answered) -> list[list[Any]]:
    parsed = ox.parse(answered.body, format=ox.RdfFormat.N_TRIPLES)
    return [[cell(each.subject), cell(each.predicate), cell(each.object)] for each in parsed]


def _page_of(
    request: Request, kind: str, columns: list[str], rows: list[list[Any]], links: list[tuple[str, str]]
) -> Json:
    """Some rows of an answer, and where the others are."""
    pages = max(1, -(-len(rows) // PAGE))
    asked = request.query_params.get("page", "1")
    number = min(pages, int(asked)) if asked.isdecimal() and len(asked) < 9 and int(asked) else 1
    text = with_prefixes(_query(request) or "")
    at = [f"/console?{urlencode({'query': text, 'page': each})}" for each in (number - 1, number + 1)]
    return {
        "kind": kind,
        "columns": columns,
        "rows": rows[(number - 1) * PAGE : number * PAGE],
        "count": len(rows),
        "first": (number - 1) * PAGE + 1,
        "before": at[0] if number > 1 else None,
        "after": at[1] if number < pages else None,
        "links": links,
    }


def _links(text: str, forms: tuple[str, ...]) -> list[tuple[str, str]]:
    more = urlencode({"query": text})
    return [(form, f"/console.{form}?{more}") for form in forms]


def _query(request: Request) -> str | None:
    """The query of the URL; a form writes line ends as two characters."""
    text = single(query_string(request), "query")
    return None if text is None else text.replace("\r\n", "\n")


def with_prefixes(text: str) -> str:
    """The query with a PREFIX line for each known prefix that it uses and does not declare."""
    bare = _NOT_NAMES.sub(" ", text)
    used = set(_PREFIXED.findall(bare)) - set(_DECLARED.findall(bare))
    lines = [f"PREFIX {name}: <{PREFIXES[name]}>\n" for name in sorted(used) if name in PREFIXES]
    return "".join(lines) + text


@cache
def examples() -> tuple[Example, ...]:
    """The competency questions."""
    found: list[Example] = []
    for file in sorted(ontology.path("queries").glob("cq*.rq")):
        text = file.read_text(encoding="utf-8")
        head, _, _ = text.partition("\nPREFIX")
        asked = re.search(r"^# Question\s+(.*)$", head, re.MULTILINE)
        body = "".join(line for line in text.splitlines(keepends=True) if not line.startswith("#"))
        found.append(Example(file.stem, asked[1] if asked else file.stem, body))
    return tuple(found)


def _example_links() -> dict[str, str]:
    return {each.name: f"/console?{urlencode({'query': each.text})}" for each in examples()}
