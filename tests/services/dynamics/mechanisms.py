"""Mechanisms for tests: one value of each parameter, or intervals of them."""

from services.dynamics.model import ForceModel, Load, Mechanics, Values

NOTHING = Values(
    mass=5.0,
    inertia=1.0,
    weight=1.0,
    coulomb=0.0,
    break_away=0.0,
    viscous=0.0,
    stiffness=0.0,
    latch=0.0,
    closer=0.0,
    closer_damping=0.0,
)
SLIDE = Load(True, 1.0, 0.0, 0.0, 0.0, (1.0, 1.0))
UPPER = 0.5  # [m]


def slide(
    lower: Values,
    upper: Values | None = None,
    *,
    load: Load = SLIDE,
    lengths: tuple[float, float, float] = (0.0, 0.0, 0.0),
    allowed: float = 60.0,
) -> Mechanics:
    """A drawer of half a metre, or a mechanism with another load.

    Args:
        lower, upper: Ends of the parameters; the same where upper is left out.
        lengths: Rest position of the spring, width of the latch, range of the soft closer [m].
    """
    forces = ForceModel(lower, lower if upper is None else upper, *lengths, allowed)
    return Mechanics("https://example.org/id/test/joint/slide", forces, load, 0.0, UPPER)
