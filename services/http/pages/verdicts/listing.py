"""The list of verdicts, some at a time."""

import asyncio
from typing import Any, Final
from urllib.parse import quote

from starlette.requests import Request

from predicates.scope import verb_iri
from sdt_kg.errors import InputError, UnknownEntityError
from sdt_kg.iri import LAW, Iri, body_iri, local_name, model_iri
from sdt_kg.task import Verb
from services.http.api.read import OUTCOMES, SPELLED, of_models
from services.http.pages.kinds import standings
from services.http.pages.stored import MOST, Known, rows
from services.http.pages.view import CSV, Json, View, here, sorted_by
from services.http.problems import RefusedError
from services.http.protocol.exchange import check_spelling
from services.http.world import World
from services.versions import outdated

PAGE: Final = 200
"""Verdicts at a time; the query asks for one more, to know whether there are more."""
COLUMNS: Final = (
    "kitchen", "robot", "task", "container", "outcome", "outdated", "about_served", "kinds", "proved",
    "drive", "seconds", "kitchen_hash", "robot_hash", "verdict",
)  # fmt: skip
SORTS: Final = ("kitchen", "robot", "task", "outcome", "drive", "seconds")
"""Columns to sort by, each in one direction: texts from a to z, seconds from the longest."""
FILTERS: Final = ("kitchen", "robot", "container", "task", "outcome")


async def listing(request: Request) -> View:
    """Verdicts by kitchen, container and robot, from where the page before ended."""
    world: World = request.app.state.world
    check_spelling(request.query_params.multi_items(), FILTERS)
    wanted = {name: request.query_params.get(name, "").strip() for name in FILTERS}
    after = request.query_params.get("after", "")
    by = sorted_by(request, SORTS)
    known: dict[str, Known] = {"by": ("text", "" if by == SORTS[0] else by)}
    known |= {f"of_{name}": ("text", value) for name, value in _iris(world, wanted).items()}
    found, more = await _page(world, after, known)
    while more and request.state.media == CSV:  # a table to take along is whole
        rest, more = await _page(world, more, known)
        found += rest
        if len(found) > MOST:
            raise RefusedError(
                413,
                f"there are more than {MOST} such verdicts",
                remedy="name a kitchen or robot, or ask /sparql",
            )
    listed = await asyncio.to_thread(lambda: [_row(world, each) for each in found])
    following = here(request, after=more) if more else None
    data: Json = {"filters": wanted, "sort": by, "verdicts": listed, "next": following}
    shown: Json = {
        "choices": {
            "kitchen": list(world.kitchens),
            "robot": sorted(
                {local_name(robot) for kitchen in world.kitchens.values() for robot in kitchen.twin.robots}
            ),
            "task": [each.value for each in Verb],
            "outcome": list(OUTCOMES),
        },
        "first": here(request, after=None) if after else None,
        "page_size": PAGE,
        "sorts": {each: here(request, sort=each, after=None) for each in SORTS},
    }
    return View("verdicts", data, listed, COLUMNS, shown)


async def _page(world: World, after: str, known: dict[str, Known]) -> tuple[list[dict[str, str]], str | None]:
    """Rows that come after a key, and the key after which there are more."""
    found = await rows(world, "verdicts", after=("text", after), **known)
    return found[:PAGE], found[PAGE - 1]["key"] if len(found) > PAGE else None


def _iris(world: World, wanted: dict[str, str]) -> dict[str, Iri]:
    """IRI of what each filter names; the empty text where it asks for nothing.

    Raises:
        UnknownEntityError: No such task or outcome.
        InputError: A container without its kitchen, where several are served.
    """
    task, outcome = wanted["task"], wanted["outcome"]
    if task and task not in {each.value for each in Verb}:
        raise UnknownEntityError("task", task, [each.value for each in Verb])
    if outcome and outcome not in OUTCOMES:
        raise UnknownEntityError("outcome", outcome, OUTCOMES)
    return {
        "environment": model_iri(wanted["kitchen"]) if wanted["kitchen"] else "",
        "robot": model_iri(wanted["robot"]) if wanted["robot"] else "",
        "container": _container(world, wanted["kitchen"], wanted["container"]),
        "task": verb_iri(Verb(task)) if task else "",
        "outcome": LAW + OUTCOMES[outcome] if outcome else "",
    }


def _container(world: World, kitchen: str, container: str) -> Iri:
    """IRI of a container by its name, in the kitchen that is named, else in the one that has it."""
    if not container:
        return ""
    if kitchen:
        return body_iri(kitchen, container)
    having = [
        each.name
        for each in world.kitchens.values()
        if any(container == one.name for one in each.twin.containers())
    ]
    if len(having) > 1 or (not having and len(world.kitchens) != 1):
        raise InputError(
            f"'{container}' may be of several kitchens" if having else f"no kitchen here has a '{container}'",
            allowed=", ".join(having or world.kitchens) or "none is served",
            remedy="name the kitchen too",
        )
    return body_iri(having[0] if having else next(iter(world.kitchens)), container)


def _row(world: World, row: dict[str, str]) -> Json:
    found: dict[str, Any] = {
        "kitchen": local_name(row["environment"]),
        "robot": local_name(row["robot"]) if "robot" in row else None,
        "task": local_name(row["task"]).lower() if "task" in row else None,
        "container": local_name(row["container"]) if "container" in row else None,
        "outcome": SPELLED[local_name(row["outcome"])],
        "outdated": bool(outdated(row)),
        "kinds": [
            each.value.key
            for each in standings(local_name(row["outcome"]), row.get("kinds", ""))
            if each.value.key != "certified"
        ],
        "proved": row.get("proved") == "true" if local_name(row["outcome"]) == "NotCertified" else None,
        "drive": row.get("drive"),
        "seconds": round(float(row["seconds"]), 3),
        "verdict": row["verdict"],
    }
    return found | of_models(world, row) | {"link": "/id/verdict/" + quote(local_name(row["verdict"]))}
