"""A placement as JSON and as lines for people."""

from collections.abc import Iterator

from predicates.margins import AT_LEAST, LOOKED_UP_TO, is_bound
from services.embodiment.place.grid import SIDE, Status
from services.embodiment.place.search import DECIMALS, Placement, Spot

SIGNS = {Status.CERTIFIED: "#", Status.PROVED: "-", Status.BLOCKED: "x", Status.UNKNOWN: "."}
COLUMNS = ("x", "y", "yaw", "margin", "gripper", "base")
"""Of a pose: [m], [m], [rad], [m], name, as `--base` takes it."""
SHOWN = 5
"""[1] Poses that are printed; JSON has all."""


def to_json(found: Placement) -> dict[str, object]:
    """Poses, map and what was tried."""
    return {
        "container": found.container,
        "best": None if found.best is None else spot(found.best),
        "spots": [spot(each) for each in found.spots],
        "margins_looked_up_to": LOOKED_UP_TO,
        "impossible": found.impossible,
        "tried": found.tried,
        "diagnoses": [
            {"kind": each.kind.value, "reason": each.reason, "proof": each.proof} for each in found.diagnoses
        ],
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


def none_found(container: str, *, impossible: bool) -> str:
    """That no pose was found, and how sure that is."""
    how = "every pose of the map is proved impossible" if impossible else "searched, not proved"
    return f"no pose found for {container}: {how}"


def lines(found: Placement, friction: float | None = None) -> Iterator[str]:
    """What people read: poses, as `sdt achieve` asks for them with that friction, then the map, y upwards."""
    asked = "--drive fixed" if friction is None else f"--drive fixed --friction {friction:g}"
    for each in found.diagnoses:
        yield f"{each.kind.value}: {each.reason}"
    for spot in found.spots[:SHOWN]:
        bound = AT_LEAST if is_bound(spot.margin) else ""
        yield (
            f"certified  --base {base_of(spot)} {asked}  "
            f"gripper {spot.gripper}, margin {bound}{spot.margin * 1000:.1f} mm"
        )
    if len(found.spots) > SHOWN:
        yield f"and {len(found.spots) - SHOWN} more"
    if not found.spots and found.rows:
        yield none_found(found.container, impossible=found.impossible)
    if found.rows:
        cell = found.rows[0][0]
        size = SIDE / len(found.rows)
        yield (
            f"map, x to the right, y upwards, squares of {size:.2f} m; "
            f"the middle of the one at the bottom left is at x {cell.x:.2f} m, y {cell.y:.2f} m:"
        )
        for row in reversed(found.rows):
            yield "  " + " ".join(SIGNS[one.status] for one in row)
        yield "  " + ", ".join(f"{sign} {status.value}" for status, sign in SIGNS.items())
    yield f"{found.tried} poses asked, {len(found.spots)} certified, {found.seconds:.1f} s"
