"""States, branches and trajectories of a twin, what happened in them, and how two of them differ."""

from sdt_kg.history.branches import Branch, History, content_hash
from sdt_kg.history.edits import (
    Brought,
    Edit,
    Followed,
    Moved,
    Rewritten,
    TakenAway,
    brought,
    changed,
    moved,
    obstacle,
    posed,
    without_obstacle,
)
from sdt_kg.history.events import Event, EventType
from sdt_kg.history.reopen import continued, has_history, reopened
from sdt_kg.history.trajectory import Trajectory

__all__ = [
    "Branch",
    "Brought",
    "Edit",
    "Event",
    "EventType",
    "Followed",
    "History",
    "Moved",
    "Rewritten",
    "TakenAway",
    "Trajectory",
    "brought",
    "changed",
    "content_hash",
    "continued",
    "has_history",
    "moved",
    "obstacle",
    "posed",
    "reopened",
    "without_obstacle",
]
