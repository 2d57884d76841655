"""Whatever an agent gives a tool: a short typed answer, never a traceback, and the next call is answered."""

import json
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcp.types import CallToolResult, TextContent

from services.mcp_server.report import LIMIT
from services.mcp_server.server import OFFERS

from .conftest import Agent

pytestmark = pytest.mark.oracle

DRAWER = "fridge_area_lower_drawer_main"
NAN, INF = float("nan"), float("inf")
KINDS = {"invalid-request", "forbidden", "too-large"}
"""What an agent's argument can be to blame for."""
MOTION: dict[str, Any] = {"joint": f"{DRAWER}_joint", "times": [0.0, 8.0], "values": [0.0, 0.456]}
CASE: dict[str, Any] = {"task": f"open:{DRAWER}", "robot": "pr2", "motion": MOTION, "budget": 1.0}
RIGHT: dict[str, dict[str, Any]] = {
    "lookup": {"name": "fridge"},
    "schema": {"term": "hasJoint"},
    "examples": {},
    "select": {"query": "ASK { ?d a sdt:Door }"},
    "list_scopes": {"robot": "pr2"},
    "verify_motion": CASE,
    "diagnose": {"verdict": "none"},
    "what_if": {"task": f"open:{DRAWER}", "robot": "pr2", "edits": ["drive:fixed"], "budget": 0.3},
    "place": {"task": f"open:{DRAWER}", "robot": "pr2", "budget": 0.1},
}
"""What each tool takes."""
STRINGS = [
    "",
    "\x00",
    "\x1b[31m",
    "../../etc/passwd",
    "' OR 1=1 --",
    "{{7*7}}",
    "ÿ\u202e\U0001f600",
    "\ud800",
]
ABSURD = [
    *(None, True, 0, -1, 2**80, -(2**80), 1e308, NAN, INF, [], {}, [[]], [[[None]]], {"": {"": []}}),
    *([NAN, 0.0, 0.0], [0.0, INF, 0.0], [1e308] * 3, ["all=open"] * 201, [""], *STRINGS),
]
HUGE = ["x" * 10**6, [0.0] * 10**6, ["all=open"] * 10**6, {str(each): each for each in range(10**4)}]
KEYS = st.text(st.characters(exclude_categories=["Cs"]), max_size=20)
TEXT = st.one_of(st.sampled_from(STRINGS), st.text(max_size=50))
LEAF = st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), TEXT)
VALUE = st.recursive(
    LEAF, lambda of: st.one_of(st.lists(of, max_size=4), st.dictionaries(KEYS, of, max_size=4)), max_leaves=12
)


def checked(answer: CallToolResult) -> bool:
    """Whether it is an answer; else it is a typed error. Either is short."""
    (content,) = answer.content
    assert isinstance(content, TextContent)
    assert "Traceback" not in content.text
    assert len(content.text) <= LIMIT
    assert isinstance(answer.structured_content, dict)
    assert len(json.dumps(answer.structured_content, ensure_ascii=False)) <= LIMIT
    if answer.is_error:
        error = answer.structured_content["error"]
        assert set(error) == {"type", "what", "allowed", "remedy", "retryable"}
        assert error["type"] in KINDS, content.text
    return not answer.is_error


@pytest.mark.parametrize("tool", OFFERS)
def test_an_argument_that_means_nothing_is_a_typed_error_or_an_answer(agent: Agent, tool: str) -> None:
    for name in OFFERS[tool].takes.model_fields:
        for absurd in ABSURD:
            checked(agent(tool, **{**RIGHT[tool], name: absurd}))
    assert checked(agent("select", **RIGHT["select"]))


@pytest.mark.parametrize(
    ("tool", "name"),
    [("lookup", "name"), ("select", "query"), ("verify_motion", "state"), ("what_if", "edits")],
)
def test_a_huge_argument_is_a_typed_error(agent: Agent, tool: str, name: str) -> None:
    assert not any(checked(agent(tool, **{**RIGHT[tool], name: huge})) for huge in HUGE)


@pytest.mark.parametrize("array", ["joint", "times", "values", "poses", "timed", "base"])
def test_a_motion_that_means_nothing_is_a_typed_error(agent: Agent, array: str) -> None:
    for absurd in ABSURD:
        checked(agent("verify_motion", **{**CASE, "motion": {**MOTION, array: absurd}}))
    assert not checked(agent("verify_motion", **{**CASE, "motion": {**MOTION, array: HUGE[1]}}))


@given(tool=st.sampled_from(list(OFFERS)), data=st.data())
@settings(
    max_examples=60,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
def test_arguments_of_any_shape_get_a_typed_error_or_an_answer(
    agent: Agent, tool: str, data: st.DataObject
) -> None:
    names = st.sampled_from([*OFFERS[tool].takes.model_fields, "colour"])
    changed = data.draw(st.dictionaries(names, VALUE, min_size=1, max_size=3))
    checked(agent(tool, **{**RIGHT[tool], **changed}))


@pytest.mark.parametrize("name", ["", "select ", "SELECT", "../select", "x" * 10**6, "\x00"])
def test_a_tool_that_is_not_there_is_a_typed_error(agent: Agent, name: str) -> None:
    assert not checked(agent(name))
