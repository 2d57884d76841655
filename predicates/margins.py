"""Smallest distances among a certificate's figures: what they are called, which are bounds, between what."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Final

from sdt_kg.iri import Iri

SMALLEST: Final = "smallest distance, "
"""How the certifier's figures of distances are named; those of allowed contact are no clearance."""

COUNTED: Final = "distance queries, "
"""How those are named that say how much was computed, not what was found."""

RATIO: Final = " ratio"
"""How those end that say how much of a limit is used."""

CLEARANCES: Final = (SMALLEST + "environment", SMALLEST + "self")

LOOKED_UP_TO: Final = 0.02
"""[m] Distances above this are not looked for more closely: just this stands for `nothing nearer`."""

AT_LEAST: Final = "at least "
"""What stands before a smallest distance that is a bound, where people read it."""


@dataclass(frozen=True, slots=True)
class NearestPair:
    """Between what a smallest distance is, and when.

    Attributes:
        links: IRIs of the two bodies, in alphabetical order.
        time: Along the motion [s].
    """

    links: tuple[Iri, Iri]
    time: float


def is_bound(distance: float) -> bool:
    """Whether a smallest distance [m] is that up to which was looked, so that nothing nearer was found."""
    return distance == LOOKED_UP_TO


def at_least(figures: Mapping[str, tuple[float, str]]) -> tuple[str, ...]:
    """Names of those figures that are a bound, not a measurement."""
    return tuple(name for name, (at, _) in figures.items() if name.startswith(SMALLEST) and is_bound(at))


def told_figures(figures: Mapping[str, tuple[float, str]]) -> Iterator[tuple[str, str]]:
    """Name and value of each figure for people: margins, then in one line how much was computed for them."""
    bounds = at_least(figures)
    for name, (value, unit) in figures.items():
        if not name.startswith(COUNTED):
            of = " of what is allowed" if name.endswith(RATIO) else "" if unit == "1" else f" {unit}"
            yield name, f"{AT_LEAST if name in bounds else ''}{value:.6g}{of}"
    counts = (
        f"{value:g} ({name.removeprefix(COUNTED)})"
        for name, (value, _) in figures.items()
        if name.startswith(COUNTED)
    )
    if said := ", ".join(counts):
        yield "distances computed", said
