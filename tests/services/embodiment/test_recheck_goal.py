"""A stored verdict about a goal, or a body motion, of its own: its certificate is about the same."""

from dataclasses import replace

import numpy as np
import pytest

from predicates.case import Answer, Artefact, Case, Outcome
from predicates.record.inputs import goal_of, inputs_of, verdict_iri
from predicates.record.stored import StoredVerdict
from predicates.specification.step import reaches
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.motion import BodyMotion
from sdt_kg.state import Interval, Region, State
from sdt_kg.task import UNKNOWN, Unknown
from services.embodiment.oracle import WholeBody
from services.embodiment.recheck import Rechecked, recheck_verdict
from services.physics.oracle import Kinematics
from tests.services.embodiment.gantry import DRAWER, RESTS, START, gantry_twin, opening

pytestmark = pytest.mark.oracle

HALF_WAY = 0.3  # [m] neither open nor closed
HALF_OPENED = (18.0, 0.1, 0.0, 0.0, 0.2, 0.635, 0.0, 0.005, HALF_WAY)
ROBOT, PHYSICS = WholeBody(Drive.OMNI, START), Kinematics()


def goal(position: float) -> Region:
    return Region(((DRAWER, Interval(position - 0.002, position + 0.002)),))


@pytest.fixture(scope="module")
def certified(tmp_path_factory: pytest.TempPathFactory) -> Answer:
    """CanPerform of a motion that opens the drawer half way."""
    twin = gantry_twin(tmp_path_factory.mktemp("goal"))
    case = Case(twin, twin.robots[0], body_motion=opening(rests=np.vstack((RESTS[:-1], HALF_OPENED))))
    answers = reaches(goal(HALF_WAY), twin.container("drawer_main"), case, PHYSICS, ROBOT)
    assert all(each.holds for each in answers)
    return answers[-1]


def recheck(
    certified: Answer,
    final: Region | State | Unknown = UNKNOWN,
    body_motion: BodyMotion | Unknown = UNKNOWN,
    refused: bool = False,
) -> Rechecked:
    """Of the verdict that was asked for this goal and this motion, with that certificate.

    Where it is `refused`, CanPerform is said to hold alone.
    """
    twin = certified.case.twin
    inputs = inputs_of(Case(twin, twin.robots[0], final=final, body_motion=body_motion), PHYSICS, ROBOT)
    stored = StoredVerdict(
        iri=verdict_iri(inputs),
        outcome=Outcome.NOT_CERTIFIED if refused else Outcome.CERTIFIED,
        environment=twin.environment,
        robot=twin.robots[0],
        verb=None,
        container=twin.container("drawer_main").iri,
        satisfies_request=not refused,
        causes=not refused,
        can_perform=True,
        diagnoses=(),
        notes=(),
        figures=certified.figures,
        inputs=inputs,
        seconds=0.0,
    )
    assert isinstance(certified.artefact, Artefact)
    return recheck_verdict(stored, certified.artefact, lambda *_: (twin, "given"))


def test_the_certificate_of_a_drawer_that_was_to_be_half_open_holds(certified: Answer) -> None:
    assert recheck(certified, goal(HALF_WAY)).reasons == ()


def test_it_shows_nothing_of_a_goal_where_the_drawer_does_not_end(certified: Answer) -> None:
    found = recheck(certified, goal(0.35))
    assert "drawer_main_joint ends at 0.3, not in [0.348, 0.352]" in found.reasons


def test_a_verdict_that_the_robot_can_move_so_and_does_not_reach_the_goal_holds(certified: Answer) -> None:
    found = recheck(certified, goal(0.35), refused=True)
    assert found.reasons == ()
    assert "not certified, as the verdict says: what holds is that the robot can move so" in found.notes
    other = recheck(certified, goal(HALF_WAY), refused=True)
    assert other.reasons == ("the predicates that hold are not those of which the verdict says so",)


def test_a_goal_that_is_told_by_a_hash_alone_is_compared_with_nothing(certified: Answer) -> None:
    found = recheck(certified, certified.case.twin.state)
    assert "and not the goal itself" in found.reasons[0]


def test_a_goal_is_read_as_it_was_asked_for(certified: Answer) -> None:
    for asked in (UNKNOWN, Region((*goal(0.1 + 0.2).intervals, ("https://example.org/id/b", Interval())))):
        said = dict(inputs_of(Case(certified.case.twin, final=asked), PHYSICS, None))["final"]
        assert goal_of(said) == (None if asked is UNKNOWN else asked)
    with pytest.raises(InputError, match="not the goal itself"):
        goal_of("https://example.org/id/b 1_0 to 2")


def test_the_certificate_of_the_motion_that_was_given_holds(certified: Answer) -> None:
    given = certified.case.body_motion
    assert isinstance(given, BodyMotion)
    assert recheck(certified, goal(HALF_WAY), given).reasons == ()
    none = np.zeros((len(given.times), 0))
    silent = replace(given, kitchen_joints=(), kitchen_q=none, kitchen_v=none)
    assert recheck(certified, goal(HALF_WAY), silent).reasons == ()


def test_it_shows_nothing_of_another_motion_that_was_given(certified: Answer) -> None:
    given = certified.case.body_motion
    assert isinstance(given, BodyMotion)
    found = recheck(certified, goal(HALF_WAY), replace(given, times=2 * given.times))
    assert found.reasons == (
        "the verdict is about a body motion that was given, and its certificate has another one",
    )
