"""The same question in two worlds, and the smallest change that turns the answer."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from predicates.case import Case, Outcome, Verdict
from predicates.counterfactual import Contrast, between, nearest_turns, smallest_turn, widest_gap
from predicates.law import law
from sdt_kg.task import Task, Verb
from services.physics.oracle import Kinematics
from tests.small import small_twin
from tests.small.lift import Lift

TWIN = small_twin("a", ("pr2", "stretch"))


def judged(container: str, robot: int = 0) -> Verdict:
    task = Task(Verb.OPEN, TWIN.container(container).iri)
    (made,) = law(Case(TWIN, robot=TWIN.robots[robot], task=task), Kinematics(), Lift())
    return made


CERTIFIED = judged("low_drawer")
REFUSED = replace(CERTIFIED, outcome=Outcome.NOT_CERTIFIED)
ABSTAINED = replace(CERTIFIED, outcome=Outcome.ABSTAINED)


def test_another_robot_turns_can_perform_and_nothing_else() -> None:
    found = Contrast(judged("high_drawer", 0), judged("high_drawer", 1))
    assert found.turned
    assert found.turned_predicates() == (("canPerform", True, False),)
    assert [each.kind.value for each in found.new()] == ["embodiment"]
    assert not found.gone()


def test_the_same_world_turns_nothing() -> None:
    found = Contrast(CERTIFIED, judged("low_drawer"))
    assert (found.turned, found.turned_predicates(), found.gone(), found.new()) == (False, (), (), ())


@given(at=st.floats(0.001, 0.999), scan=st.integers(1, 9), tolerance=st.sampled_from([0.1, 0.01, 0.001]))
def test_the_smallest_turn_is_where_it_is_to_within_the_tolerance(
    at: float, scan: int, tolerance: float
) -> None:
    found = smallest_turn(lambda share: REFUSED if share >= at else CERTIFIED, scan, tolerance)
    assert found.after is not None
    assert found.before.share < at <= found.after.share
    assert found.gap <= tolerance
    assert found.after.verdict.outcome is Outcome.NOT_CERTIFIED


def test_an_abstention_turns_what_was_certified_and_no_refusal() -> None:
    after = smallest_turn(lambda share: CERTIFIED if share < 0.5 else ABSTAINED, 4, 0.01).after
    assert after is not None
    assert after.share == pytest.approx(0.5, abs=0.01)
    assert smallest_turn(lambda share: REFUSED if share < 0.5 else ABSTAINED, 4, 0.01).after is None
    found = smallest_turn(lambda share: (REFUSED, ABSTAINED, CERTIFIED)[int(share * 2.9)], 4, 0.01).after
    assert found is not None
    assert found.verdict.outcome is Outcome.CERTIFIED


def test_no_turn_is_said_with_all_that_was_tried() -> None:
    found = smallest_turn(lambda share: CERTIFIED, 4, 0.1)
    assert found.after is None
    assert [each.share for each in found.tried] == [0.0, 0.25, 0.5, 0.75, 1.0]


@pytest.mark.parametrize("scan", [1, 4])
def test_every_share_is_judged_once(scan: int) -> None:
    shares: list[float] = []

    def judge(share: float) -> Verdict:
        shares.append(share)
        return REFUSED if share > 0.3 else CERTIFIED

    smallest_turn(judge, scan, 0.01)
    assert len(shares) == len(set(shares))


@given(ends=st.lists(st.floats(0.01, 2), min_size=1, max_size=3), scan=st.integers(1, 6))
def test_of_several_directions_those_that_turn_first_are_told_to_within_the_tolerance(
    ends: list[float], scan: int
) -> None:
    judges = [lambda share, end=end: REFUSED if share >= end else CERTIFIED for end in ends]
    found = nearest_turns(judges, CERTIFIED, scan, 0.01)
    turned = [
        (each.after.share, end) for each, end in zip(found, ends, strict=True) if each.after is not None
    ]
    assert bool(turned) == (min(ends) <= 1)
    assert all(share - 0.01 <= end <= share for share, end in turned)
    assert not turned or min(end for _, end in turned) == min(ends)


def test_a_search_that_is_late_says_how_far_it_came() -> None:
    shares: list[float] = []

    def judge(share: float) -> Verdict:
        shares.append(share)
        return CERTIFIED

    (found,) = nearest_turns([judge], CERTIFIED, 4, 0.1, lambda: len(shares) == 2)
    assert (found.after, found.before.share, shares) == (None, 0.5, [0.25, 0.5])


def test_shares_between_are_multiples_of_a_step_that_were_not_tried_below_the_turn() -> None:
    assert between([0.0, 0.5, 1.0], 1.0, 0.25) == [0.25, 0.75]
    assert between([0.0, 0.25], 0.5, 0.125) == [0.125, 0.375]
    assert between([0.0], 0.3, 0.25) == [0.25]
    assert between([0.0], 0.25, 0.25) == []


def test_the_widest_gap_is_from_nothing_to_the_turn_whatever_was_tried_beyond() -> None:
    assert widest_gap([0.0, 0.25, 0.375, 1.0], 0.5) == 0.25
    assert widest_gap([0.0, 1.0], 0.5) == 0.5
    assert widest_gap([0.5, 0.25, 0.0], 0.5) == 0.25
    assert widest_gap([], 1.0) == 1.0


@given(turn=st.floats(0.01, 1), halvings=st.integers(0, 6))
def test_what_lies_between_leaves_no_gap_wider_than_its_step(turn: float, halvings: int) -> None:
    step = 0.5**halvings
    assert widest_gap(between([], turn, step), turn) <= step
