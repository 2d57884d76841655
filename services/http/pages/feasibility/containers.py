"""Containers of a kitchen: how they move, where they are, and what is not counted."""

import asyncio
import math
from typing import Final

from starlette.requests import Request

from sdt_kg.iri import local_name
from sdt_kg.task import Task, Verb
from services.app import Service
from services.http.api.read import finite
from services.http.pages.feasibility.asked import Asked, asked_of, moved
from services.http.pages.view import Json, View, here, sorted_by

COLUMNS: Final = (
    "name", "kind", "joint", "handle", "lower", "upper", "open_from", "closed_to", "position", "is",
    "driven_by", "velocity", "acceleration", "iri",
)  # fmt: skip
NUMBERS: Final = ("position", "closed_to", "open_from", "lower", "upper")
SORTS: Final = ("name", "kind", "is", *NUMBERS, "joint", "handle")
"""Columns to sort by, each in one direction: texts from a to z, numbers from the largest."""


async def containers(request: Request) -> View:
    """The page of a kitchen's containers, in a state."""
    asked = asked_of(request, request.app.state.world)
    met, left_out = await asyncio.gather(
        asyncio.to_thread(_met, asked.kitchen.service.at(*asked.states)),
        asyncio.to_thread(asked.twin.left_out),
    )
    by = sorted_by(request, SORTS)
    listed = sorted(_listed(asked, met), key=lambda each: _rank(each[by]))
    data: Json = {
        "kitchen": asked.kitchen.name,
        "iri": asked.twin.environment,
        "state": list(asked.states),
        "sort": by,
        "moved": moved(asked.twin),
        "containers": listed,
        "left_out": [
            {"joint": local_name(each.joint), "body": local_name(each.body), "reason": each.reason}
            for each in left_out
        ],
        "notes": list(asked.twin.notes),
    }
    shown: Json = {"sorts": {each: here(request, sort=each) for each in SORTS}, "numbers": NUMBERS}
    return View("containers", data, listed, COLUMNS, shown)


def _rank(value: str | float | None) -> tuple[float, str]:
    """Where a row stands: a number that is not there comes last."""
    if isinstance(value, str):
        return 0.0, value
    return (math.inf if value is None else -value), ""


def _met(service: Service) -> dict[str, str]:
    """Container → `open` or `closed`, by the requests that the state meets; in between it is not here."""
    words = {Verb.OPEN: "open", Verb.CLOSE: "closed"}
    tasks = (answer.case.task for answer in service.satisfies())
    return {
        task.container: words[task.verb]
        for task in tasks
        if isinstance(task, Task) and isinstance(task.container, str)
    }


def _listed(asked: Asked, met: dict[str, str]) -> list[Json]:
    return [
        {
            "name": each.name,
            "iri": each.iri,
            "kind": each.kind,
            "joint": local_name(each.joint),
            "driven_by": None if each.joint == each.active_joint else local_name(each.active_joint),
            "handle": local_name(each.handle),
            "unit": "rad" if each.kind == "door" else "m",
            "lower": finite(each.lower),
            "upper": finite(each.upper),
            "open_from": finite(each.open_from),
            "closed_to": finite(each.closed_to),
            "velocity": finite(each.velocity),
            "acceleration": finite(each.acceleration),
            "position": asked.twin.state.get(each.joint),
            "is": met.get(each.iri, "in between"),
        }
        for each in asked.twin.containers()
    ]
