"""Small kitchens, small robots and a real, small embodiment oracle, for tests that need no planner."""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

from sdt_kg.load import load_twin
from sdt_kg.twin import Twin

FOLDER = Path(__file__).resolve().parent


@cache
def small_twin(kitchen: str = "a", robots: Sequence[str] = ()) -> Twin:
    """Twin of `a` (five containers) or `b` (two), with the lifts named `pr2` and `stretch`."""
    return load_twin(FOLDER / f"{kitchen}.urdf", [FOLDER / f"{robot}.urdf" for robot in robots])
