"""Questions over HTTP and the bus say which class they are about, and how much force is allowed."""

import json

import pytest

from services.app import load
from services.compute.run import Loaded
from services.judging.codec import JSON
from services.judging.judge import Judge
from services.judging.loaded import models_of
from services.judging.problems import Problem, ProblemType
from services.judging.workers.jobs import Done, Task

pytestmark = pytest.mark.oracle

DRAWER = "open:sink_area_left_middle_drawer_main"


@pytest.fixture(scope="module")
def judge() -> Judge:
    kitchen = load("b")
    return Judge({"b": kitchen}, Loaded(("b",), ()), models_of([kitchen.twin]))


def caused(judge: Judge, **request: object) -> Done | Problem:
    payload = json.dumps({"task": DRAWER, **request}).encode()
    return judge(Task("b", "causes", payload, JSON, 60.0), lambda iri: None)


def diagnoses(done: Done | Problem) -> list[dict[str, object]]:
    assert isinstance(done, Done)
    (found,) = json.loads(done.payload)["diagnoses"]
    return found


def test_a_handle_force_that_is_too_small_turns_the_answer(judge: Judge) -> None:
    assert diagnoses(caused(judge, tee="d_artic_dyn")) == []
    assert diagnoses(caused(judge)) == []
    (refused,) = diagnoses(caused(judge, tee="d_artic_dyn", handle_force=2.0))
    assert refused["kind"] == "causal"
    assert "where 2 N is allowed" in str(refused["reason"])


@pytest.mark.parametrize(
    "wrong",
    [{"handle_force": 20.0}, {"tee": "d_artic_dyn", "handle_force": -1.0}, {"tee": "d_rigid"}],
)
def test_a_force_without_its_class_and_a_class_that_is_none_are_refused(
    judge: Judge, wrong: dict[str, object]
) -> None:
    found = caused(judge, **wrong)
    assert isinstance(found, Problem)
    assert found.type.endswith(ProblemType.INVALID_REQUEST.value)
