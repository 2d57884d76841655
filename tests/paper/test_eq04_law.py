"""Eq. (4): three holding predicates certify; a refusal names every reason."""

from dataclasses import replace

import numpy as np
import pytest

from predicates.case import Case, Kind, Outcome, Verdict
from predicates.causes import causes
from predicates.law import law
from predicates.satisfies_request import demanded
from sdt_kg.errors import NoModeError, UnknownEntityError
from sdt_kg.iri import local_name
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.state import Interval, Region, State
from sdt_kg.task import UNKNOWN, Task, Verb
from services.physics.oracle import Kinematics
from tests.small import small_twin
from tests.small.lift import Lift

PHYSICS, LIFT = Kinematics(), Lift()
TWIN = small_twin("a", ("pr2", "stretch"))
PR2, STRETCH = TWIN.robots
LOW, HIGH = TWIN.container("low_drawer"), TWIN.container("high_drawer")


def only(case: Case) -> Verdict:
    (verdict,) = law(case, PHYSICS, LIFT)
    return verdict


def opening(robot: str = PR2, container: str = LOW.iri) -> Case:
    return Case(TWIN, robot=robot, task=Task(Verb.OPEN, container))


def answers(verdict: Verdict) -> tuple[bool | None, ...]:
    given = (verdict.satisfies_request, verdict.causes, verdict.can_perform)
    return tuple(None if answer is None else answer.holds for answer in given)


def kinds(verdict: Verdict) -> list[Kind]:
    return [diagnosis.kind for diagnosis in verdict.diagnoses]


def test_three_holding_predicates_certify() -> None:
    verdict = only(opening())
    assert verdict.outcome is Outcome.CERTIFIED
    assert answers(verdict) == (True, True, True)
    assert verdict.diagnoses == ()


def test_certification_solves_for_motion_final_state_and_body_motion() -> None:
    case = only(opening()).case
    assert isinstance(case.motion, Motion)
    assert isinstance(case.body_motion, BodyMotion)
    assert case.final == TWIN.at({LOW.joint: float(case.motion.values[-1, 0])}).state


def test_the_motion_of_the_verdict_is_the_one_that_the_robot_makes() -> None:
    proposed = next(PHYSICS.generate(TWIN, demanded(LOW, Verb.OPEN)))
    case = only(opening()).case
    assert isinstance(case.motion, Motion)
    assert (
        case.motion.times[-1] > 1.1 * proposed.times[-1]
    )  # a base at 0.2 m/s cannot follow a drawer at 0.5 m/s


def test_a_body_that_cannot_follow_refuses_and_leaves_the_other_two_holding() -> None:
    verdict = only(opening(STRETCH, HIGH.iri))
    assert verdict.outcome is Outcome.NOT_CERTIFIED
    assert answers(verdict) == (True, True, False)
    (diagnosis,) = verdict.diagnoses
    assert diagnosis.kind is Kind.EMBODIMENT
    assert diagnosis.reason == "the handle of high_drawer needs the lift at 1.3 m"
    assert diagnosis.proof


def test_open_without_a_container_gives_a_verdict_for_each() -> None:
    verdicts = list(law(Case(TWIN, robot=STRETCH, task=Task(Verb.OPEN)), PHYSICS, LIFT))
    outcomes = {local_name(str(v.case.task.container)): v.outcome.value for v in verdicts}  # type: ignore[union-attr]
    assert outcomes == {
        "folding_door": "not_certified",
        "high_drawer": "not_certified",
        "low_drawer": "certified",
        "side_door": "certified",
        "swing_door": "abstained",
    }


def test_without_a_robot_each_robot_of_the_twin_is_asked() -> None:
    verdicts = list(law(Case(TWIN, task=Task(Verb.OPEN, HIGH.iri)), PHYSICS, LIFT))
    assert [(v.case.robot, v.outcome) for v in verdicts] == [
        (PR2, Outcome.CERTIFIED),
        (STRETCH, Outcome.NOT_CERTIFIED),
    ]


def test_without_an_embodiment_nothing_is_certified() -> None:
    (verdict,) = law(Case(TWIN, task=Task(Verb.OPEN, LOW.iri)), PHYSICS)
    assert verdict.outcome is Outcome.NOT_CERTIFIED
    assert answers(verdict) == (True, True, None)
    assert [each.reason for each in verdict.diagnoses] == ["no robot was asked, so CanPerform is open"]


def test_outside_the_scope_the_law_abstains_and_nothing_runs() -> None:
    verdict = only(opening(container=TWIN.container("swing_door").iri))
    assert verdict.outcome is Outcome.ABSTAINED
    assert answers(verdict) == (None, None, None)
    assert set(kinds(verdict)) == {Kind.OUT_OF_SCOPE}


def test_outside_the_scope_no_reason_is_a_proof() -> None:
    door = TWIN.container("swing_door")
    case = replace(opening(container=door.iri), twin=TWIN.at({door.joint: door.upper}))
    verdict = only(case)
    assert verdict.outcome is Outcome.ABSTAINED
    assert {Kind.OUT_OF_SCOPE, Kind.CAUSAL} == set(kinds(verdict))
    assert not any(each.proof for each in verdict.diagnoses)
    assert "proved" not in str(verdict) + verdict._repr_html_()
    (answer,) = causes(case, PHYSICS)
    assert not any(each.proof for each in answer.diagnoses)


def test_what_is_already_so_is_satisfied_but_not_caused() -> None:
    twin = TWIN.at({LOW.joint: 0.5})
    verdict = only(replace(opening(), twin=twin))
    assert verdict.outcome is Outcome.NOT_CERTIFIED
    assert answers(verdict) == (True, False, None)
    assert kinds(verdict) == [Kind.CAUSAL]


def test_a_refusal_names_every_reason() -> None:
    """Too fast, ends too early, and too high for the robot: one reason from each predicate."""
    motion = Motion(HIGH.joint, np.array([0.0, 0.2, 0.4]), np.array([[0.0], [0.15], [0.3]]))
    verdict = only(replace(opening(STRETCH, HIGH.iri), motion=motion))
    assert answers(verdict) == (False, False, False)
    assert set(kinds(verdict)) == {Kind.SEMANTIC, Kind.CAUSAL, Kind.EMBODIMENT}


def test_a_motion_of_another_container_does_not_satisfy_the_request() -> None:
    motion = only(opening()).case.motion
    verdict = only(replace(opening(container=HIGH.iri), motion=motion))
    assert verdict.satisfies_request is not None
    assert not verdict.satisfies_request.holds


def test_a_body_motion_that_lets_go_is_refused() -> None:
    body = only(opening()).case.body_motion
    assert isinstance(body, BodyMotion)
    beside = replace(body, base=body.base + np.array([0.0, 0.05, 0.0]))
    verdict = only(replace(opening(), body_motion=beside))
    assert answers(verdict) == (True, True, False)


def test_a_motion_that_meets_no_new_request_is_explained_by_none() -> None:
    motion = Motion(LOW.joint, np.array([0.0, 2.0]), np.array([[0.0], [0.2]]))
    verdict = only(Case(TWIN, robot=PR2, motion=motion))
    assert verdict.case.task is UNKNOWN
    assert verdict.outcome is Outcome.NOT_CERTIFIED
    assert "the motion meets no request that was not met before" in [d.reason for d in verdict.diagnoses]


@pytest.mark.parametrize("of_state", [True, False])
def test_a_final_state_that_is_given_with_a_task_has_to_be_reached_too(of_state: bool) -> None:
    def final(lower: float, upper: float) -> State | Region:
        middle = State.of({LOW.joint: (lower + upper) / 2})
        return middle if of_state else Region(((LOW.joint, Interval(lower, upper)),))

    reached, missed = (only(replace(opening(), final=final(*each))) for each in ((0.48, 0.482), (0.1, 0.102)))
    assert reached.outcome is Outcome.CERTIFIED
    assert isinstance(reached.case.final, State)
    assert 0.479 <= reached.case.final[LOW.joint] <= 0.483
    assert missed.outcome is Outcome.NOT_CERTIFIED
    assert [each.kind for each in missed.diagnoses] == [Kind.CAUSAL]


def test_a_final_state_of_a_joint_that_there_is_not_is_told_so() -> None:
    with pytest.raises(UnknownEntityError, match=r"no joint named 'low_drawer'; .*low_drawer_joint"):
        only(replace(opening(), final=State.of({LOW.joint.removesuffix("_joint"): 0.5})))


def test_neither_task_nor_motion_is_no_mode() -> None:
    with pytest.raises(NoModeError):
        list(law(Case(TWIN, robot=PR2), PHYSICS, LIFT))
