"""What the relations need of the world, as Protocols; `services` fulfils them."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

from predicates.case import Answer, Case, Diagnosis
from sdt_kg.iri import Iri
from sdt_kg.motion import Motion
from sdt_kg.state import Region, State
from sdt_kg.twin import Twin


@dataclass(frozen=True, slots=True)
class Replayed:
    """What Φ makes of a motion.

    Attributes:
        final: State after the last sample.
        motion: τ as articulation values of the container's own joint, whichever form came in.
    """

    final: State
    motion: Motion


class Physics(Protocol):
    """Φ of Eq. (6)."""

    @property
    def version(self) -> str:
        """Name and version of the model and its libraries; part of every verdict's hash."""
        ...

    def replay(self, twin: Twin, motion: Motion) -> Replayed | Diagnosis:
        """Final state under the motion, or why it cannot be replayed (limits, wrong frame)."""
        ...

    def generate(self, twin: Twin, goal: Region) -> Iterator[Motion]:
        """Motions which end in the region, best first."""
        ...


class Embodiment(Protocol):
    """Eq. (7)."""

    @property
    def version(self) -> str:
        """Name and version of the oracle and its libraries; part of every verdict's hash."""
        ...

    def settings(self, twin: Twin, robot: Iri) -> tuple[tuple[str, str], ...]:
        """What decides the answer beyond the case: drive, start pose, tolerances, margins, grasp set."""
        ...

    def perform(self, case: Case) -> Answer:
        """Body motion that follows the case's motion, certified; or the verification of the case's own."""
        ...
