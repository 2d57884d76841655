"""That a motion which somebody gave is refused says nothing of what a robot could do."""

from pathlib import Path

import numpy as np
import pyoxigraph as ox
import pytest

import ontology
from predicates.case import Case, Outcome
from predicates.law import law
from predicates.record import to_record, write
from sdt_kg.motion import Motion
from sdt_kg.store import rows_of
from sdt_kg.task import Task, Verb
from services.physics.oracle import Kinematics
from tests.small import small_twin
from tests.small.lift import Lift

TWIN = small_twin("a", ("pr2", "stretch"))
QUESTIONS = (
    "cq01_which_containers_does_stretch_fail",
    "cq02_which_robot_opens_most_of_kitchen_a",
    "cq03_which_verdicts_rest_on_a_proof",
    "cq16_by_how_much_does_a_robot_miss",
    "cq17_which_containers_does_no_robot_open",
)


@pytest.fixture(scope="module")
def refused() -> ox.Store:
    """Stretch was given a motion that stops short of open; it opens that drawer."""
    drawer, stretch = TWIN.container("low_drawer"), TWIN.robots[1]
    short = Motion(drawer.joint, np.array([0.0, 1.0, 2.0]), np.array([[0.0], [0.1], [0.2]]), timed=False)
    case = Case(TWIN, robot=stretch, task=Task(Verb.OPEN, drawer.iri), motion=short)
    (verdict,) = law(case, Kinematics(), Lift())
    assert verdict.outcome is Outcome.NOT_CERTIFIED
    assert any(each.proof for each in verdict.diagnoses)
    assert "(proved of the motion that was given)" in str(verdict)
    assert "(proved)" not in str(verdict)
    store = ox.Store()
    write(store, to_record(verdict))
    return store


@pytest.mark.parametrize("name", QUESTIONS)
def test_a_refused_motion_is_no_container_that_a_robot_cannot_open(refused: ox.Store, name: str) -> None:
    query = Path(str(ontology.path("queries"))) / f"{name}.rq"
    assert rows_of(refused.query(query.read_text(), use_default_graph_as_union=True))[1] == []
