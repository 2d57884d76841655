"""What the relations need of the world, as Protocols; `services` fulfils them."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

from predicates.case import Answer, Case, Diagnosis
from sdt_kg.iri import Iri
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.scope import D_ARTIC, TeeClass
from sdt_kg.state import Region, State
from sdt_kg.twin import Container, Twin

LET_GO = "force that may move it when let go"
"""Name of a figure of Replayed: the container is not sure to stay where the motion ends."""

RESTLESS = "containers that may move by themselves"
"""Name of a figure of Replayed: so many that nobody holds are not sure to stay where the state has them."""

UNCHECKED = "not checked to stay: "
"""How figures of Replayed are called, each ending with a container's name, that tell of what moves by a force
that nobody knows: a container which nobody holds, taken to stay where the state has it."""


def not_checked(figures: Mapping[str, tuple[float, str]]) -> tuple[str, ...]:
    """Names of the containers of which figures tell that nobody checked whether they stay."""
    return tuple(name.removeprefix(UNCHECKED) for name in figures if name.startswith(UNCHECKED))


@dataclass(frozen=True, slots=True)
class Replayed:
    """What Φ makes of a motion.

    Attributes:
        final: State after the last sample.
        motion: τ as articulation values of the container's own joint, whichever form came in.
        violations: What the motion does that the kitchen cannot: limits of position, velocity and
            acceleration, a start elsewhere, poses that leave the joint's motion; the first and the
            worst of each. `final` is then where the motion would end, held by the joint's limits.
        notes: What a reader should know of how it was judged.
        figures: Bounds that were found: name → (value, unit).
    """

    final: State
    motion: Motion
    violations: tuple[Diagnosis, ...] = ()
    notes: tuple[str, ...] = ()
    figures: dict[str, tuple[float, str]] = field(default_factory=dict[str, tuple[float, str]])


class Physics(Protocol):
    """Φ of Eq. (6)."""

    @property
    def version(self) -> str:
        """Name and version of the model and its libraries; part of every verdict's hash."""
        ...

    def replay(self, twin: Twin, motion: Motion) -> Replayed:
        """Final state under the motion, and what it does that the kitchen cannot.

        Raises:
            MotionError: It is no motion of this kitchen.
            DisconnectedFrameError: It is of a frame that no joint moves.
        """
        ...

    def generate(self, twin: Twin, goal: Region) -> Iterator[Motion]:
        """Motions from the twin's state into the region, best first."""
        ...

    def carried(self, twin: Twin, body_motion: BodyMotion, container: Container) -> Motion:
        """τ of the container's own joint under a body motion: as it says, or as its gripper drags it."""
        ...


@runtime_checkable
class OfClass(Protocol):
    """A Φ that says of which class D it is a part."""

    @property
    def tee_class(self) -> TeeClass:
        """D."""
        ...


def tee_class_of(physics: Physics) -> TeeClass:
    """The class that a question to this Φ is about: its own, D_artic where it says none."""
    return physics.tee_class if isinstance(physics, OfClass) else D_ARTIC


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
