"""The small kitchen b with force data, and edits of them."""

from functools import cache
from pathlib import Path

from sdt_kg.twin import Twin
from services.dynamics.data import with_forces
from tests.small import small_twin

DATA = Path(__file__).parent / "small_b.ttl"
RUNNERS = "https://example.org/id/b/force_model/runners"
HINGE = "https://example.org/id/b/force_model/hinge"


@cache
def forced_twin(robots: tuple[str, ...] = ()) -> Twin:
    """Two containers: `top_drawer` on runners, `oven_door` that opens downwards."""
    return with_forces(small_twin("b", robots), DATA)


def edited(model: str, twin: Twin | None = None, **intervals: tuple[float, float] | float | None) -> Twin:
    """The twin with other figures: `latchForce=(180, 200)` sets both ends, `latchWidth=0.02` one number."""
    changes: dict[str, float | None] = {}
    for name, value in intervals.items():
        if isinstance(value, tuple):
            changes |= {f"{name}From": value[0], f"{name}To": value[1]}
        else:
            changes[name] = value
    return (twin or forced_twin()).with_edit(model, **changes)
