"""The start page: what is served, how much of it is judged, and where to go from here."""

from collections import Counter, defaultdict

from starlette.requests import Request

from sdt_kg.iri import Iri, local_name
from services.http.api.read import SPELLED
from services.http.pages.stored import rows
from services.http.pages.view import Json, View
from services.http.world import World
from services.versions import outdated


async def home(request: Request) -> View:
    """Kitchens with their robots, and how many verdicts are kept about each."""
    world: World = request.app.state.world
    counts: dict[Iri, Counter[str]] = defaultdict(Counter)
    for row in await rows(world, "outcomes"):
        said = "outdated" if outdated(row) else SPELLED[local_name(row["outcome"])]
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
    columns = ("name", "iri", "containers", "robots", "certified", "not_certified", "abstained", "outdated")
    listed = [each | each["verdicts"] for each in (*kitchens, *others)]
    return View("home", {"kitchens": kitchens, "not_served": others}, listed, columns)
