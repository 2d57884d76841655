"""Other worlds in a process that judges: what it is about, what is kept, and who may answer."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from sdt_kg.errors import InputError
from services.app import Service, load
from services.codesign.asked import MOST_CASES, check_size
from services.compute.run import Loaded
from services.judging.codec import JSON
from services.judging.judge import Judge
from services.judging.loaded import models_of
from services.judging.problems import Problem, ProblemType
from services.judging.workers.jobs import Done, Task
from tests.small import FOLDER
from tests.small.lift import Lifts

KITCHEN, ROBOT = (str(FOLDER / name) for name in ("a.urdf", "pr2.urdf"))
DRAWER = "low_drawer"
TURN = {"task": f"open:{DRAWER}", "state": [f"{DRAWER}=open"], "turn": True, "within": 1.0}
GRID = {"task": f"open:{DRAWER}", "state": [f"{DRAWER}=open"], "grid": True, "edits": [f"jam:{DRAWER}"]}


def judge_of(service: Service, kitchen: str, robots: tuple[str, ...], name: str) -> Judge:
    return Judge({name: service}, Loaded((kitchen,), robots), models_of([service.twin]))


def asked(judging: Judge, name: str, kept: dict[str, bytes], **request: Any) -> Done | Problem:
    return judging(Task(name, "whatif", json.dumps(request).encode(), JSON, 100.0), kept.get)


def answer(done: Done | Problem) -> dict[str, Any]:
    assert isinstance(done, Done), done
    return json.loads(done.payload)


@pytest.mark.oracle
@pytest.mark.parametrize("request_", [TURN, GRID], ids=["turn", "grid"])
def test_the_verdict_as_it_is_is_kept_once_and_given_as_quads(request_: dict[str, Any]) -> None:
    judging = judge_of(load(KITCHEN, [ROBOT]), KITCHEN, (ROBOT,), "a")
    done = asked(judging, "a", {}, **request_, quads=True)
    assert isinstance(done, Done)
    ((iri, quads),) = done.records
    assert answer(done)["quads"] == quads.decode()
    assert [(each.outcome, each.stored) for each in done.judged] == [("not_certified", False)]
    again = asked(judging, "a", {iri: quads}, **request_, quads=True)
    assert isinstance(again, Done)
    assert again.records == ()
    assert iri in answer(again)["quads"]


@pytest.mark.oracle
def test_a_robot_that_came_with_a_saved_kitchen_is_asked_about_in_other_worlds(tmp_path: Path) -> None:
    saved = tmp_path / "saved.nq"
    saved.write_bytes(load(KITCHEN, [ROBOT]).twin.serialize("nquads"))
    judging = judge_of(load(saved), str(saved), (), "saved.nq")
    named = {"task": f"open:{DRAWER}", "state": [f"{DRAWER}=open"], "edits": ["drive:fixed"]}
    for request in (named, TURN, GRID):
        found = answer(asked(judging, "saved.nq", {}, **request))["answer"]
        assert "nothing to cause" in json.dumps(found)


@pytest.mark.parametrize("request_", [TURN, GRID], ids=["turn", "grid"])
def test_where_oracles_elsewhere_answer_a_search_of_worlds_is_refused(request_: dict[str, Any]) -> None:
    service = replace(load(KITCHEN, [ROBOT]), oracles=Lifts())
    refused = asked(judge_of(service, KITCHEN, (ROBOT,), "a"), "a", {}, **request_)
    assert isinstance(refused, Problem)
    assert refused.kind is ProblemType.INVALID_REQUEST
    assert "oracles elsewhere answer here" in refused.detail
    assert "name an edit, without a grid" in refused.detail


@pytest.mark.oracle
def test_worlds_of_files_that_have_changed_since_are_not_judged(tmp_path: Path) -> None:
    kitchen = tmp_path / "a.urdf"
    kitchen.write_text(Path(KITCHEN).read_text())
    judging = judge_of(load(kitchen, [ROBOT]), str(kitchen), (ROBOT,), "a")
    kitchen.write_text(kitchen.read_text().replace('upper="0.5"', 'upper="0.6"'))
    for request in (TURN, GRID):
        refused = asked(judging, "a", {}, **request)  # it reads again
        assert isinstance(refused, Problem)
        assert refused.kind is ProblemType.UNAVAILABLE
        assert "the files of a have changed" in refused.detail


def test_a_grid_has_as_many_cases_as_one_answer_may_have() -> None:
    axes = ["drive:omni | drive:fixed | drive:differential", "jam:x"]  # 4 times 2 worlds
    check_size(axes, MOST_CASES // 8)
    with pytest.raises(InputError, match="1008 cases in a grid"):
        check_size(axes, MOST_CASES // 8 + 1)
