"""A placement as JSON and as lines for people."""

from collections.abc import Iterator
from itertools import groupby
from typing import Any

from predicates.margins import AT_LEAST, LOOKED_UP_TO, is_bound
from predicates.record import diagnosis_json
from services.embodiment.place.grid import SIDE, Status
from services.embodiment.place.placement import DECIMALS, Placement, Spot

Json = dict[str, Any]  # JSON object

SIGNS = {Status.CERTIFIED: "#", Status.PROVED: "-", Status.BLOCKED: "x", Status.UNKNOWN: "."}
COLUMNS = ("x", "y", "yaw", "margin", "gripper", "base")
"""Of a pose: [m], [m], [rad], [m], name, as `--base` takes it."""
SHOWN = 5
"""[1] Poses that are printed; JSON has all."""


def to_json(found: Placement) -> Json:
    """Poses, map and what was tried."""
    return {
        "container": found.container,
        "best": None if found.best is None else spot(found.best),
        "spots": [spot(each) for each in found.spots],
        "margins_looked_up_to": LOOKED_UP_TO,
        "impossible": found.impossible,
        "tried": found.tried,
        "diagnoses": [diagnosis_json(each) for each in found.diagnoses],
        "map": {
            "side": SIDE / len(found.rows) if found.rows else None,
            "cells": [
                {"x": cell.x, "y": cell.y, "status": cell.status.value, "margin": cell.margin}
                for row in found.rows
                for cell in row
            ],
        },
        "seconds": round(found.seconds, 3),
    }


def spot(found: Spot) -> dict[str, object]:
    """A pose as a row of `COLUMNS`."""
    row = (found.x, found.y, found.yaw, found.margin, found.gripper, base_of(found))
    return dict(zip(COLUMNS, row, strict=True))


def base_of(found: Spot) -> str:
    """The pose as `--base` takes it, to the last digit that was certified."""
    return ",".join(f"{value:.{DECIMALS}f}" for value in (found.x, found.y, found.yaw))


def none_found(container: str, *, impossible: bool, tried: int) -> str:
    """That no pose was found, how sure that is, and where the search ended."""
    how = "every pose of the map is proved impossible" if impossible else "searched, not proved"
    if not (impossible or tried):
        how += "; no hold was found that follows the handle while the base stands where it can be parked"
    return f"no pose found for {container}: {how}"


def lines(said: Json, friction: float | None = None) -> Iterator[str]:
    """What people read, of the JSON object: poses, as `sdt achieve` asks with that friction; the map."""
    asked = "--drive fixed" if friction is None else f"--drive fixed --friction {friction:g}"
    spots, cells = said["spots"], said["map"]["cells"]
    for each in said["diagnoses"]:
        yield f"{each['kind']}: {each['reason']}"
    for each in spots[:SHOWN]:
        bound = AT_LEAST if is_bound(each["margin"]) else ""
        margin = f"margin {bound}{each['margin'] * 1000:.1f} mm"
        yield f"certified  --base {each['base']} {asked}  gripper {each['gripper']}, {margin}"
    if len(spots) > SHOWN:
        yield f"and {len(spots) - SHOWN} more"
    if not spots and cells:
        yield none_found(said["container"], impossible=said["impossible"], tried=said["tried"])
    if cells:
        yield from _map(said["map"]["side"], cells)
    yield f"{said['tried']} poses asked, {len(spots)} certified, {said['seconds']:.1f} s"


def _map(side: float, cells: list[Json]) -> Iterator[str]:
    """The map, y upwards; its cells from the smallest y on."""
    first, status = cells[0], {each.value: sign for each, sign in SIGNS.items()}
    yield (
        f"map, x to the right, y upwards, squares of {side:.2f} m; "
        f"the middle of the one at the bottom left is at x {first['x']:.2f} m, y {first['y']:.2f} m:"
    )
    rows = [list(row) for _, row in groupby(cells, lambda cell: cell["y"])]
    for row in reversed(rows):
        yield "  " + " ".join(status[one["status"]] for one in row)
    yield "  " + ", ".join(f"{sign} {name}" for name, sign in status.items())
