"""Two bodies of a kitchen that are deep in each other on the way of a container."""

from dataclasses import dataclass

from sdt_kg.iri import Iri


@dataclass(frozen=True, slots=True)
class Block:
    """The first position of the actuated joint at which two bodies are too deep in each other.

    Or, of two that pass each other, where they are deepest.

    Attributes:
        position: Of the actuated joint [rad or m].
        depth: [m] How deep they are there; negative is their distance.
        allowed: [m] How deep they may be; negative is the distance that they have to keep.
        drawn: [m] How deep they were fitted into each other.
    """

    position: float
    depth: float
    allowed: float
    moved: Iri
    other: Iri
    drawn: float = 0.0
