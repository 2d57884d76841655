"""Where a moving part of the kitchen meets the rest of it.

The container stops where it meets another body, or where two bodies meet that move each in its own way.
"""

from sdt_kg.iri import Iri
from sdt_kg.state import State
from services.physics.geometry.bodies import shapes_of
from services.physics.stops.bearing import Bearing
from services.physics.stops.block import Block
from services.physics.stops.path import Path
from services.physics.stops.rest import Rest
from services.physics.stops.shapes import Shapes
from services.physics.tree import Model

KEPT = 4096
"""[1] Answers that are kept."""


class Sweep:
    """The kitchen's shapes, for questions about what moves into what; `put` and `drawn` are of `Rest`."""

    def __init__(self, model: Model, put: frozenset[Iri] = frozenset(), drawn: Model | None = None) -> None:
        self._model = model
        every = list(shapes_of(model))
        self._rest, self._shapes = Rest(model, every, put, drawn), Shapes(every)
        self._bearing = Bearing(self._rest)
        self._known: dict[tuple[State, Iri, float], tuple[Block | None, tuple[Block, ...]]] = {}

    def first_block(self, state: State, active: Iri, end: float) -> Block | None:
        """Where the actuated joint is stopped on its way from the state to `end`, or None.

        Where one joint joins two bodies, shapes that lie beside each other at rest are left out: rails lie
        in their own cabinets. So are bodies that move with it in the same way.
        """
        return self._asked(state, active, end)[0]

    def passed(self, state: State, active: Iri, end: float) -> tuple[Block, ...]:
        """What is deeper in each other on that way than others may be, and passes, as it was drawn so."""
        return self._asked(state, active, end)[1]

    def _asked(self, state: State, active: Iri, end: float) -> tuple[Block | None, tuple[Block, ...]]:
        key = (state, active, end)
        if key not in self._known:
            if len(self._known) >= KEPT:
                self._known.clear()
            self._known[key] = self._searched(state, active, end)
        return self._known[key]

    def _searched(self, state: State, active: Iri, end: float) -> tuple[Block | None, tuple[Block, ...]]:
        path = Path(self._model, self._bearing, state, active, end)
        found: Block | None = None
        for one, other, until in path.near(self._shapes):
            found = path.followed(one, other, end if found is None else found.position, until) or found
        for one, other in path.together(self._shapes):
            until = end if found is None else found.position
            found = path.followed(one, other, until, until) or found
        return found, tuple(path.passed)
