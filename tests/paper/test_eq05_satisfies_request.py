"""Eq. (5): SatisfiesRequest, forwards and backwards."""

import pytest

from predicates.case import Answer, Case, Kind
from predicates.satisfies_request import satisfies_request
from sdt_kg.errors import NoModeError
from sdt_kg.state import Interval, Region, State
from sdt_kg.task import Task, Verb
from tests.small import small_twin

TWIN = small_twin("b")
DRAWER, OVEN = TWIN.container("top_drawer"), TWIN.container("oven_door")
HALF = TWIN.at({DRAWER.joint: 0.25}).state
OPENED = TWIN.at({DRAWER.joint: 0.48}).state


def requests(answers: list[Answer]) -> set[tuple[str, str]]:
    tasks = [answer.case.task for answer in answers]
    return {(task.verb.value, str(task.container)) for task in tasks if isinstance(task, Task)}


def test_forwards_one_answer_about_the_named_container() -> None:
    (answer,) = satisfies_request(Case(TWIN, task=Task(Verb.OPEN, DRAWER.iri), final=OPENED))
    assert answer.holds
    assert answer.diagnoses == ()


def test_a_state_that_does_not_meet_the_request_says_how_far_it_is() -> None:
    (answer,) = satisfies_request(Case(TWIN, task=Task(Verb.OPEN, DRAWER.iri), final=HALF))
    (diagnosis,) = answer.diagnoses
    assert diagnosis.kind is Kind.SEMANTIC
    assert diagnosis.reason == "top_drawer ends at 0.25 m: open begins at 0.45 m"
    assert diagnosis.evidence is not None
    assert (diagnosis.evidence.value, diagnosis.evidence.bound, diagnosis.evidence.unit) == (0.25, 0.45, "m")


def test_a_state_that_all_but_meets_the_request_is_not_told_to_meet_it() -> None:
    almost = TWIN.at({DRAWER.joint: 0.449999}).state
    (answer,) = satisfies_request(Case(TWIN, task=Task(Verb.OPEN, DRAWER.iri), final=almost))
    assert answer.diagnoses[0].reason == "top_drawer ends at 0.449999 m: open begins at 0.45 m"


@pytest.mark.parametrize(("at", "holds"), [(0.48, True), (0.25, False), (0.0, False)])
def test_a_state_that_names_some_joints_has_the_others_where_the_twin_has_them(
    at: float, holds: bool
) -> None:
    twin = TWIN.at({DRAWER.joint: at})
    case = Case(twin, task=Task(Verb.OPEN, DRAWER.iri), final=State.of({OVEN.joint: 0.3}))
    (answer,) = satisfies_request(case)
    assert answer.holds is holds
    backwards = requests(list(satisfies_request(Case(twin, final=State.of({OVEN.joint: 0.3})))))
    assert (("open", DRAWER.iri) in backwards) is holds


def test_open_without_a_container_asks_about_each_of_them() -> None:
    answers = list(satisfies_request(Case(TWIN, task=Task(Verb.OPEN), final=OPENED)))
    assert [answer.holds for answer in answers] == [False, True]  # oven_door, top_drawer
    assert requests(answers) == {("open", OVEN.iri), ("open", DRAWER.iri)}


def test_backwards_every_request_that_the_state_meets() -> None:
    answers = list(satisfies_request(Case(TWIN, final=OPENED)))
    assert requests(answers) == {("open", DRAWER.iri), ("close", OVEN.iri)}


def test_backwards_a_half_open_drawer_meets_no_request() -> None:
    assert requests(list(satisfies_request(Case(TWIN, final=HALF)))) == {("close", OVEN.iri)}


def test_without_a_final_state_the_answer_is_the_region_that_the_task_demands() -> None:
    (answer,) = satisfies_request(Case(TWIN, task=Task(Verb.CLOSE, DRAWER.iri)))
    assert answer.case.final == Region(((DRAWER.joint, Interval(0.0, 0.01)),))


@pytest.mark.parametrize(
    ("lower", "upper", "holds"),
    [(0.45, 0.5, True), (0.47, 0.48, True), (0.44, 0.5, False), (0.45, 0.6, False)],
)
def test_a_region_satisfies_only_if_all_of_its_states_do(lower: float, upper: float, holds: bool) -> None:
    final = Region(((DRAWER.joint, Interval(lower, upper)),))
    (answer,) = satisfies_request(Case(TWIN, task=Task(Verb.OPEN, DRAWER.iri), final=final))
    assert answer.holds is holds


def test_neither_task_nor_state_is_no_mode() -> None:
    with pytest.raises(NoModeError):
        list(satisfies_request(Case(TWIN)))


def test_what_one_twin_of_a_kitchen_was_asked_is_no_answer_for_an_edited_one() -> None:
    twin = small_twin("b", ("pr2",))
    edited = twin.with_edit(DRAWER.joint, upperLimit=0.3)
    task, final = Task(Verb.OPEN, DRAWER.iri), {DRAWER.joint: 0.28}
    found = [
        next(satisfies_request(Case(each, task=task, final=each.at(final).state)))
        for each in (twin, edited, twin)
    ]
    assert [answer.holds for answer in found] == [False, True, False]
