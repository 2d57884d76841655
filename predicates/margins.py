"""Smallest distances among a certificate's figures: how they are called, and when one is a bound."""

from collections.abc import Mapping
from typing import Final

SMALLEST: Final = "smallest distance, "
"""How the certifier's figures of distances are named; those of allowed contact are no clearance."""

CLEARANCES: Final = (SMALLEST + "environment", SMALLEST + "self")

LOOKED_UP_TO: Final = 0.02
"""[m] Distances above this are not looked for more closely: just this stands for `nothing nearer`."""

AT_LEAST: Final = "at least "
"""What stands before a smallest distance that is a bound, where people read it."""


def is_bound(distance: float) -> bool:
    """Whether a smallest distance [m] is that up to which was looked, so that nothing nearer was found."""
    return distance == LOOKED_UP_TO


def at_least(figures: Mapping[str, tuple[float, str]]) -> tuple[str, ...]:
    """Names of those figures that are a bound, not a measurement."""
    return tuple(name for name, (at, _) in figures.items() if name.startswith(SMALLEST) and is_bound(at))
