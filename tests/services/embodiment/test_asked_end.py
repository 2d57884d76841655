"""Where a body motion ends that comes with a τ: by as much as the tolerance, it may be elsewhere."""

from pathlib import Path

import pytest

from predicates.case import Case, Outcome, Verdict
from predicates.law import law
from sdt_kg.annotation import Drive
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.state import State
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.embodiment.oracle import WholeBody
from services.physics.oracle import Kinematics
from tests.services.embodiment.gantry import DRAWER, RESTS, START, gantry_twin, opening

pytestmark = pytest.mark.oracle

GRASPED = 11.0  # [s]


def up_to(end: float) -> BodyMotion:
    """A body motion that opens the drawer so far [m]."""
    rests = RESTS.copy()
    rests[-1, -1] = end
    rests[-1, 1] += RESTS[-1, -1] - end
    return opening(rests=rests)


def wanted(of: str, end: float, timed: bool) -> Motion:
    """τ of a joint, in the times of these body motions."""
    body, scale = opening(), end / RESTS[-1, -1]
    held = body.times >= GRASPED - 1e-9
    values, rates = scale * body.kitchen_q[held], scale * body.kitchen_v[held]
    return Motion(of, body.times[held] - GRASPED, values, timed, rates)


def judged(twin: Twin, motion: Motion, body: BodyMotion) -> Verdict:
    task = Task(Verb.OPEN, twin.container("drawer_main").iri)
    case = Case(twin, twin.robots[0], task, motion, body_motion=body)
    (verdict,) = law(case, Kinematics(), WholeBody(Drive.OMNI, START))
    return verdict


@pytest.mark.parametrize("timed", [True, False])
@pytest.mark.parametrize("beyond", [0.0002, -0.0002])
def test_whether_a_request_is_met_is_asked_of_where_a_body_motion_ends(
    tmp_path: Path, beyond: float, timed: bool
) -> None:
    # It keeps a τ that ends 0.5 mm beyond where open begins, to within 1 mm.
    twin = gantry_twin(tmp_path)
    open_from = twin.container("drawer_main").open_from
    verdict = judged(twin, wanted(DRAWER, open_from + 0.0005, timed), up_to(open_from + beyond))
    assert verdict.can_perform is not None
    assert verdict.can_perform.holds
    assert verdict.outcome is (Outcome.CERTIFIED if beyond > 0 else Outcome.NOT_CERTIFIED)
    assert isinstance(verdict.case.final, State)
    assert verdict.case.final[DRAWER] == pytest.approx(open_from + beyond)
