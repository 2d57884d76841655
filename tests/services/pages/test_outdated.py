"""Verdicts of another version of sdt: no page shows one as an answer to what is asked now."""

from collections.abc import Iterator
from contextlib import closing

import pytest

from predicates.case import Case
from predicates.law import law
from predicates.specification.read import read_specification
from predicates.specification.results.record import task_record
from sdt_kg.task import Task, Verb
from services.app import Service
from services.http.pages.feasibility.cells import Found
from services.physics.oracle import Kinematics
from services.specifications import TaskResult, achieve_task, keep
from services.store.files import SavedVerdicts, opened
from services.versions import KINEMATICS_VERSION
from services.why import why
from tests.services.http.conftest import Serve, Served
from tests.services.pages.conftest import PAGE, text_of, verdict_link
from tests.services.pages.test_tasks import TASK
from tests.small import small_twin
from tests.small.before import Before, LiftsBefore
from tests.small.lift import Lift, Lifts

NOW = KINEMATICS_VERSION


@pytest.fixture(scope="module")
def served(serve: Serve, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """Two drawers: both were judged by another version, one also by this."""
    twin = small_twin("a", ("pr2",))
    path = tmp_path_factory.mktemp("outdated") / "verdicts.nq"
    with SavedVerdicts(str(path)) as saved:
        for name, physics in (
            ("low_drawer", Before()),
            ("low_drawer", Kinematics()),
            ("high_drawer", Before()),
        ):
            case = Case(twin, robot=twin.robots[0], task=Task(Verb.OPEN, twin.container(name).iri))
            (verdict,) = law(case, physics, Lift())
            saved.add(verdict)
    with closing(opened(path)) as archive:
        yield serve(kitchens=("a",), robots=("pr2",), archive=archive)


@pytest.fixture(scope="module")
def tasks(serve: Serve, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Served, TaskResult]]:
    """A task whose result is there of another version and of this; and the former."""
    twin = small_twin("a", ("pr2",))
    asked = read_specification(twin, TASK % 1.5, "task.ttl")
    before, now = (achieve_task(Service(twin, oracles=each), asked) for each in (LiftsBefore(), Lifts()))
    path = tmp_path_factory.mktemp("outdated") / "tasks.nq"
    with SavedVerdicts(str(path)) as saved:
        keep(saved, before)
        keep(saved, now)
    with closing(opened(path)) as archive:
        yield serve(kitchens=("a",), robots=("pr2",), archive=archive), before


def test_the_matrix_counts_what_another_version_judged_as_outdated(served: Served) -> None:
    data = served.get("/kitchens/a.json").json()
    cells = {each["container"]: each for each in data["cells"]}
    low, high = cells["low_drawer"], cells["high_drawer"]
    assert (low["standing"], low["was"], low["others"]) == ("certified", None, 1)
    assert (high["standing"], high["was"], high["proved"]) == ("outdated", "certified", None)
    assert high["verdict"] is not None
    (pr2,) = data["robots"]
    assert (pr2["standings"]["certified"], pr2["unjudged"]) == (1, 4)


def test_the_matrix_says_outdated_in_words_with_what_to_do_and_lets_ask_again(served: Served) -> None:
    page = served.get("/kitchens/a", headers=PAGE).text
    cell = text_of(page.partition('id="pr2.high_drawer"')[2].partition("</td>")[0])
    assert "outdated" in cell
    assert "was certified" in cell
    assert "ask again" in cell
    assert "1 case has verdicts of another version of sdt alone" in text_of(page)
    assert "high_drawer" in text_of(served.get("/kitchens/a?show=not+judged", headers=PAGE).text)


def test_the_verdict_s_page_says_which_version_judged_and_which_is_here(served: Served) -> None:
    link = verdict_link(served, container="high_drawer")
    page = served.get(link, headers=PAGE).text
    hero = page.partition('<div class="hero')[2].partition("</div>")[0]
    assert hero.startswith(" k-outdated")
    assert "Outdated, was certified" in hero
    assert f"Judged by kinematics 0 (here {NOW})" in text_of(hero)
    assert served.get(f"{link}.json").json()["outdated"] == [f"kinematics 0 (here {NOW})"]


def test_the_list_and_the_start_page_tell_outdated_ones_apart(served: Served) -> None:
    rows = served.get("/verdicts.json").json()["verdicts"]
    assert sorted((each["container"], each["outdated"]) for each in rows) == [
        ("high_drawer", True),
        ("low_drawer", False),
        ("low_drawer", True),
    ]
    assert text_of(served.get("/verdicts", headers=PAGE).text).count("was certified") == 2
    (kitchen,) = served.get("/index.json").json()["kitchens"]
    assert kitchen["verdicts"] == {"certified": 1, "outdated": 2}
    assert "2 outdated, judged by another version" in text_of(served.get("/", headers=PAGE).text)


def test_the_json_verbs_tell_outdated_ones_apart(served: Served) -> None:
    rows = served.get("/api/v1/verdicts").json()
    assert sorted((each["container"], each["outdated"]) for each in rows) == [
        ("high_drawer", True),
        ("low_drawer", False),
        ("low_drawer", True),
    ]
    for each in rows:
        one = served.get(f"/api/v1/verdicts/{each['iri'].rsplit('/', 1)[1]}").json()
        assert one["outdated"] is each["outdated"]


def test_results_of_tasks_tell_outdated_ones_apart(tasks: tuple[Served, TaskResult]) -> None:
    served, before = tasks
    rows = served.get("/tasks.json").json()["results"]
    assert {each["result"] == before.iri: each["outdated"] for each in rows} == {True: True, False: False}
    assert text_of(served.get("/tasks", headers=PAGE).text).count("was certified") == 1


def test_the_page_of_a_task_s_result_says_which_version_judged(tasks: tuple[Served, TaskResult]) -> None:
    served, before = tasks
    link = before.iri.removeprefix("https://example.org")
    hero = served.get(link, headers=PAGE).text.partition('<div class="hero')[2].partition("</div>")[0]
    assert hero.startswith(" k-outdated")
    assert "Outdated, was certified" in hero
    assert f"Judged by kinematics 0 (here {NOW})" in text_of(hero)
    assert served.get(f"{link}.json").json()["outdated"] == [f"kinematics 0 (here {NOW})"]
    assert "OUTDATED, WAS CERTIFIED" in why(task_record(before).quads(), before.iri)


def test_what_still_answers_is_shown_before_what_does_not_even_of_a_later_version() -> None:
    def found(physics: str) -> Found:
        return Found("v", "r", "c", "omni", "NotCertified", "", False, "", {"physics": physics})

    assert found(Kinematics().version).rank > found("kinematics 99").rank > found("kinematics 0").rank
