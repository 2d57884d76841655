"""Small kitchens, small robots and a real, small embodiment oracle, for tests that need no planner."""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

from sdt_kg.entities import Entities
from sdt_kg.load import load_twin, read_robot, with_robot
from sdt_kg.twin import Twin

FOLDER = Path(__file__).resolve().parent


@cache
def small_twin(kitchen: str = "a", robots: Sequence[str] = ()) -> Twin:
    """Twin of `a` (five containers) or `b` (two), with the lifts named `pr2` and `stretch`."""
    return load_twin(FOLDER / f"{kitchen}.urdf", [FOLDER / f"{robot}.urdf" for robot in robots])


def beside(kitchen: Path, robot: str) -> Twin:
    """Twin of the kitchen in a file and a bundled robot, which is read once for all of them."""
    return with_robot(load_twin(kitchen), _alone(robot))


@cache
def _alone(robot: str) -> Entities:
    return read_robot(robot)
