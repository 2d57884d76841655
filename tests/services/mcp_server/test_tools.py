"""The nine tools, asked by an agent."""

import json
import shlex
from concurrent.futures import Future
from typing import Any

import numpy as np
import pytest
from mcp.types import CallToolResult, TextContent

from predicates.questions import questions
from predicates.record.inputs import inputs_of, verdict_iri
from services.app import Policy, load
from services.mcp_server import judging
from services.mcp_server.report import LIMIT
from services.motions.files import motion_of
from services.whatif.answers import MOST_SHARES

from .conftest import Agent

DRAWER = "fridge_area_lower_drawer_main"
MOTION: dict[str, Any] = {
    "joint": f"{DRAWER}_joint",
    "times": [0.0, 8.0],
    "values": [0.0, 0.456],
    "timed": False,
}
TOO_QUICK = {"joint": "iai_fridge_door_joint", "times": [0.0, 1.0], "values": [0.0, 1.5]}


def data(answer: CallToolResult) -> dict[str, Any]:
    assert not answer.is_error, answer.content
    assert isinstance(answer.structured_content, dict)
    return answer.structured_content


def text(answer: CallToolResult) -> str:
    (content,) = answer.content
    assert isinstance(content, TextContent)
    return content.text


def test_all_tools_only_read_and_refuse_arguments_that_they_do_not_know(agent: Agent) -> None:
    tools = {each.name: each for each in agent.tools()}
    assert set(tools) == {
        "lookup", "schema", "examples", "select", "list_scopes", "verify_motion", "diagnose", "what_if",
        "place",
    }  # fmt: skip
    for each in tools.values():
        assert each.annotations is not None
        assert each.annotations.read_only_hint is True
        assert each.annotations.destructive_hint is False
        assert each.input_schema["additionalProperties"] is False


def test_every_example_works_on_what_is_loaded(agent: Agent) -> None:
    iri, asked = "", set[str]()
    for each in data(agent("examples"))["examples"]:
        given = {**each["arguments"], "verdict": iri} if each["tool"] == "diagnose" else each["arguments"]
        answer = data(agent(each["tool"], **given))
        asked.add(each["tool"])
        if each["tool"] == "verify_motion":
            (verdict,) = answer["verdicts"]
            assert (verdict["outcome"], verdict["can_perform"], verdict["stored"]) == (
                "certified",
                True,
                False,
            )
            iri = verdict["iri"]
        if each["tool"] == "what_if":
            assert (answer["turned"], answer["counterfactual"]["outcome"]) == (True, "not_certified")
            assert answer["differences"][0]["proof"] is True
    assert asked == {each.name for each in agent.tools()} - {"examples"}

    (again,) = data(agent("verify_motion", task=f"open:{DRAWER}", robot="pr2", motion=MOTION))["verdicts"]
    assert (again["iri"], again["stored"]) == (iri, True)
    rows = data(agent("select", query="SELECT ?v WHERE { ?v a law:Verdict ; law:outcome law:Certified }"))
    assert [f"<{iri}>"] in rows["rows"]
    assert "notes" not in rows
    (note,) = data(agent("select", query="SELECT ?d { ?d sdt:hasHandel ?h }"))["notes"]
    assert "did you mean sdt:hasHandle?" in note
    (note,) = data(agent("select", query="SELECT ?v { ?v law:robot id:tiago, id:pr2 }"))["notes"]
    assert "nothing here is called id:tiago" in note
    (note,) = data(agent("select", query="SELECT ?j { ?j a sdt:Joint }"))["notes"]
    assert "nothing here is said to be a sdt:Joint" in note
    assert text(agent("diagnose", verdict=iri[-64:-50])).startswith(
        f"Can pr2 open {DRAWER} in kitchen b? CERTIFIED"
    )


def test_a_pose_of_the_base_is_certified_where_it_is_given_as_the_base(agent: Agent) -> None:
    asked = {"task": f"open:{DRAWER}", "robot": "pr2"}
    answer = agent("place", **asked, budget=1.0)
    best = data(answer)["spots"][0]
    assert text(answer).startswith(f"certified  --base {best['base']} --drive fixed")
    base = [best[name] for name in ("x", "y", "yaw")]
    given = {**asked, "motion": MOTION, "base": base, "drive": "fixed"}
    (verdict,) = data(agent("verify_motion", **given))["verdicts"]
    assert (verdict["outcome"], verdict["drive"]) == ("certified", "fixed")


def test_a_place_is_asked_of_one_container(agent: Agent) -> None:
    answer = agent("place", task="open", robot="pr2")
    assert answer.is_error
    assert "'open' names no container" in text(answer)


def test_a_verdict_has_the_iri_that_it_has_in_process(agent: Agent) -> None:
    service = load("b", ["pr2", "stretch"], policy=Policy())
    robot = service.robot("pr2")
    motion = motion_of({name: np.asarray(value) for name, value in MOTION.items()}, service.twin, robot)
    (question,) = questions(
        service.case(f"open:{DRAWER}", robot, motion), service.physics, service.embodiment
    )
    expected = verdict_iri(inputs_of(question.asked, service.physics, service.embodiment))
    (verdict,) = data(agent("verify_motion", task=f"open:{DRAWER}", robot="pr2", motion=MOTION))["verdicts"]
    assert verdict["iri"] == expected


def test_a_verdict_about_another_world_is_told_with_its_edits_and_asked_again_with_them(
    agent: Agent, sdt
) -> None:
    edits = [f"handle:{DRAWER}=0,0,0.3", "drive:fixed"]
    asked = {"task": f"open:{DRAWER}", "robot": "pr2", "friction": 0.8, "budget": 5.0}
    found = data(agent("what_if", **asked, edits=edits))
    other = found["counterfactual"]["iri"]
    assert f"edited: {'; '.join(edits)}" in text(agent("diagnose", verdict=other))
    lines = text(agent("diagnose", verdict=other, section="To check again")).splitlines()
    again = next(line.strip() for line in lines if "sdt whatif" in line)
    assert "--edit drive" not in again, "its verdict says which drive it was"
    done = sdt(*shlex.split(again)[1:], "--json")
    assert done.json["counterfactual"]["iri"] == other
    assert "edited: " not in text(agent("diagnose", verdict=found["actual"]["iri"]))
    plain = data(agent("what_if", **asked, edits=["drive:fixed"]))["counterfactual"]["iri"]
    assert "edited: drive:fixed" in text(agent("diagnose", verdict=plain))
    told = text(agent("diagnose", verdict=plain, section="To check again"))
    assert ("sdt achieve" in told, "--drive fixed --friction 0.8" in told) == (True, True)


def test_the_smallest_share_that_turns_is_that_of_the_command(agent: Agent, sdt) -> None:
    edit, task = f"move:{DRAWER}=0.45", f"open:{DRAWER}"
    asked = ("--kitchen", "b", "--robot", "pr2", "--task", task, "--edit", edit, "--turn", "--json")
    here = sdt("whatif", *asked).json
    answer = agent("what_if", task=task, robot="pr2", edits=[edit], turn=True)
    there = data(answer)
    assert len(here["tried"]) <= MOST_SHARES == 13
    for name in ("found", "share", "edits", "not_yet", "tolerance", "predicates"):
        assert there[name] == here[name], name
    assert there["counterfactual"]["iri"] == here["counterfactual"]["iri"]
    assert f"turns at: {here['edits'][0]}" in text(answer)
    assert f"edited: {here['edits'][0]}" in text(agent("diagnose", verdict=here["counterfactual"]["iri"]))
    none = agent("what_if", task=task, robot="pr2", edits=[f"move:{DRAWER}=0.01"], turn=True)
    assert (data(none)["found"], "searched, not proved" in text(none)) == (False, True)
    whole = agent("what_if", task=task, robot="pr2", edits=["drive:fixed"], turn=True)
    assert (whole.is_error, "no edit can be made in part" in text(whole)) == (True, True)


BACKWARDS = {**MOTION, "times": [8.0, 0.0]}
RAGGED = {**MOTION, "values": [[0.0], [1.0, 2.0]]}
CASE: dict[str, Any] = {"task": f"open:{DRAWER}", "robot": "pr2", "motion": MOTION}
ASKED: dict[str, Any] = {"task": CASE["task"], "robot": "pr2"}


@pytest.mark.parametrize(
    ("tool", "given", "kind", "said"),
    [
        ("verify_motion", {**CASE, "states": ["all=open"]}, "invalid-request", "'states': Extra inputs"),
        ("verify_motion", {**CASE, "budget": 1e6}, "invalid-request", "less than or equal to 120"),
        ("verify_motion", {**CASE, "task": "open:fridge_area_lower_drawer"}, "invalid-request", DRAWER),
        ("verify_motion", {**CASE, "robot": "pr3"}, "invalid-request", "did you mean 'pr2'?"),
        ("verify_motion", {**CASE, "robot": None}, "invalid-request", "pr2, stretch"),
        ("verify_motion", {**CASE, "drive": "wings"}, "invalid-request", "omni, differential, fixed"),
        ("verify_motion", {**CASE, "motion": BACKWARDS}, "invalid-request", "increas"),
        ("verify_motion", {**CASE, "motion": RAGGED}, "invalid-request", "sample 1"),
        ("verify_motion", {**CASE, "motion": {**MOTION, "tims": []}}, "invalid-request", "'tims'"),
        ("verify_motion", {**CASE, "motion": {**MOTION, "poses": []}}, "invalid-request", "'poses'"),
        ("verify_motion", {**CASE, "seed": -1}, "invalid-request", "greater than or equal to 0"),
        ("what_if", {**ASKED, "edits": ["paint:it"]}, "invalid-request", "jam:"),
        ("what_if", {**ASKED, "edits": ["robot:/etc/robot.urdf"]}, "invalid-request", "no robot named"),
        ("what_if", {**ASKED, "edits": ["kitchen:../kitchen.urdf"]}, "invalid-request", "no kitchen named"),
        ("what_if", {**ASKED, "edits": ["mesh:m=/etc/m.stl@1,0,0"]}, "invalid-request", "names a file"),
        ("diagnose", {"verdict": "no-such"}, "invalid-request", "verify_motion makes one"),
        ("select", {"query": "INSERT DATA { <a:a> <a:b> <a:c> }"}, "invalid-request", "SPARQL that reads"),
        ("select", {"query": "SELECT * { SERVICE <http://a/> { ?s ?p ?o } }"}, "forbidden", "leave it out"),
        ("select", {"query": "SELECT * { ?s ?p ?o }"}, "too-large", "10000 rows"),
        ("select", {"query": "DESCRIBE id:pr2"}, "invalid-request", "SELECT, ASK"),
        ("delete_all", {}, "invalid-request", "lookup, schema"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_a_typed_error(
    agent: Agent, tool: str, given: dict[str, Any], kind: str, said: str
) -> None:
    answer = agent(tool, **given)
    assert answer.is_error
    assert isinstance(answer.structured_content, dict)
    error = answer.structured_content["error"]
    assert (error["type"], error["retryable"]) == (kind, False)
    assert said in f"{error['what']}; {error['allowed']}; {error['remedy']}"
    assert error["what"] in text(answer)


@pytest.mark.parametrize(
    ("tool", "given", "key"),
    [
        ("lookup", {"name": "a"}, "entities"),
        ("select", {"query": "SELECT * { ?s sdt:upperLimit ?u ; ?p ?o }", "rows": 200}, "rows"),
        ("schema", {}, "terms"),
    ],
)
def test_a_long_report_is_cut_and_says_so(agent: Agent, tool: str, given: dict[str, Any], key: str) -> None:
    answer = agent(tool, **given)
    found = data(answer)
    assert len(json.dumps(found, ensure_ascii=False)) <= LIMIT
    assert len(text(answer)) <= LIMIT
    assert found[key]
    assert found["left_out"] > 0
    if tool != "schema":  # which has room in words
        assert "lines left out; ask" in text(answer)


def test_rows_that_were_not_asked_for_are_left_out_too(agent: Agent) -> None:
    for query, rows in (("SELECT ?j { ?j sdt:upperLimit ?u }", 2), ("SELECT * { ?s ?p ?o } LIMIT 90", 60)):
        found = data(agent("select", query=query, rows=rows))
        assert len(found["rows"]) + found["left_out"] == found["count"] > rows


def test_a_shortened_verdict_still_tells_the_worst_of_each_quantity() -> None:
    def reason(quantity: str, value: float) -> dict[str, Any]:
        evidence = {"quantity": quantity, "value": value, "bound": 1.0, "unit": "rad/s", "time": 0.0}
        return {
            "kind": "embodiment",
            "reason": "r" * 150,
            "evidence": evidence,
            "proof": False,
            "search": None,
        }

    many = [reason("velocity", 2.0 + k) for k in range(30)] + [reason("tool_error", 1.5)]
    verdict = dict.fromkeys(judging.TOLD) | {"iri": "v", "diagnoses": many}
    found = judging.fitted([verdict])
    assert len(json.dumps(found)) <= LIMIT
    (short,) = found["verdicts"]
    assert [each["evidence"]["value"] for each in short["diagnoses"][:3]] == [31.0, 1.5, 30.0]
    assert short["diagnoses_left_out"] == 31 - len(short["diagnoses"]) > 0


def test_others_are_answered_while_a_motion_is_judged(agent: Agent) -> None:
    judged: Future[CallToolResult] = agent.ask(
        "verify_motion", task="open:iai_fridge_door", robot="pr2", motion=TOO_QUICK, budget=3.0
    )
    assert data(agent("lookup", name="iai_fridge_door"))["entities"][0]["name"] == "iai_fridge_door"
    assert data(agent("select", query="ASK { ?door a sdt:Door }")) == {"answer": True}
    assert not judged.done()
    (verdict,) = data(judged.result(120))["verdicts"]
    assert (verdict["outcome"], verdict["causes"]) == ("not_certified", False)
    causal = [each for each in verdict["diagnoses"] if each["kind"] == "causal"]
    assert {each["evidence"]["quantity"] for each in causal} == {"velocity", "acceleration"}


def test_fingers_rub_as_much_as_is_said(agent: Agent) -> None:
    (verdict,) = data(agent("verify_motion", **CASE, friction=0.3))["verdicts"]
    told = text(agent("diagnose", verdict=verdict["iri"], section="Notes"))
    assert "holds that need friction of more than 0.3 are refused: as asked" in told
    assert agent("verify_motion", **CASE, friction=0.0).is_error


def test_a_motion_is_verified_relative_to_forces_and_with_a_tolerance(agent: Agent) -> None:
    asked = {"task": f"open:{DRAWER}", "robot": "pr2", "motion": MOTION}
    (usual,) = data(agent("verify_motion", **asked))["verdicts"]
    (forced,) = data(agent("verify_motion", **asked, tee="d_artic_dyn"))["verdicts"]
    assert forced["iri"] != usual["iri"]
    assert "D_artic_dyn" in text(agent("diagnose", verdict=forced["iri"]))
    (weak,) = data(agent("verify_motion", **asked, tee="d_artic_dyn", handle_force=1.0))["verdicts"]
    assert (weak["outcome"], weak["causes"]) == ("not_certified", False)
    (near,) = data(agent("verify_motion", **asked, contact=0.001))["verdicts"]
    assert near["iri"] not in {usual["iri"], forced["iri"]}
    told = data(agent("what_if", task=asked["task"], robot="pr2", edits=["drive:fixed"], tee="d_artic_dyn"))
    assert "D_artic_dyn" in text(agent("diagnose", verdict=told["counterfactual"]["iri"]))
    wrong = agent("verify_motion", **asked, handle_force=5.0)
    assert (wrong.is_error, "with tee d_artic_dyn only" in text(wrong)) == (True, True)


def test_what_is_late_is_stopped_and_the_next_question_is_answered(
    agent: Agent, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as hurry:
        hurry.setattr(judging, "FIRST", -0.999)
        late = agent("verify_motion", task="close:iai_fridge_door", robot="pr2", motion=TOO_QUICK, budget=1.0)
    assert late.is_error
    assert isinstance(late.structured_content, dict)
    error = late.structured_content["error"]
    assert (error["type"], error["retryable"]) == ("deadline", True)
    assert "nothing is claimed" in error["what"]
    answer = agent("verify_motion", **CASE)
    assert data(answer)["verdicts"][0]["outcome"] == "certified"
    assert "Relative to D_artic: rigid bodies, no forces, no friction, no error of perception" in text(answer)
