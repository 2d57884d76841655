"""Whether a container stays where it is when nobody holds it, for every value of the parameters."""

from dataclasses import dataclass

import numpy as np

from services.dynamics.model import Mechanics
from services.dynamics.resistance import break_away, resisting, unborne
from services.embodiment.proof_check.geometry.interval import Interval, exact

CUTS = 64
"""[1] Cells of a way, over each of which forces are bounded."""


@dataclass(frozen=True, slots=True)
class Rest:
    """What may happen when it is let go.

    Attributes:
        shuts: Whether some value may let it move towards its lower stop.
        opens: Whether some value may let it move towards its upper stop.
        surely: Whether every value makes it move.
        pull: Largest force of the joint that drives it, N or N m; stops bear theirs.
        friction: Least friction that may hold it against that.
    """

    shuts: bool
    opens: bool
    surely: bool
    pull: float
    friction: float

    @property
    def stays(self) -> bool:
        """Whether every value holds it there."""
        return not (self.shuts or self.opens)


def at_rest(mechanics: Mechanics, q: float) -> Rest:
    """What happens at a position when it is let go: friction bears what drives it, or does not."""
    at = exact(np.array([q]))
    pulled = unborne(mechanics, resisting(mechanics, at), at)
    shut, opened = float(pulled.hi[0]), float(-pulled.lo[0])
    low, high = break_away(mechanics)
    surely = float(pulled.lo[0]) > high or float(-pulled.hi[0]) > high
    return Rest(shut > low, opened > low, surely, max(shut, opened, 0.0), low)


def driven(mechanics: Mechanics, begin: float, end: float, *, shut: bool) -> bool:
    """Whether every value drives it from rest at `begin` past `end`: friction bears it nowhere on the way."""
    edges = np.linspace(min(begin, end), max(begin, end), CUTS + 1)
    way = Interval(edges[:-1], edges[1:])
    pulled = unborne(mechanics, resisting(mechanics, way), way)
    _, high = break_away(mechanics)
    return bool(((pulled.lo if shut else -pulled.hi) > high).all())
