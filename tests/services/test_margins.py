"""A smallest distance up to which was looked is told as a bound, one that was measured as a measurement."""

from dataclasses import replace

import pyoxigraph as ox
import pytest

from predicates.case import Case, Verdict
from predicates.law import law
from predicates.margins import LOOKED_UP_TO, at_least
from predicates.record import to_json, to_record, write
from predicates.specification.model import Quality
from predicates.specification.read import read_specification
from predicates.specification.results.record import task_record
from sdt_kg.task import Task, Verb
from services.app import Service
from services.commands.law.task import _print as print_task
from services.commands.verdicts import print_verdict
from services.embodiment.place import answer
from services.embodiment.place.placement import Placement, Spot
from services.physics.oracle import Kinematics
from services.reports.studies import diagnosis, feasibility
from services.reports.studies.judged import Judgements
from services.specifications import TaskResult, achieve_task, result_json
from services.whatif import World
from services.why import why
from tests.services.commands.test_task import task
from tests.small import small_twin
from tests.small.far import NEAR_ITSELF, TO_ITSELF, TO_KITCHEN, Far, FarLifts

TWIN = small_twin("a", ("pr2",))
CLEAREST = "law:optimises law:SmallestClearance ."


def verdict() -> Verdict:
    request = Task(Verb.OPEN, TWIN.container("low_drawer").iri)
    (made,) = law(Case(TWIN, robot=TWIN.robots[0], task=request), Kinematics(), Far())
    return made


def best(to_itself: float) -> TaskResult:
    service = Service(TWIN, oracles=FarLifts(to_itself))
    return achieve_task(service, read_specification(TWIN, task(CLEAREST), "task.ttl"))


def test_only_a_smallest_distance_of_just_the_bound_is_one() -> None:
    measured = {TO_ITSELF: (0.0199, "m"), "tool slip": (LOOKED_UP_TO, "m")}
    assert at_least(measured | {TO_KITCHEN: (LOOKED_UP_TO, "m")}) == (TO_KITCHEN,)


def test_on_the_shell(capsys: pytest.CaptureFixture[str]) -> None:
    print_verdict(to_json(verdict()))
    lines = [
        line.split(maxsplit=3)[2:] for line in capsys.readouterr().out.splitlines() if "smallest" in line
    ]
    assert lines == [["environment", "at least 0.02 m"], ["self", "0.0145 m"]]


def test_json_keeps_its_figures_and_names_the_bounds() -> None:
    said = to_json(verdict())
    assert said["figures"] == {TO_KITCHEN: [LOOKED_UP_TO, "m"], TO_ITSELF: [NEAR_ITSELF, "m"]}
    assert said["at_least"] == [TO_KITCHEN]


def test_where_a_stored_verdict_is_told_on_the_3d_page_too() -> None:
    store, made = ox.Store(), verdict()
    write(store, to_record(made))
    text = why(store, made.iri)
    assert f"\n{TO_KITCHEN}: at least 0.02 m\n" in text
    assert f"\n{TO_ITSELF}: 0.0145 m\n" in text


def test_in_the_table_of_a_report() -> None:
    world = World(Service(TWIN), "pr2")
    rows = diagnosis.margins(diagnosis.Diagnosed(world, "open:low_drawer", verdict(), "here", None)).rows
    assert rows == ((f"{TO_KITCHEN}, at least", LOOKED_UP_TO, "m"), (TO_ITSELF, NEAR_ITSELF, "m"))


def test_under_the_figure_of_a_report() -> None:
    asked = Judgements(Service(TWIN), "open", ("pr2",), (), 0)
    assert (
        "not looked at above 20 mm: a dot there stands for at least that"
        in feasibility.margins(asked).caption
    )


def test_of_places_for_the_base() -> None:
    poses = tuple(Spot(0.0, 0.0, 0.0, margin, "left") for margin in (LOOKED_UP_TO, 0.0145))
    found = Placement("drawer", poses, (), 2, (), 1.0)
    said = answer.to_json(found)
    told = [line.rpartition(", ")[2] for line in answer.lines(said)][:2]
    assert told == ["margin at least 20.0 mm", "margin 14.5 mm"]
    assert [each["margin"] == said["margins_looked_up_to"] for each in said["spots"]] == [True, False]


@pytest.mark.parametrize(("to_itself", "said"), [(LOOKED_UP_TO, "at least 0.02 m"), (0.0145, "0.0145 m")])
def test_as_j_of_a_task(to_itself: float, said: str, capsys: pytest.CaptureFixture[str]) -> None:
    result = best(to_itself)
    told = result_json(result)
    assert told["quality"]["value"] == to_itself
    assert told["quality"]["at_least"] is told["steps"][0]["at_least"] is (to_itself == LOOKED_UP_TO)
    print_task(told)
    shell = capsys.readouterr().out
    assert f"J = SmallestClearance: {said}, best of those found" in shell
    assert f"(seed 0, {said}: best of" in shell
    store = ox.Store()
    write(store, task_record(result))
    text = why(store, result.iri)
    assert f"J = SmallestClearance: {said}, of the best found" in text
    assert f"motion of seed 0, {said}: of " in text


def test_another_j_of_the_same_value_is_none() -> None:
    travelled = best(LOOKED_UP_TO)
    quality = replace(travelled.specification, quality=Quality.BASE_TRAVEL)
    assert result_json(replace(travelled, specification=quality))["quality"]["at_least"] is False
