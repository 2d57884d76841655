"""Φ of another version of sdt: the same physics, by its name older than any that is here."""

from services.app import Policy
from services.physics.oracle import Kinematics
from tests.small.lift import Lift


class Before(Kinematics):
    """Eq. (6), as version 0 answered it."""

    @property
    def version(self) -> str:
        return "kinematics 0"


class LiftsBefore:
    """The closed-form robots, and that Φ."""

    def physics(self) -> Before:
        return Before()

    def embodiment(self, policy: Policy) -> Lift:
        return Lift()
