"""Interval, State and Region: I, s and G_final of the paper."""

import math
from collections.abc import ItemsView, Iterator, Mapping
from dataclasses import dataclass
from typing import Final

from sdt_kg.iri import Iri

ROUNDING: Final = 4e-15
"""[rad or m] Positions this near to a bound are at it: nine spacings of numbers between 2 and 4. D_artic has
positions up to 3.15; for x and o up to that, m · ((x - o) / m) + o is up to 1.4e-15 from x (measured)."""


@dataclass(frozen=True, slots=True)
class Interval:
    """Closed interval [lower, upper] in rad or m; what is beyond an end by ROUNDING is in it, too."""

    lower: float = -math.inf
    upper: float = math.inf

    def __contains__(self, value: float) -> bool:
        return self.lower - ROUNDING <= value <= self.upper + ROUNDING


@dataclass(frozen=True, slots=True)
class State(Mapping[Iri, float]):
    """s: joint IRI → position [rad or m].

    Joints that are not listed are where the twin has them that it is about.
    """

    positions: tuple[tuple[Iri, float], ...] = ()

    @staticmethod
    def of(positions: Mapping[Iri, float]) -> "State":
        """State with these positions, ordered by IRI."""
        return State(tuple(sorted(positions.items())))

    def __getitem__(self, joint: Iri) -> float:
        for own, position in self.positions:
            if own == joint:
                return position
        raise KeyError(joint)

    def items(self) -> ItemsView[Iri, float]:
        return dict(self.positions).items()

    def __iter__(self) -> Iterator[Iri]:
        return (joint for joint, _ in self.positions)

    def __len__(self) -> int:
        return len(self.positions)

    def __hash__(self) -> int:
        return hash(self.positions)

    def moved(self, joint: Iri, position: float) -> "State":
        """The same state with one joint elsewhere."""
        return State.of({**dict(self.positions), joint: position})


@dataclass(frozen=True, slots=True)
class Region:
    """G_final as a *set* of states: joint IRI → Interval. ≈ in Eq. (6) is membership."""

    intervals: tuple[tuple[Iri, Interval], ...]

    def __contains__(self, state: State) -> bool:
        return all(joint in state and state[joint] in interval for joint, interval in self.intervals)
