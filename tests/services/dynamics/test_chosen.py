"""A motion that nobody asked for as it is, but the robot chose, proves nothing of others."""

import numpy as np
import pytest

from predicates.case import Case, Kind, Outcome, Verdict
from predicates.law import law
from sdt_kg.motion import Motion
from sdt_kg.task import UNKNOWN, Task, Unknown, Verb
from sdt_kg.twin import Twin
from services.dynamics.oracle import Dynamics
from services.dynamics.robot.bearing import Bearing
from tests.services.dynamics.forced import RUNNERS, edited, forced_twin
from tests.small.lift import Lift


def opened(twin: Twin, motion: Motion | Unknown = UNKNOWN) -> Verdict:
    task = Task(Verb.OPEN, twin.container("top_drawer").iri)
    case = Case(twin, robot=twin.robots[0], task=task, motion=motion)
    (verdict,) = law(case, Dynamics(), Bearing(Lift()))
    return verdict


def pulled(twin: Twin, end: float, seconds: float) -> Motion:
    share = np.linspace(0.0, 1.0, 41)
    way = end * share**2 * (3 - 2 * share)
    return Motion(twin.container("top_drawer").joint, share * seconds, way[:, None])


@pytest.mark.parametrize(
    ("forces", "end", "seconds", "why"),
    [
        ({"softCloserForce": (15.0, 20.0), "softCloserRange": 0.47}, 0.48, 8.0, "does not stay"),
        ({"viscousFriction": (2000.0, 2000.0)}, 0.455, 80.0, "but needs"),
    ],
)
def test_a_refusal_of_what_the_robot_chose_is_no_proof_since_another_motion_does_it(
    forces: dict[str, tuple[float, float] | float], end: float, seconds: float, why: str
) -> None:
    twin = edited(RUNNERS, forced_twin(("pr2",)), **forces)
    found = opened(twin)
    assert found.outcome is Outcome.NOT_CERTIFIED
    (diagnosis,) = found.diagnoses
    assert (diagnosis.kind, diagnosis.proof) == (Kind.CAUSAL, False)
    assert why in diagnosis.reason
    assert opened(twin, pulled(twin, end, seconds)).outcome is Outcome.CERTIFIED


def test_what_leaving_rest_needs_stays_proved() -> None:
    twin = edited(RUNNERS, forced_twin(("pr2",)), breakAwayFriction=(70.0, 80.0))
    (diagnosis,) = opened(twin).diagnoses
    assert diagnosis.proof
    assert "but needs 70.0 N" in diagnosis.reason
