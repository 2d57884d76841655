"""A τ may begin a little beside where the kitchen is: with times as certification allows, else as Φ does."""

from pathlib import Path

import numpy as np
import pytest

from predicates.case import Case, Outcome
from predicates.law import law
from sdt_kg.annotation import Drive
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.task import Task, Verb
from services.embodiment.oracle import WholeBody
from services.physics.oracle import Kinematics
from tests.services.embodiment.gantry import DRAWER, START, gantry_twin

pytestmark = pytest.mark.oracle


@pytest.mark.parametrize(("state", "begins"), [(0.0, 0.0009), (0.2, 0.2005), (0.2, 0.1991)])
def test_the_hand_closes_where_the_motion_begins(tmp_path: Path, state: float, begins: float) -> None:
    twin = gantry_twin(tmp_path).at({DRAWER: state})
    u = np.linspace(0.0, 1.0, 33)
    values = begins + (0.46 - begins) * u**3 * (10 + u * (6 * u - 15))
    task, motion = Task(Verb.OPEN, twin.container("drawer_main").iri), Motion(DRAWER, 6 * u, values[:, None])
    case = Case(twin, twin.robots[0], task, motion)
    (verdict,) = law(case, Kinematics(), WholeBody(Drive.OMNI, START, budget=5.0))
    assert verdict.outcome is Outcome.CERTIFIED, [each.reason for each in verdict.diagnoses]


@pytest.mark.parametrize(("state", "begins"), [(0.0, 0.0015), (0.2, 0.2015), (0.2, 0.1985)])
def test_a_way_back_and_forth_is_gone_from_where_the_kitchen_is(
    tmp_path: Path, state: float, begins: float
) -> None:
    """Its times need not be kept, and Φ lets it begin as far beside as the tool may slip on the handle."""
    twin = gantry_twin(tmp_path).at({DRAWER: state})
    values = np.array([[begins], [0.3], [0.1], [0.46]])
    motion = Motion(DRAWER, np.array([0.0, 4.0, 8.0, 14.0]), values, timed=False)
    case = Case(twin, twin.robots[0], Task(Verb.OPEN, twin.container("drawer_main").iri), motion)
    (verdict,) = law(case, Kinematics(), WholeBody(Drive.OMNI, START, budget=5.0))
    assert verdict.outcome is Outcome.CERTIFIED, [each.reason for each in verdict.diagnoses]
    assert verdict.can_perform is not None
    body = verdict.can_perform.case.body_motion
    assert isinstance(body, BodyMotion)
    assert body.kitchen_q[0, 0] == state
    assert (np.diff(body.kitchen_q[:, 0]) < 0).any(), "it goes back on its way, as asked"
