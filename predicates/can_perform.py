"""Eq. (7): can this robot move so that the container moves like this?"""

from collections.abc import Iterator

from predicates.case import Answer, Case
from predicates.oracle import Embodiment
from sdt_kg.errors import NoModeError
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.task import UNKNOWN


def can_perform(case: Case, embodiment: Embodiment) -> Iterator[Answer]:
    r"""Eq. (7), :math:`CanPerform(R, E, \tau)`, as the embodiment oracle answers it.

    Modes: (+robot, +motion, -body_motion) one answer, with a certified body motion if it holds;
    (+robot, +body_motion) one answer, the body motion as it is.

    Raises:
        NoModeError: The robot is unknown, or both its motion and the container's are.
        OracleUnavailableError: Nobody answered.
    """
    if case.robot is UNKNOWN:
        raise NoModeError("CanPerform needs a robot")
    if not isinstance(case.motion, Motion) and not isinstance(case.body_motion, BodyMotion):
        raise NoModeError("CanPerform needs a motion of the container or of the robot")
    yield embodiment.perform(case)
