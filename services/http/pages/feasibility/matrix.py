"""The feasibility matrix: every container of a kitchen for every robot, as far as anybody has judged it."""

from collections import Counter
from itertools import accumulate
from typing import Final
from urllib.parse import urlencode

from starlette.requests import Request

from sdt_kg.errors import InputError
from sdt_kg.iri import Iri, local_name
from sdt_kg.scope import D_ARTIC, TEE_CLASSES
from services.http.pages.feasibility.asked import Asked, asked_of, moved
from services.http.pages.feasibility.cells import Kept, cells_of, common_settings, kept_verdicts, unlike
from services.http.pages.kinds import LEGEND, Standing
from services.http.pages.view import Json, View, here
from services.http.world import World

COLUMNS: Final = (
    "kitchen", "robot", "container", "container_kind", "task", "drive", "friction", "standing", "was",
    "kinds", "proved", "reason", "others", "disagree", "differs", "verdict",
)  # fmt: skip
SHOWN: Final = ("all", "certified", "not certified", "not judged")
"""Which rows are shown; whatever is shown, all are counted."""
IN_PROGRESS: Final = {Standing.WAITING.value.key, Standing.BEING_JUDGED.value.key}
UNANSWERED: Final = {each.value.key for each in (Standing.OUTDATED, Standing.NOT_JUDGED, Standing.NO_VERDICT)}
"""How cases stand that can be asked about."""
OPEN: Final = {*UNANSWERED, *IN_PROGRESS}


async def matrix(request: Request) -> View:
    """The page of a kitchen."""
    world: World = request.app.state.world
    asked = asked_of(request, world)
    shown = _choice(request, "show", SHOWN, "all")
    asking = request.app.state.asking.as_it_is()
    kept = await kept_verdicts(world, asked)
    robots = list(dict.fromkeys([*asked.twin.robots, *sorted(each.robot for each in kept.shown)]))
    cells = list(cells_of(asked, robots, kept.shown, asking))
    data: Json = {
        "kitchen": asked.kitchen.name,
        "iri": asked.twin.environment,
        "task": asked.verb.value,
        "drive": asked.drive.value if asked.drive else None,
        "friction": asked.friction,
        "class": asked.tee.name,
        "state": list(asked.states),
        "moved": moved(asked.twin),
        "robots": [_robot(asked, robot, cells) for robot in robots],
        "cells": cells,
        "settings": common_settings(kept.shown),
        "about_other_models": kept.stale,
        "with_other_drives": kept.other_drives,
        "with_other_frictions": kept.other_frictions,
        "of_other_classes": kept.other_classes,
    }
    outdated = sum(each["standing"] == Standing.OUTDATED.value.key for each in cells)
    more: Json = {
        "lines": _lines(asked, robots, cells, shown),
        "unlike": unlike,
        "legend": (*LEGEND, *([Standing.OUTDATED.value] if outdated else [])),
        "outdated": outdated,
        "unanswered": UNANSWERED,
        "show": shown,
        "in_progress": any(each["standing"] in IN_PROGRESS for each in cells),
        "refused": [each for each in cells if each["reason"]],
        "total": len(asked.twin.containers()),
        "askable": [local_name(robot) for robot in asked.twin.robots] if asked.tee == D_ARTIC else [],
        "classes": [each.name for each in TEE_CLASSES],
        "example": next((f"; or {each.name}=open" for each in asked.twin.containers()), ""),
    }
    return View("matrix", data, cells, COLUMNS, more | _elsewhere(request, asked, kept), script=True)


def _elsewhere(request: Request, asked: Asked, kept: Kept) -> Json:
    """Addresses of what is not shown here, with how many verdicts there are."""
    drives, classes = kept.other_drives.items(), kept.other_classes.items()
    frictions = kept.other_frictions.items()
    states = [("state", each) for each in asked.states]
    return {
        "drive_links": [(count, name, here(request, drive=name)) for name, count in drives],
        "friction_links": [(count, mu, here(request, friction=mu or None)) for mu, count in frictions],
        "class_links": [(count, name, here(request, **{"class": name})) for name, count in classes],
        "state_query": f"?{urlencode(states)}" if states else "",
    }


def _robot(asked: Asked, robot: Iri, cells: list[Json]) -> Json:
    """A column: how many of its cells stand how, and where each group begins in a bar of them."""
    own = [each for each in cells if each["robot"] == local_name(robot)]
    counts = Counter(each["standing"] for each in own)
    found = {each.value.key: counts[each.value.key] for each in Standing if counts[each.value.key]}
    starts = accumulate(found.values(), initial=0)
    return {
        "name": local_name(robot),
        "iri": robot,
        "drive": asked.drive_of(robot),
        "loaded": robot in asked.twin.robots,
        "containers": len(own),
        "standings": found,
        "unjudged": sum(found.get(each, 0) for each in UNANSWERED),
        "bar": [[key, start, count] for (key, count), start in zip(found.items(), starts, strict=False)],
    }


def _lines(asked: Asked, robots: list[Iri], cells: list[Json], shown: str) -> list[Json]:
    """The rows of the matrix that are shown: a container and its cells."""
    width = len(robots)
    lines = [
        {"container": container, "cells": cells[index * width : (index + 1) * width]}
        for index, container in enumerate(asked.twin.containers())
    ]
    return [
        line
        for line in lines
        if not width or any(_is_shown(cell["standing"], shown) for cell in line["cells"])
    ]


def _is_shown(standing: str, shown: str) -> bool:
    certified, unknown = standing == Standing.CERTIFIED.value.key, standing in OPEN
    return {
        "all": True,
        "certified": certified,
        "not certified": not certified and not unknown,
        "not judged": unknown,
    }[shown]


def _choice(request: Request, name: str, allowed: tuple[str, ...], default: str) -> str:
    """A parameter that has one of some values.

    Raises:
        InputError: It has another.
    """
    value = request.query_params.get(name, default)
    if value not in allowed:
        raise InputError(f"no '{name}' of '{value}'", allowed=", ".join(allowed))
    return value
