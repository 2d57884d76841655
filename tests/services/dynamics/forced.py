"""The small kitchen b with force data, and edits of them."""

from functools import cache
from pathlib import Path

from sdt_kg.twin import Twin
from services.dynamics.data import with_forces
from tests.small import small_twin

DATA = Path(__file__).parent / "small_b.ttl"
FOLDING = Path(__file__).parent / "folding_forces.ttl"
PANELS = "https://example.org/id/a/force_model/hinge"
RUNNERS = "https://example.org/id/b/force_model/runners"
HINGE = "https://example.org/id/b/force_model/hinge"


@cache
def forced_twin(robots: tuple[str, ...] = ()) -> Twin:
    """Two containers: `top_drawer` on runners, `oven_door` that opens downwards."""
    return with_forces(small_twin("b", robots), DATA)


@cache
def light_folding_twin(robots: tuple[str, ...] = ()) -> Twin:
    """The small kitchen a, whose folding door is so light that friction holds it everywhere."""
    twin = with_forces(small_twin("a", robots), FOLDING)
    return edited(
        PANELS,
        twin,
        movedMass=(0.03, 0.05),
        coulombFriction=(0.2, 0.3),
        breakAwayFriction=(0.3, 0.4),
        viscousFriction=(0.0, 0.1),
        allowedHandleForce=200.0,
    )


def edited(model: str, twin: Twin | None = None, **intervals: tuple[float, float] | float | None) -> Twin:
    """The twin with other figures: `latchForce=(180, 200)` sets both ends, `latchWidth=0.02` one number."""
    changes: dict[str, float | None] = {}
    for name, value in intervals.items():
        if isinstance(value, tuple):
            changes |= {f"{name}From": value[0], f"{name}To": value[1]}
        else:
            changes[name] = value
    return (twin or forced_twin()).with_edit(model, **changes)
