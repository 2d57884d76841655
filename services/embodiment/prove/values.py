"""Values of a container at which a proof is looked for, one for all grippers."""

from collections.abc import Callable, Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Gripper
from sdt_kg.twin import Container
from services.embodiment.proof_check.proof.content import Refutation

Array = NDArray[np.float64]
Look = Callable[[Gripper, float], Refutation | None]

INSIDE = 0.0025  # [rad or m] before the end of the span: motions pass that value, and come near the end only


def needed(container: Container, at: float, values: Array) -> tuple[float, float] | None:
    """Values that the container has to pass on its way, from the lowest; None if it need not move.

    Of a motion that opens it no more than up to where it is open, of one that closes it no more than
    down to where it is closed.
    """
    last = float(values[-1])
    if last > at:
        return (at, min(last, container.open_from)) if not container.is_open(at) else None
    return (max(last, container.closed_to), at) if not container.is_closed(at) else None


def spread(span: tuple[float, float], at: float, count: int) -> list[float]:
    """So many values from where the container is to just before the other end of its span, in order."""
    low, high = span
    if at <= low:
        high = max(high - INSIDE, low)
    else:
        low = min(low + INSIDE, high)
    return np.linspace(low, high, count).clip(low, high).tolist()


def at_one(grippers: Sequence[Gripper], values: Iterable[float], look: Look) -> list[Refutation] | None:
    """One refutation for each gripper, at the first value at which all are refuted; None if there is none.

    Args:
        grippers: Of the robot.
        values: Of the container, those first at which it is looked first [rad or m].
        look: The refutation of a gripper at a value; None if none is found.
    """
    for value in values:
        found: list[Refutation] = []
        for gripper in grippers:
            one = look(gripper, value)
            if one is None:
                break
            found.append(one)
        if len(found) == len(grippers):
            return found
    return None
