"""Refutations of all grippers at one value of the container: none has the handle there, nor can take over."""

from collections.abc import Callable, Iterable, Sequence

from sdt_kg.annotation import Gripper
from services.embodiment.proof_check.content import Refutation

Look = Callable[[Gripper, float], Refutation | None]


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
