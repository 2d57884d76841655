"""A robot that starts outside of a closed room is told so, as far as its search can tell."""

from pathlib import Path

import pytest

from predicates.case import Outcome
from sdt_kg.annotation import Drive
from services.app import Policy, load
from tests.sdt_kg.conftest import joint, limit, link

pytestmark = pytest.mark.oracle

OUTSIDE, INSIDE = (-4.0, 0.0, 0.0), (0.0, 0.0, 0.0)
WALLS = {
    "n": ("4 0.1 2", "0 2 1"),
    "s": ("4 0.1 2", "0 -2 1"),
    "e": ("0.1 4 2", "2 0 1"),
    "w": ("0.1 4 2", "-2 0 1"),
}
SLIDE = f'<origin xyz="1.3 0 0.65"/><axis xyz="-1 0 0"/>{limit(0.0, 0.4)}'
DRAWER = (
    link("drawer", '<box size="0.02 0.4 0.2"/>'),
    link("drawer_handle", '<box size="0.012 0.15 0.012"/>'),
    joint("slide", "prismatic", "world", "drawer", SLIDE),
    joint("mount", "fixed", "drawer", "drawer_handle", '<origin xyz="-0.06 0 0"/>'),
)


def reasons(folder: Path, walls: str, start: tuple[float, float, float]) -> str:
    """Why a PR2 that starts there does not open the drawer of the room with these walls; empty if it does."""
    parts = [link("world"), *DRAWER]
    for name in walls:
        size, at = WALLS[name]
        parts += [
            link(f"wall_{name}", f'<box size="{size}"/>'),
            joint(f"wall_{name}_mount", "fixed", "world", f"wall_{name}", f'<origin xyz="{at}"/>'),
        ]
    path = folder / "room.urdf"
    path.write_text(f'<robot name="room">{"".join(parts)}</robot>')
    service = load(path, ["pr2"], policy=Policy(Drive.OMNI, start, budget=4.0))
    (verdict,) = service.achieve("open:drawer")
    assert (verdict.outcome is Outcome.CERTIFIED) is not bool(verdict.diagnoses)
    assert not any(each.proof for each in verdict.diagnoses), "steps of a lattice prove nothing"
    return " | ".join(each.reason for each in verdict.diagnoses)


def test_a_start_outside_of_a_closed_room_is_told_with_the_floor_that_is_shut_off(tmp_path: Path) -> None:
    said = reasons(tmp_path, "nsew", OUTSIDE)
    assert "no drive from the start pose to the handle was found: parked, the robot gets about on " in said
    assert "in steps of 0.1 m nowhere else; the start may lie outside of a closed room" in said


@pytest.mark.parametrize(("walls", "start"), [("nsew", INSIDE), ("nse", OUTSIDE)])
def test_inside_and_where_a_wall_is_missing_it_is_opened(
    tmp_path: Path, walls: str, start: tuple[float, float, float]
) -> None:
    assert not reasons(tmp_path, walls, start)
