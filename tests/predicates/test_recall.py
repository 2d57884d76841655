"""A repeated question gets the stored verdict; a searched refusal only within its own budget."""

from collections.abc import Iterator
from dataclasses import replace

import pyoxigraph as ox
import pytest

from predicates.case import Answer, Case, Diagnosis, Kind, Outcome, Search, Verdict
from predicates.law import law
from predicates.record import read_verdicts, to_json, to_record, write
from predicates.record.recall import Recall
from sdt_kg.task import Task, Verb
from services.physics.oracle import Kinematics
from tests.small import small_twin
from tests.small.far import Far
from tests.small.lift import Lift

TWIN = small_twin("a", ("pr2", "stretch"))
AS_FOUND = ("notes", "times", "gripper", "stored")
"""Of the JSON object: notes have no order in RDF, steps and motions are not among the triples."""


class Counting(Far):
    """The same oracle, which counts how often it is asked, with a budget of its own."""

    def __init__(self, budget: float = 1.0) -> None:
        super().__init__()
        self.asked = 0
        self.seconds = budget

    def settings(self, twin: object, robot: str) -> tuple[tuple[str, str], ...]:
        return (("drive", "omni"), ("budget", f"{self.seconds:g} s"))

    def perform(self, case: Case) -> Answer:
        self.asked += 1
        return super().perform(case)


def memory(store: ox.Store) -> Recall:
    return {each.iri: each for each in read_verdicts(store)}.get


def judged(store: ox.Store, oracle: Lift, container: str = "low_drawer", robot: int = 0) -> Verdict:
    task = Task(Verb.OPEN, TWIN.container(container).iri)
    verdicts: Iterator[Verdict] = law(
        Case(TWIN, robot=TWIN.robots[robot], task=task), Kinematics(), oracle, memory(store)
    )
    (made,) = verdicts
    return made


@pytest.mark.parametrize(
    ("container", "robot", "outcome"),
    [("low_drawer", 0, "certified"), ("high_drawer", 1, "not_certified"), ("swing_door", 0, "abstained")],
)
def test_a_repeat_is_answered_from_the_store_and_says_the_same(
    container: str, robot: int, outcome: str
) -> None:
    store, oracle = ox.Store(), Counting()
    first = judged(store, oracle, container, robot)
    write(store, to_record(first))
    asked = oracle.asked
    again = judged(store, oracle, container, robot)
    assert oracle.asked == asked
    before, after = to_json(first), to_json(again)
    assert (before["stored"], after["stored"]) == (False, True)
    assert before["outcome"] == outcome
    assert sorted(before["notes"]) == after["notes"]
    assert {k: v for k, v in before.items() if k not in AS_FOUND} == {
        k: v for k, v in after.items() if k not in AS_FOUND
    }


def test_a_stored_abstention_proves_nothing_whatever_its_record_says() -> None:
    store = ox.Store()
    made = judged(store, Counting(), "swing_door")
    met = Diagnosis(Kind.CAUSAL, "nothing to cause: it is open", proof=True)
    write(store, to_record(replace(made, diagnoses=(*made.diagnoses, met))))
    (stored,) = read_verdicts(store)
    assert len(stored.diagnoses) == len(made.diagnoses) + 1
    assert not any(each.proof for each in stored.diagnoses)
    assert not any(each.proof for each in judged(store, Counting(), "swing_door").diagnoses)


def test_another_question_is_judged() -> None:
    store, oracle = ox.Store(), Counting()
    write(store, to_record(judged(store, oracle)))
    judged(store, oracle, robot=1)
    assert oracle.asked == 2


@pytest.mark.parametrize(("budget", "judgings"), [(1.0, 0), (0.5, 0), (2.0, 1)])
def test_a_searched_refusal_answers_only_within_its_budget(budget: float, judgings: int) -> None:
    store = ox.Store()
    searched = Diagnosis(Kind.EMBODIMENT, "no placement found", search=Search(5, 2, 3, 1.0))
    refused = replace(judged(store, Counting(1.0)), outcome=Outcome.NOT_CERTIFIED, diagnoses=(searched,))
    write(store, to_record(refused))
    oracle = Counting(budget)
    again = judged(store, oracle)
    assert oracle.asked == judgings
    assert again.outcome is (Outcome.CERTIFIED if judgings else Outcome.NOT_CERTIFIED)
