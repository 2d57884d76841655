"""Eq. (6): Causes, with Φ = rigid-body kinematics built from the twin."""

import numpy as np
import pytest

from predicates.case import Answer, Case, Code, Kind, Quantity
from predicates.causes import causes
from sdt_kg.errors import NoModeError
from sdt_kg.motion import Motion
from sdt_kg.state import Interval, Region, State
from sdt_kg.task import Task, Verb
from services.physics.oracle import Kinematics
from tests.small import small_twin

PHYSICS = Kinematics()
TWIN = small_twin("a")
DRAWER = TWIN.container("low_drawer")


def slide(*positions: float, seconds: float = 4.0) -> Motion:
    return Motion(DRAWER.joint, np.linspace(0, seconds, len(positions)), np.array(positions)[:, None])


def verified(motion: Motion, **known: object) -> Answer:
    (answer,) = causes(Case(TWIN, motion=motion, **known), PHYSICS)  # type: ignore[arg-type]
    return answer


def test_a_given_motion_causes_the_state_in_which_it_ends() -> None:
    answer = verified(slide(0, 0.1, 0.3, 0.47))
    assert answer.holds
    assert isinstance(answer.case.final, State)
    assert answer.case.final == TWIN.at({DRAWER.joint: 0.47}).state


def test_a_motion_that_stops_short_causes_something_else_than_the_given_state() -> None:
    answer = verified(slide(0, 0.1, 0.2), final=Region(((DRAWER.joint, Interval(0.45, 0.5)),)))
    (diagnosis,) = answer.diagnoses
    assert not answer.holds
    assert diagnosis.reason == "low_drawer_joint ends at 0.2, not in [0.45, 0.5]"


@pytest.mark.parametrize(
    ("goal", "told"),
    [
        ((0.200001, 0.5), "ends at 0.2, not in [0.200001, 0.5]"),
        ((0, 0.199999), "ends at 0.2, not in [0, 0.199999]"),
    ],
)
def test_a_motion_that_ends_just_beside_the_goal_is_not_told_to_end_in_it(
    goal: tuple[float, float], told: str
) -> None:
    answer = verified(slide(0, 0.1, 0.2), final=Region(((DRAWER.joint, Interval(*goal)),)))
    assert answer.diagnoses[0].reason == f"low_drawer_joint {told}"


def test_a_task_without_motion_finds_one_into_its_region() -> None:
    (answer,) = causes(Case(TWIN, task=Task(Verb.OPEN, DRAWER.iri)), PHYSICS)
    assert answer.holds
    assert isinstance(answer.case.motion, Motion)
    assert answer.case.motion.values[-1, 0] == pytest.approx(0.453, abs=1e-12)  # 0.9 · 0.5 m, and 3 mm
    assert not answer.case.motion.timed


def test_closing_goes_to_the_lower_limit() -> None:
    twin = TWIN.at({DRAWER.joint: 0.5})
    (answer,) = causes(Case(twin, task=Task(Verb.CLOSE, DRAWER.iri)), PHYSICS)
    assert isinstance(answer.case.motion, Motion)
    assert answer.case.motion.values[[0, -1], 0].tolist() == [0.5, 0.0]


def test_open_without_a_container_gives_one_answer_for_each() -> None:
    answers = list(causes(Case(TWIN, task=Task(Verb.OPEN)), PHYSICS))
    tasks = [answer.case.task for answer in answers]
    assert [task.container for task in tasks if isinstance(task, Task)] == [c.iri for c in TWIN.containers()]


def test_a_mimic_door_is_moved_by_its_own_joint_and_takes_the_actuated_one_along() -> None:
    door = TWIN.container("folding_door")
    (answer,) = causes(Case(TWIN, task=Task(Verb.OPEN, door.iri)), PHYSICS)
    assert isinstance(answer.case.motion, Motion)
    assert isinstance(answer.case.final, State)
    assert answer.case.motion.of == door.joint
    assert answer.case.final[door.joint] == pytest.approx(1.805, abs=1e-12)  # 0.9 · 2.0 rad, and 0.005
    assert answer.case.final[door.active_joint] == pytest.approx(0.9025, abs=1e-12)


def test_what_is_already_so_cannot_be_caused() -> None:
    twin = TWIN.at({DRAWER.joint: 0.45})
    (answer,) = causes(Case(twin, task=Task(Verb.OPEN, DRAWER.iri)), PHYSICS)
    (diagnosis,) = answer.diagnoses
    assert not answer.holds
    assert diagnosis.kind is Kind.CAUSAL
    assert diagnosis.reason == "nothing to cause: low_drawer at 0.45 m already meets open"
    assert diagnosis.code is Code.NOTHING_TO_CAUSE


def test_a_motion_cannot_cause_what_is_already_so() -> None:
    twin = TWIN.at({DRAWER.joint: 0.46})
    case = Case(twin, task=Task(Verb.OPEN, DRAWER.iri), motion=slide(0.46, 0.48))
    (answer,) = causes(case, PHYSICS)
    assert not answer.holds
    assert answer.diagnoses[0].reason.startswith("nothing to cause")


@pytest.mark.parametrize(
    ("motion", "quantity", "bound"),
    [
        (slide(0, 0.2, 0.52, seconds=9), Quantity.POSITION, 0.5),
        (slide(0, 0.23, 0.46, seconds=1.0), Quantity.VELOCITY, 0.5),
        (slide(0, 0.1, 0, 0.1, 0, seconds=1.5), Quantity.ACCELERATION, 1.0),
    ],
)
def test_limits_bind_along_the_whole_motion(motion: Motion, quantity: Quantity, bound: float) -> None:
    answer = verified(motion)
    assert not answer.holds
    evidence = [each.evidence for each in answer.diagnoses if each.evidence]
    assert (quantity, bound) in {(each.quantity, each.bound) for each in evidence}
    assert all(each.kind is Kind.CAUSAL and each.proof for each in answer.diagnoses)


def test_a_motion_begins_where_the_kitchen_is() -> None:
    answer = verified(slide(0.2, 0.3, 0.46))
    assert [each.reason for each in answer.diagnoses] == [
        "low_drawer_joint is at 0 m, the motion begins at 0.2 m"
    ]


def test_outside_the_scope_nothing_is_replayed() -> None:
    door = TWIN.container("swing_door")  # closed is in the middle of its range: lower is negative
    (answer,) = causes(Case(TWIN, task=Task(Verb.OPEN, door.iri)), PHYSICS)
    assert not answer.holds
    assert {each.kind for each in answer.diagnoses} == {Kind.OUT_OF_SCOPE}
    assert not any(each.proof for each in answer.diagnoses)


def test_a_final_state_alone_is_reached_by_one_motion() -> None:
    (answer,) = causes(Case(TWIN, final=TWIN.at({DRAWER.joint: 0.3}).state), PHYSICS)
    assert answer.holds
    assert isinstance(answer.case.motion, Motion)
    assert answer.case.motion.values[-1, 0] == 0.3


def test_two_containers_are_not_reached_by_one_motion() -> None:
    final = TWIN.at({DRAWER.joint: 0.3, TWIN.container("side_door").joint: 1.0}).state
    (answer,) = causes(Case(TWIN, final=final), PHYSICS)
    assert not answer.holds


def test_neither_motion_nor_task_nor_state_is_no_mode() -> None:
    with pytest.raises(NoModeError):
        list(causes(Case(TWIN), PHYSICS))
