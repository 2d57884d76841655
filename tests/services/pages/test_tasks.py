"""What pages say of results of task specifications."""

import csv
import io
from collections.abc import Iterator
from contextlib import closing

import pytest

from predicates.specification.read import read_specification
from services.app import Service
from services.specifications import TaskResult, achieve_task, keep
from services.store.files import SavedVerdicts, opened
from tests.services.http.conftest import Serve, Served, serve  # noqa: F401 - a fixture
from tests.services.pages.conftest import PAGE, text_of
from tests.small import small_twin
from tests.small.lift import Lifts

FORM = {"content-type": "application/x-www-form-urlencoded"} | PAGE
TASK = """
@prefix law: <https://example.org/law#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix t: <https://example.org/id/t/> .
t:task a law:TaskSpecification ; rdfs:label "fetch <it>" ; law:hasStep t:one , t:two ; law:keeps t:rule .
t:one a law:Task ; law:index 1 ; law:verb law:Open ; law:containerName "low_drawer" ; law:goalPosition 0.2 .
t:two a law:Task ; law:index 2 ; law:verb law:Open ; law:containerName "side_door" .
t:rule a law:NeverBeyond ; law:containerName "side_door" ; law:limitPosition %s .
"""


@pytest.fixture(scope="module")
def judged() -> dict[str, TaskResult]:
    """The same steps with a rule that they keep, and with one that they break."""
    service = Service(small_twin("a", ("pr2",)), oracles=Lifts())
    asked = {
        name: read_specification(service.twin, TASK % limit, "task.ttl")
        for name, limit in (("kept", 1.5), ("broken", 1.0))
    }
    return {name: achieve_task(service, each) for name, each in asked.items()}


@pytest.fixture(scope="module")
def served(
    serve: Serve,  # noqa: F811 - the fixture
    judged: dict[str, TaskResult],
    tmp_path_factory: pytest.TempPathFactory,
) -> Iterator[Served]:
    path = tmp_path_factory.mktemp("tasks") / "kept.nq"
    with SavedVerdicts(str(path)) as saved:
        for each in judged.values():
            keep(saved, each)
    with closing(opened(path)) as archive:
        yield serve(kitchens=("a",), robots=("pr2",), archive=archive)


def address(result: TaskResult) -> str:
    return result.iri.removeprefix("https://example.org")


def test_results_are_listed_and_lead_to_their_pages(served, judged) -> None:
    listed = served.get("/tasks.json").json()["results"]
    assert {each["link"]: each["outcome"] for each in listed} == {
        address(judged["kept"]): "certified",
        address(judged["broken"]): "not_certified",
    }
    assert {(each["task"], each["steps"], each["rules"]) for each in listed} == {("fetch <it>", 2, 1)}
    page = served.get("/tasks", headers=PAGE).text
    assert "fetch &lt;it&gt;" in page
    assert all(f'href="{each["link"]}"' in page for each in listed)
    assert 'href="/tasks"' in served.get("/verdicts", headers=PAGE).text
    assert len(list(csv.reader(io.StringIO(served.get("/tasks.csv").text)))) == 3


def test_a_broken_rule_is_told_with_step_and_time(served, judged) -> None:
    broken = judged["broken"]
    data = served.get(f"{address(broken)}.json").json()
    (rule,) = data["rules"]
    assert (rule["what"], rule["outcome"], rule["step"]) == ("side_door never beyond 1", "broken", 2)
    assert rule["time"] == broken.broken.time
    words = text_of(served.get(address(broken), headers=PAGE).text)
    assert "Can pr2 do 'fetch <it>' in kitchen a?" in words
    assert "Not certified" in words
    assert "side_door never beyond 1" in words


def test_a_result_is_rechecked_with_the_verdicts_of_its_steps(served, judged) -> None:
    link = address(judged["kept"])
    assert served.get(f"{link}.json").json()["recheck"] is None
    action = f"/tasks/{link.rsplit('/', 1)[1]}/recheck"
    assert f'action="{action}"' in served.get(link, headers=PAGE).text
    posted = served.post(action, content="", headers=FORM)
    assert posted.headers["location"] == f"{link}#recheck"
    found = served.get(f"{link}.json").json()["recheck"]
    assert (found["kind"], found["holds"]) == ("task result", False)
    assert "its verdict is certified, and has no certificate" in found["reasons"][0]
    assert "It does not hold" in text_of(served.get(link, headers=PAGE).text)
    assert served.post("/tasks/0/recheck", content="", headers=FORM).status_code == 400


def test_every_step_leads_to_its_verdict(served, judged) -> None:
    kept = judged["kept"]
    data = served.get(f"{address(kept)}.json").json()
    assert [(each["what"], each["outcome"]) for each in data["steps"]] == [
        ("open low_drawer to 0.2", "certified"),
        ("open side_door", "certified"),
    ]
    page = served.get(address(kept), headers=PAGE).text
    for step, each in zip(kept.steps, data["steps"], strict=True):
        assert each["link"] == step.verdict.iri.removeprefix("https://example.org")
        assert f'href="{each["link"]}"' in page
        assert served.get(each["link"], headers=PAGE).status_code == 200
    rows = list(csv.reader(io.StringIO(served.get(f"{address(kept)}.csv").text)))
    assert [row[0] for row in rows] == ["part", "step", "step", "rule"]
    graph = f"/id/graph/task_result/{address(kept).rsplit('/', 1)[1]}"
    assert f'href="{graph}.ttl"' in page
    assert "law:TaskResult" in served.get(f"{graph}.ttl").text
