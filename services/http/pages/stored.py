"""What the graphs say, by the queries that pages ask."""

import json
from functools import cache

from services.http.pages.view import FOLDER, Json
from services.http.world import World
from services.store.workers import Asked

JSON_RESULTS = "application/sparql-results+json"
MOST = 20_000
"""Rows of one page's query; a page that would need more says so."""

Known = tuple[str, str]
"""`iri` or `text`, and which."""


async def rows(world: World, name: str, **known: Known) -> list[dict[str, str]]:
    """Rows of a query of `services/http/queries`, by file stem: variable → IRI or text, where bound."""
    asked = Asked("query", query(name), accepted=(JSON_RESULTS,), known=known, rows=MOST)
    answered = await world.workers.ask(asked)
    bindings: list[Json] = json.loads(answered.body)["results"]["bindings"]
    return [{variable: term["value"] for variable, term in each.items()} for each in bindings]


@cache
def query(name: str) -> str:
    """Text of a query."""
    return (FOLDER / "queries" / f"{name}.rq").read_text(encoding="utf-8")
