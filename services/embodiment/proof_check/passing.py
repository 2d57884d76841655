"""Values that a container passes: there its own joint is exactly where it is said to be.

A motion that takes the container from one side of a value to the other is continuous, so at some time the
joint is at the value, and whatever certification demands holds then, too. The motion begins within `start`
of the state, and is within `coupling` of what it is asked for, or of where the task is met, at its end: so
values that near to the ends of the span need not be passed. All other joints of the kitchen, and the
container's own if it follows another one, are only as near to their places as certification demands.
"""

import numpy as np
from numpy.typing import NDArray

from sdt_kg.iri import local_name
from sdt_kg.twin import Container
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.mechanics import Link

Array = NDArray[np.float64]


def slacks(  # noqa: PLR0913, PLR0917  # which value of what, and how near
    container: Container,
    span: tuple[float, float] | None,
    tolerances: Tolerances,
    value: float,
    more: float,
    links: tuple[Link, ...],
    wide: float = 0.0,
) -> Array:
    """How far joints of the kitchen may be from where they are with the container at a value, shape (n,).

    Args:
        container: That moves.
        span: Values that it has to pass, or nearly so [rad or m]; None: not known.
        tolerances: Of certification.
        value: Of the container [rad or m].
        more: What joints may be off beyond their start [rad or m].
        links: The joints.
        wide: How far the container may be from the value besides [rad or m].
    """
    exact, own = is_passed(container, span, tolerances, value), local_name(container.joint)
    off, at = _off(tolerances) + more, 0.0 if exact else _off(tolerances) + more
    return np.array([at + wide if link.name == own else off for link in links])


def is_passed(
    container: Container, span: tuple[float, float] | None, tolerances: Tolerances, value: float
) -> bool:
    """Whether a container whose motion has to go through a span is at some time exactly at a value."""
    own = container.active_joint == container.joint
    return own and passes(span, value, _off(tolerances) + tolerances.coupling)


def _off(tolerances: Tolerances) -> float:
    """How far joints of the kitchen start from their state, at most [rad or m]."""
    return tolerances.position + max(tolerances.start_position, tolerances.start_angle)


def passes(span: tuple[float, float] | None, value: float, off: float) -> bool:
    """Whether what goes from one end of a span to the other, each to within `off`, passes a value."""
    return span is not None and span[0] + off < value < span[1] - off
