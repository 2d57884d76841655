"""Grids, and the smallest change that nobody named, over HTTP: as `sdt whatif` answers, and what is kept."""

from typing import Any

import pytest

from tests.small import FOLDER

pytestmark = pytest.mark.oracle

DRAWER = "low_drawer"
OPEN = ("--state", f"{DRAWER}=open")
MODELS = ("--kitchen", str(FOLDER / "a.urdf"), "--robot")
PR2, STRETCH = (str(FOLDER / f"{name}.urdf") for name in ("pr2", "stretch"))
BUDGET = 0.3  # [s] for searches, all of which are spent: the small robots bring their fingers to no handle
DONE_ALREADY = {"task": f"open:{DRAWER}", "state": [f"{DRAWER}=open"], "budget": 2}
SECONDS = ("seconds", "cpu_seconds")


@pytest.fixture(scope="module")
def served(serve):
    return serve(kitchens=("a",), robots=("pr2", "stretch"))


def told(found: dict[str, Any]) -> dict[str, Any]:
    """The answer without the time that it took."""
    return {name: value for name, value in found.items() if name not in SECONDS}


def turned(served, sdt, within: int) -> tuple[dict[str, Any], dict[str, Any]]:
    """The smallest change of each kind over HTTP and on the shell, as far as it is found in time [s]."""
    asked = DONE_ALREADY | {"robot": "pr2", "turn": True, "within": within}
    there = served.post("/api/v1/whatif", json=asked)
    case = (*MODELS, PR2, "--task", f"open:{DRAWER}", *OPEN, "--budget", "2")
    here = sdt("whatif", *case, "--turn", "--within", str(within), "--json").json
    assert there.status_code == 200, there.text
    assert {"which robot", "where its handle is", "which two together"} <= {
        each["family"] for each in here["families"]
    }
    return told(there.json()), told(here)


def test_the_smallest_change_of_each_kind_is_answered_as_on_the_shell(served, sdt) -> None:
    there, here = turned(served, sdt, 6)
    assert (here["kitchen"], here["robot"]) == ("a", "pr2")
    assert here["families"][2]["family"] == "which other door or drawer is moved"
    for each in (there, here):  # how finely sizes are looked at, and which pairs, is as the time allows
        each["families"] = each["families"][:3]
    assert there == here
    kept = [each["iri"] for each in served.get("/api/v1/verdicts").json()]
    assert kept == [here["actual"]["iri"]]


def test_a_grid_is_answered_as_on_the_shell_and_only_the_worlds_as_they_are_are_kept(served, sdt) -> None:
    edits = [f"drive:fixed | jam:{DRAWER}", "clear:swing_door"]
    asked = {"task": f"close:{DRAWER},swing_door", "edits": edits, "grid": True, "budget": BUDGET}
    there = served.post("/api/v1/whatif", json=asked)
    case = (*MODELS, f"{PR2},{STRETCH}", "--task", asked["task"], "--budget", str(BUDGET), "--grid", "--json")
    here = sdt("whatif", *case, *(word for each in edits for word in ("--edit", each))).json
    assert there.status_code == 200, there.text
    assert told(there.json()) == told(here)
    assert len(here["cells"]) == 2 * 2 * (1 + 2) * (1 + 1)
    assert {each["robot"] for each in here["cells"]} == {"pr2", "stretch"}
    kept = {each["iri"] for each in served.get("/api/v1/verdicts").json()}
    as_it_is = {each["iri"] for each in here["cells"] if each["edits"] == "as it is"}
    assert as_it_is <= kept
    assert kept.isdisjoint({each["iri"] for each in here["cells"]} - as_it_is)
    again = served.post("/api/v1/whatif", json=asked | {"robot": "pr2"}).json()
    assert {each["robot"] for each in again["cells"]} == {"pr2"}
    assert {each["how"] for each in again["cells"] if each["edits"] == "as it is"} == {"kept from before"}


def test_a_grid_and_a_turn_are_about_the_present_state(served) -> None:
    moved = served.post("/api/v1/state", json={"state": [f"{DRAWER}=open"]})
    assert moved.status_code == 200, moved.text
    asked = {"task": f"open:{DRAWER}", "robot": "pr2"}
    cells = served.post("/api/v1/whatif", json=asked | {"grid": True, "edits": ["drive:fixed"]}).json()[
        "cells"
    ]
    assert ["nothing to cause" in each["why"] for each in cells] == [True, True]
    found = served.post("/api/v1/whatif", json=asked | {"turn": True, "within": 1}).json()
    assert "nothing to cause" in found["actual"]["diagnoses"][0]["reason"]
    more = asked | {"state": [f"{DRAWER}=closed"], "grid": True, "edits": [f"jam:{DRAWER}"], "budget": BUDGET}
    cells = served.post("/api/v1/whatif", json=more).json()["cells"]
    assert not any("nothing to cause" in each["why"] for each in cells)
    served.post("/api/v1/state", json={"state": [f"{DRAWER}=closed"]})


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"edits": [], "turn": False}, "no other world is asked about"),
        ({"grid": True, "turn": False}, "no other world is asked about"),
        ({"grid": True, "edits": ["drive:fixed"]}, "a grid and a turn are two questions"),
        ({"edits": ["base:1,0,0"], "within": 5}, "'within' says nothing where edits are named"),
        ({"task": "open"}, "'open' is several questions"),
        ({"robot": None}, "no robot is named"),
        ({"robot": "nobody"}, "no loaded robot 'nobody'"),
    ],
)
def test_what_is_no_question_is_refused_and_nothing_is_judged(
    served, wrong: dict[str, Any], said: str
) -> None:
    before = served.world.version
    answer = served.post("/api/v1/whatif", json=DONE_ALREADY | {"robot": "pr2", "turn": True} | wrong)
    assert answer.status_code == 400, answer.text
    assert said in answer.json()["detail"]
    assert served.world.version == before


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"task": "pour"}, "no task type 'pour'"),
        ({"task": "open:"}, "'open:' names no container"),
        ({"task": "open:low_drawer,nobody"}, "no container named 'nobody'"),
        ({"edits": ["drive:fixed |"]}, "'' is no edit"),
        ({"edits": ["drive:fixed | drive:fixed"]}, "has an edit twice"),
        ({"edits": ["drive:fixed | mesh:m=/etc/m.stl@1,0,0"]}, "names a file"),
        ({"edits": [f"robot:{PR2}"]}, "no robot named"),
        ({"edits": ["kitchen:../a.urdf"]}, "no kitchen named"),
        ({"edits": ["without:crate"]}, "no obstacle named 'crate'"),
        ({"edits": ["drive:omni | drive:fixed"] * 20}, "3486784401 cases in a grid"),
        ({"robot": "nobody"}, "no loaded robot 'nobody'"),
    ],
)
def test_a_grid_that_is_wrong_is_refused_before_anything_is_judged(
    served, wrong: dict[str, Any], said: str
) -> None:
    before = served.world.version
    asked = {"task": f"open:{DRAWER}", "grid": True, "edits": ["drive:fixed"], "robot": "pr2"} | wrong
    answer = served.post("/api/v1/whatif", json=asked | {"seed": 7})
    assert answer.status_code == 400, answer.text
    assert said in answer.json()["detail"]
    assert served.world.version == before


def test_times_that_are_none_are_no_bodies_of_the_schema(served) -> None:
    for wrong in ({"within": 0.5}, {"within": 601}, {"within": "long"}, {"grid": "yes"}):
        asked = DONE_ALREADY | {"robot": "pr2", "turn": True} | wrong
        assert served.post("/api/v1/whatif", json=asked).status_code == 422
