"""What one look has found."""

from dataclasses import dataclass
from enum import Enum


class Standing(Enum):
    """How it stands."""

    WELL = "well"
    OPTIONAL = "optional"
    TO_DO = "to do"


@dataclass(frozen=True, slots=True)
class Finding:
    """What one look has found.

    Attributes:
        about: What was looked at.
        standing: Well; well, though something optional is missing; or something is to be done.
        says: What is there.
        remedy: What to do; empty where nothing is.
        notes: What loading changed, chose or assumed, of a model that was named.
    """

    about: str
    standing: Standing
    says: str
    remedy: str = ""
    notes: tuple[str, ...] = ()


def well(about: str, says: str, notes: tuple[str, ...] = ()) -> Finding:
    """All is well."""
    return Finding(about, Standing.WELL, says, notes=notes)
