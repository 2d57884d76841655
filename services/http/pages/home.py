"""The start page: what is served, how much of it is judged, and where to go from here."""

import asyncio
from collections import Counter, defaultdict

from starlette.requests import Request

from predicates.record.inputs import UNKNOWN_INPUT
from sdt_kg.iri import Iri, local_name
from services.http.api.read import SPELLED
from services.http.kitchens import Kitchen
from services.http.pages.stored import rows
from services.http.pages.view import Json, View
from services.http.world import World
from services.versions import outdated


async def home(request: Request) -> View:
    """Kitchens with their robots, and how many verdicts are kept about each."""
    world: World = request.app.state.world
    counts: dict[Iri, Counter[str]] = defaultdict(Counter)
    served = {kitchen.twin.environment: kitchen for kitchen in world.kitchens.values()}
    found = await rows(world, "outcomes")
    standings = await asyncio.to_thread(
        lambda: [_standing(served.get(row["environment"]), row) for row in found]
    )
    for row, said in zip(found, standings, strict=True):
        counts[row["environment"]][said] += int(row["verdicts"])
    kitchens: list[Json] = [
        {
            "name": kitchen.name,
            "iri": kitchen.twin.environment,
            "containers": len(kitchen.twin.containers()),
            "doors": sum(each.kind == "door" for each in kitchen.twin.containers()),
            "robots": [local_name(robot) for robot in kitchen.twin.robots],
            "verdicts": counts.pop(kitchen.twin.environment, {}),
        }
        for kitchen in world.kitchens.values()
    ]
    others: list[Json] = [
        {"name": local_name(iri), "iri": iri, "verdicts": found} for iri, found in sorted(counts.items())
    ]
    columns = (
        "name",
        "iri",
        "containers",
        "robots",
        "certified",
        "not_certified",
        "abstained",
        "outdated",
        "other_models",
    )
    listed = [each | each["verdicts"] for each in (*kitchens, *others)]
    return View("home", {"kitchens": kitchens, "not_served": others}, listed, columns)


def _standing(kitchen: Kitchen | None, row: dict[str, str]) -> str:
    """What verdicts count as: as in the matrix of their kitchen, if that is served, no robot need be."""
    models = row.get("environment_model", ""), row.get("robot_model", UNKNOWN_INPUT)
    if kitchen is not None and not kitchen.is_subject(*models):
        return "other_models"
    return "outdated" if outdated(row) else SPELLED[local_name(row["outcome"])]
