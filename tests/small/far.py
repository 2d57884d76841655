"""The lift, which tells how near it came: to the kitchen not at all, to itself by a measured distance."""

from dataclasses import replace

from predicates.case import Answer, Case
from predicates.margins import CLEARANCES, LOOKED_UP_TO, NearestPair, is_bound
from sdt_kg.iri import Iri
from services.app import Policy
from services.physics.oracle import Kinematics
from tests.small.lift import Lift

TO_KITCHEN, TO_ITSELF = CLEARANCES
NEAR_ITSELF = 0.0145  # [m]
AT = 1.25  # [s]


def nearest(robot: Iri) -> NearestPair:
    """The bodies that are said to be nearest, and when."""
    return NearestPair((f"{robot}/body/base", f"{robot}/body/carriage"), AT)


class Far(Lift):
    """Eq. (7) for a lift on wheels, and smallest distances."""

    def __init__(self, to_itself: float = NEAR_ITSELF) -> None:
        self.figures = {TO_KITCHEN: (LOOKED_UP_TO, "m"), TO_ITSELF: (to_itself, "m")}

    def perform(self, case: Case) -> Answer:
        answer = super().perform(case)
        if not answer.holds:
            return answer
        assert isinstance(case.robot, str)
        own = {} if is_bound(self.figures[TO_ITSELF][0]) else {TO_ITSELF: nearest(case.robot)}
        return replace(answer, figures=self.figures, nearest_pairs=own)


class FarLifts:
    """Oracles of a service whose robot has so much room."""

    def __init__(self, to_itself: float = NEAR_ITSELF) -> None:
        self.to_itself = to_itself

    def physics(self) -> Kinematics:
        return Kinematics()

    def embodiment(self, policy: Policy) -> Far:
        return Far(self.to_itself)
