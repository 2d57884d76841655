"""A body motion that is planned, and who plans it in several holds."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

from predicates.case import Diagnosis, Kind
from sdt_kg.errors import MotionError
from sdt_kg.motion import BodyMotion, Motion, check_body_motion
from services.embodiment.hold.holding import Holding
from services.embodiment.ways.assemble import Assembler
from services.embodiment.ways.way import Approach


@dataclass(frozen=True, slots=True, eq=False)
class Planned:
    """A body motion that the planner believes in.

    Attributes:
        approach, holding, assembler: Of which it is made; in several holds, of the first.
    """

    body: BodyMotion
    motion: Motion
    grasp: int
    style: str
    holding: Holding
    approach: Approach
    assembler: Assembler


class Anew(Protocol):
    """Plans in several holds; see `Several`."""

    def plans(self, limit: float) -> Iterator[Planned]:
        """Those that are found if each part is looked for so long [s]."""
        ...

    def lacking(self) -> Iterator[tuple[str, tuple[float, float]]]:
        """Grippers for which a part of the way was not found, and from which value to which [rad or m]."""
        ...


@dataclass(frozen=True, slots=True)
class Lack:
    """Why a gripper's holds that a descent finds lead not all the way.

    Attributes:
        ends: First and last of the values of the container that are meant [rad or m].
        held: Whether some reach each of these; else none does.
        shapes: In contact there whatever the arm does.
    """

    gripper: str
    ends: tuple[float, float]
    held: bool = False
    shapes: tuple[int, int] | None = None


class Descents(Protocol):
    """Plans in holds that a descent finds; see `Descended`."""

    def plans(self, turns: int, idle: int) -> Iterator[Planned]:
        """Those that are found in so many turns more, so many of them in vain."""
        ...

    def lacking(self) -> Iterator[Lack]:
        """What each gripper lacks."""
        ...


def no_motion(body: BodyMotion) -> tuple[Diagnosis, ...]:
    """Why what was planned is no motion, as where a joint needs centuries; empty where it is one."""
    try:
        check_body_motion(body)
    except MotionError as error:
        return (Diagnosis(Kind.EMBODIMENT, f"what was planned is no motion: {error}"),)
    return ()
