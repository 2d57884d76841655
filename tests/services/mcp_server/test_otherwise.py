"""What agents are told of grids, and of the smallest change that nobody named."""

import json
from typing import Any

import pytest

from services.mcp_server.report import LIMIT

from .conftest import Agent
from .test_tools import DRAWER, data, text

pytestmark = pytest.mark.oracle

CASE: dict[str, Any] = {"task": f"open:{DRAWER}", "robot": "pr2"}


def test_a_grid_is_that_of_the_command_for_every_robot_that_is_loaded(agent: Agent, sdt) -> None:
    edits = [f"jam:{DRAWER} | drive:fixed"]
    asked = ("--kitchen", "b", "--robot", "pr2,stretch", "--task", CASE["task"], "--edit", *edits)
    here = sdt("whatif", "--grid", *asked, "--json").json
    answer = agent("what_if", task=CASE["task"], edits=edits, grid=True)
    there = data(answer)
    assert there["worlds"] == here["worlds"]
    assert (there["cases"], there["worlds_left_out"], there["left_out"]) == (6, 0, 0)
    assert [each["outcome"] for each in there["turned"]] == [each["outcome"] for each in here["turned"]]
    assert f"jam:{DRAWER}: b pr2 0 / 1 (-1); b stretch 0 / 1 (-1)" in text(answer)
    alone = data(agent("what_if", **CASE, edits=edits, grid=True))
    assert [set(each) for each in alone["worlds"]] == [{"world", "b pr2"}] * 3


def test_a_large_grid_is_told_in_short(agent: Agent) -> None:
    crates = [f"box:crate{letter * 450}=0.1,0.1,0.1@9,9,1" for letter in "abc"]
    answer = agent("what_if", **CASE, state=["all=open"], edits=crates, grid=True)
    there = data(answer)
    assert there["cases"] == 8
    assert there["worlds_left_out"] == 8 - len(there["worlds"]) > 0
    assert "of 10 lines left out" in text(answer)
    assert len(json.dumps(there, ensure_ascii=False)) <= LIMIT
    assert len(text(answer)) <= LIMIT


def test_the_smallest_change_of_each_kind_is_looked_for(agent: Agent, sdt) -> None:
    how = {"state": [f"{DRAWER}=open"], "turn": True, "within": 2.0}
    answer = agent("what_if", **CASE, **how)
    there = data(answer)
    asked = ("--kitchen", "b", "--robot", "pr2", "--task", CASE["task"], "--state", f"{DRAWER}=open")
    here = sdt("whatif", *asked, "--turn", "--within", "2", "--json").json
    assert there["actual"] == {name: here["actual"][name] for name in ("outcome", "iri")}
    assert [each["family"] for each in there["families"]][:5] == [
        each["family"] for each in here["families"]
    ][:5]
    assert "nothing to cause" in text(answer)
    assert "which robot? none found (" in text(answer)
    assert "Reasons" in text(agent("diagnose", verdict=there["actual"]["iri"]))


def test_a_change_that_turns_is_told_first_and_asked_again_by_its_name(agent: Agent) -> None:
    blocked = {**CASE, "drive": "fixed"}
    answer = agent("what_if", **blocked, turn=True, within=8.0)
    first = data(answer)["families"][0]
    assert (first["found"], first["outcome"]) == (True, "certified")
    assert f"{first['family']}? {first['edit']}: certified (certified" in text(answer)
    again = data(agent("what_if", **blocked, edits=[first["edit"]]))
    assert (again["turned"], again["counterfactual"]["outcome"]) == (True, "certified")


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({}, "no other world is asked about"),
        ({"grid": True}, "no other world is asked about"),
        ({"grid": True, "turn": True, "edits": ["drive:fixed"]}, "two questions"),
        ({"edits": ["drive:fixed"], "within": 5.0}, "'within' says nothing"),
        ({"turn": True, "within": 121.0}, "less than or equal to 120"),
        ({"turn": True, "task": "open"}, "several questions"),
        ({"turn": True, "robot": None}, "no robot is named"),
        ({"grid": True, "edits": ["drive:omni | robot:/etc/robot.urdf"]}, "no robot named"),
        ({"grid": True, "edits": ["mesh:m=/etc/m.stl@1,0,0"]}, "names a file"),
        ({"grid": True, "task": "open", "edits": ["drive:omni | drive:fixed"] * 9}, "cases in a grid"),
    ],
)
def test_what_is_no_question_is_a_typed_error(agent: Agent, wrong: dict[str, Any], said: str) -> None:
    answer = agent("what_if", **{**CASE, **wrong})
    assert answer.is_error
    assert isinstance(answer.structured_content, dict)
    error = answer.structured_content["error"]
    assert (error["type"], error["retryable"]) == ("invalid-request", False)
    assert said in f"{error['what']}; {error['allowed']}; {error['remedy']}"
