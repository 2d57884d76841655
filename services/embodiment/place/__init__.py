"""Where a base may stand for a task: a map, and poses certified with a fixed base."""

from services.embodiment.place.grid import Cell, Status
from services.embodiment.place.placement import Placement, Spot
from services.embodiment.place.search import place, spots

__all__ = ["Cell", "Placement", "Spot", "Status", "place", "spots"]
