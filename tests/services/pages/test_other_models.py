"""Verdicts about other models of the names that are served: told apart, and counted apart."""

from collections.abc import Iterator
from contextlib import closing

import pytest

from predicates.case import Case
from predicates.law import law
from predicates.record.inputs import model_input
from sdt_kg.task import Task, Verb
from services.http.kitchens import open_kitchens
from services.physics.oracle import Kinematics
from services.store.files import SavedVerdicts, opened
from tests.services.http.conftest import Serve, Served
from tests.services.pages.conftest import PAGE, text_of, verdict_link
from tests.small import small_twin
from tests.small.lift import Lift


@pytest.fixture(scope="module")
def served(serve: Serve, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """Verdicts about what is served, about an earlier kitchen, an earlier robot, and a robot that is not."""
    twin, other = small_twin("a", ("pr2",)), small_twin("a", ("stretch",))
    (robot,) = twin.robots
    lift = next(each.name for each in twin.mechanism(robot).joints if each.type.value != "fixed")
    cases = (
        ("low_drawer", twin),
        ("high_drawer", twin.with_edit(twin.container("high_drawer").joint, velocityLimit=0.9)),
        ("swing_door", twin.with_edit(f"{robot}/joint/{lift}", velocityLimit=0.9)),
        ("side_door", other),
    )
    path = tmp_path_factory.mktemp("others") / "verdicts.nq"
    with SavedVerdicts(str(path)) as saved:
        for name, one in cases:
            case = Case(one, robot=one.robots[0], task=Task(Verb.OPEN, one.container(name).iri))
            saved.add(next(iter(law(case, Kinematics(), Lift()))))
    with closing(opened(path)) as archive:
        yield serve(kitchens=("a",), robots=("pr2",), archive=archive)


@pytest.mark.parametrize("address", ["/api/v1/verdicts", "/verdicts.json"])
def test_the_lists_say_which_are_about_what_is_served(served: Served, address: str) -> None:
    found = served.get(address).json()
    rows = {each["container"]: each for each in (found if isinstance(found, list) else found["verdicts"])}
    assert {name: each["about_served"] for name, each in rows.items()} == {
        "low_drawer": True,
        "high_drawer": False,
        "swing_door": False,
        "side_door": False,
    }
    kitchens = {name: each["kitchen_hash"] for name, each in rows.items()}
    assert kitchens["low_drawer"] == kitchens["swing_door"] != kitchens["high_drawer"]
    robots = {name: each["robot_hash"] for name, each in rows.items()}
    assert robots["low_drawer"] == robots["high_drawer"] != robots["swing_door"]


def test_a_query_that_computes_says_how_many_it_counts_that_are_about_others(served: Served) -> None:
    nobody = "SELECT ?v { ?v law:container id:nobody }"
    answer = served.post("/api/v1/query", json={"query": nobody}).json()
    assert (answer["computed"]["ran"], answer["computed"]["besides"]) == ([], {"about_other_models": 2})


def test_a_kitchen_with_the_forces_bundled_for_it_is_what_is_served() -> None:
    (kitchen,) = open_kitchens(("b",), ("pr2",)).values()
    forced = kitchen.service.with_forces()
    assert forced.twin.content_hash(forced.twin.environment) != kitchen.twin.content_hash(
        kitchen.twin.environment
    )
    for twin, served in ((forced.twin, True), (kitchen.service.with_forces(handle_force=5.0).twin, False)):
        asked = (model_input(twin, twin.environment), model_input(twin, twin.robots[0]))
        assert (asked in kitchen.models) is served
        for robot in (asked[1], "https://example.org/id/other 0"):
            assert kitchen.is_subject(asked[0], robot) is served, "matrix and start page say the same"


def test_pages_say_so_in_words(served: Served) -> None:
    said = "about models that are not served"
    assert text_of(served.get("/verdicts", headers=PAGE).text).count(said) == 3
    (kitchen,) = served.get("/index.json").json()["kitchens"]
    assert kitchen["verdicts"]["other_models"] == 2, "and the robot that is not served has a column"
    assert sum(kitchen["verdicts"].values()) == 4
    matrix = served.get("/kitchens/a.json").json()
    assert matrix["about_other_models"] == 2
    assert [each["name"] for each in matrix["robots"]] == ["pr2", "stretch"]
    assert f"2 {said}" in text_of(served.get("/", headers=PAGE).text)
    assert said in text_of(served.get(verdict_link(served, container="high_drawer"), headers=PAGE).text)
    assert said not in text_of(served.get(verdict_link(served, container="low_drawer"), headers=PAGE).text)
