"""Values that a container passes: there its own joint is exactly where it is said to be.

A motion that takes the container from one side of a value to the other is continuous, so at some time the
joint is at the value, and whatever certification demands holds then, too. The motion begins within `start`
of the state, and is within `astray` of what it is asked for, or of where the task is met, at its end: so
values that near to the ends of the span need not be passed. All other joints of the kitchen, and the
container's own if it follows another one, are only as near to their places as certification demands; those
that move with the container are off as much more as they move more than it.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from sdt_kg.iri import local_name
from sdt_kg.twin import Container, Twin
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.geometry.mechanics import Link

Array = NDArray[np.float64]

OUTWARD: Final = 1 + 1e-12  # [1] more than a quotient and a product are rounded
TINY: Final = 1e-300  # in place of 0, by which nothing can be divided


@dataclass(frozen=True, slots=True)
class Passing:
    """What a container passes, and how near its kitchen's joints are to where they are then.

    Attributes:
        container: That moves.
        ratios: How far each joint that moves with it goes for each rad or m of it, by name.
        span: Values that it has to pass, or nearly so [rad or m]; None: not known.
        tolerances: Of certification.
    """

    container: Container
    ratios: Mapping[str, float]
    span: tuple[float, float] | None
    tolerances: Tolerances

    @staticmethod
    def of(
        twin: Twin, container: Container, span: tuple[float, float] | None, tolerances: Tolerances
    ) -> "Passing":
        """Of a container of a twin."""
        together = twin.entities.coupling.together(container.joint)
        ratios = {local_name(joint): abs(ratio) for joint, (ratio, _) in together.items()}
        return Passing(container, ratios, span, tolerances)

    def slacks(self, value: float, more: float, links: tuple[Link, ...], wide: float = 0.0) -> Array:
        """How far joints may be from where they are with the container at a value, shape (n,).

        Args:
            value: Of the container [rad or m].
            more: What joints may be off beyond their start [rad or m].
            links: The joints.
            wide: How far the container may be from the value besides [rad or m].
        """
        own, off = local_name(self.container.joint), self._off + more
        at = (0.0 if self.is_passed(value) else off) + wide
        along = self.ratios
        return np.array(
            [at if link.name == own else max(off, at * along.get(link.name, 0.0) * OUTWARD) for link in links]
        )

    def is_passed(self, value: float) -> bool:
        """Whether the container is at some time exactly at a value, if its motion goes through the span."""
        own = self.container.active_joint == self.container.joint
        return own and passes(self.span, value, self._off + self.astray)

    @property
    def astray(self) -> float:
        """How far the container may be off a motion that it is asked to keep, at most [rad or m].

        That may be given as values of any joint which moves with it: certification allows `coupling` there.
        """
        return self.tolerances.coupling * max(
            [1.0, *(OUTWARD / max(each, TINY) for each in self.ratios.values())]
        )

    @property
    def _off(self) -> float:
        """How far joints of the kitchen start from their state, at most [rad or m]."""
        return self.tolerances.position + max(self.tolerances.start_position, self.tolerances.start_angle)


def passes(span: tuple[float, float] | None, value: float, off: float) -> bool:
    """Whether what goes from one end of a span to the other, each to within `off`, passes a value."""
    return span is not None and span[0] + off < value < span[1] - off
