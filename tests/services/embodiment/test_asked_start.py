"""A τ with times may begin beside where the kitchen is, by as much as certification allows at the start."""

from pathlib import Path

import numpy as np
import pytest

from predicates.case import Case, Outcome
from predicates.law import law
from sdt_kg.annotation import Drive
from sdt_kg.motion import Motion
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
