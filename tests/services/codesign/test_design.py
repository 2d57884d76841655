"""Covers are greedy over what is certified; a plan's edits are judged in one world, one after the other."""

import pytest

from predicates.case import Outcome
from sdt_kg.annotation import Drive
from services.app import Policy
from services.codesign.asked import Asked
from services.codesign.design import covers_of, designed, together_in
from services.codesign.entries import Entry, Found, Grid, How
from services.codesign.report import counts, reused, turned_rows, why

REASON = (
    {"kind": "embodiment", "reason": "too high", "evidence": None, "proof": False, "search": {"seeds": 9}},
)
DOES = {"one": "abcd", "two": "cdef", "three": "fg"}


def entry(robot: str, container: str, certified: bool, edits=(), how=How.LAW) -> Entry:
    outcome = Outcome.CERTIFIED if certified else Outcome.NOT_CERTIFIED
    holds = {"satisfiesRequest": True, "causes": True, "canPerform": certified}
    return Entry("k", robot, container, edits, Found("", outcome, how, holds, () if certified else REASON))


GRID = Grid([entry(robot, each, each in does) for robot, does in DOES.items() for each in "abcdefg"])


def test_the_robot_that_does_most_comes_first_and_says_what_it_lacks() -> None:
    covers = covers_of(GRID)
    assert [(each.robot, len(each.certified), each.of) for each in covers] == [
        ("one", 4, 7),
        ("two", 4, 7),
        ("three", 2, 7),
    ]
    assert covers[2].missing == tuple((each, "too high (searched)") for each in "abcde")


def test_robots_together_are_taken_by_how_much_they_add() -> None:
    steps = together_in("k", covers_of(GRID))
    assert [(each.what, "".join(each.gained), each.covered) for each in steps] == [
        ("one", "abcd", 4),
        ("three", "fg", 6),
        ("two", "e", 7),
    ]
    without = [each for each in covers_of(GRID) if each.robot != "three"]
    assert together_in("k", without)[-1].covered == 6


def test_a_grid_says_what_turned_and_counts_as_reused_only_what_was_not_searched_again() -> None:
    edits = ("box:crate=1,1,1@0,0,0",)
    entries = [entry("one", "a", True), entry("one", "b", False)]
    entries += [entry("one", "a", False, edits), entry("one", "b", False, edits, How.LESS_ROOM)]
    grid = Grid(entries)
    assert [(each["container"], each["predicates"]) for each in turned_rows(grid)] == [
        ("a", "canPerform yes → no")
    ]
    assert counts(grid)[1]["k one"] == "0 / 2 (-1)"
    assert (reused(grid)["without_a_search"], reused(grid)["cases"]) == (1, 2)


def test_a_refusal_says_whether_it_was_proved_measured_or_only_searched() -> None:
    searched = {**REASON[0]}
    measured, proved = {**searched, "search": None}, {**searched, "proof": True}

    def basis(*said: dict[str, object], outcome: Outcome = Outcome.NOT_CERTIFIED) -> str:
        return Found("", outcome, How.LAW, {}, said).basis

    assert basis(searched) == "searched"
    assert basis(searched, measured) == "measured"
    assert basis(searched, measured, proved) == "proved"
    assert not basis(measured, outcome=Outcome.ABSTAINED)
    refused = Found("", Outcome.NOT_CERTIFIED, How.LAW, {}, (measured, proved))
    assert (
        why(Entry("k", "one", "a", (), refused)) == "too high (measured)"
    )  # what is proved is another reason


@pytest.mark.oracle
def test_what_gains_no_more_than_it_loses_is_not_taken_and_told() -> None:
    drawer, door = "dishwasher_drawer_middle", "cabinet7_door_bottom_left"
    asked = Asked(("a",), ("pr2",), "open", (), Policy(Drive.OMNI, budget=30), (), (drawer, door))
    (plan,) = designed(asked, 1, (f"clear:{door}",)).plans
    assert plan.steps == ()
    assert [(each.what, each.gained, each.lost) for each in plan.even] == [
        (f"clear:{door}", (drawer,), (door,))
    ]
