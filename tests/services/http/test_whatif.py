"""Other worlds and base poses over HTTP: the answers of `sdt whatif` and `sdt place`, and what is kept."""

import re

import pytest

from tests.small import FOLDER

pytestmark = pytest.mark.oracle

DRAWER = "low_drawer"
BUDGET = 0.3  # [s] for searches, all of which are spent: the small robot brings its fingers to no handle
CASE = ("--kitchen", str(FOLDER / "a.urdf"), "--robot", str(FOLDER / "pr2.urdf"), "--task", f"open:{DRAWER}")
JAM = {"task": f"open:{DRAWER}", "edits": [f"jam:{DRAWER}"], "budget": BUDGET}


@pytest.fixture(scope="module")
def served(serve):
    return serve(kitchens=("a",), robots=("pr2",))


def told(found: dict[str, object]) -> dict[str, object]:
    """The answer without what a search measures of itself, its time."""
    worlds = {
        world: {name: found[world][name] for name in ("iri", "outcome", "causes", "can_perform")}
        for world in ("actual", "counterfactual")
    }
    reasons = {
        name: [re.sub(r"after [\d.]+ s", "after SECONDS", each["reason"]) for each in found[name]]
        for name in ("no_longer", "now")
    }
    return found | worlds | reasons


def test_another_world_is_answered_as_on_the_shell_and_only_the_world_as_it_is_is_kept(served, sdt) -> None:
    there = served.post("/api/v1/whatif", json=JAM)
    here = sdt("whatif", *CASE, "--edit", f"jam:{DRAWER}", "--budget", str(BUDGET), "--json").json
    assert there.status_code == 200, there.text
    assert told(there.json()) == told(here)
    assert here["edits"] == [f"jam:{DRAWER}"]
    assert here["counterfactual"]["outcome"] == "abstained", "a joint that is stuck is outside of D_artic"
    kept = [each["iri"] for each in served.get("/api/v1/verdicts").json()]
    assert kept == [here["actual"]["iri"]]
    assert served.post("/api/v1/whatif", json=JAM).json()["actual"]["stored"] is True


def test_a_present_state_is_that_of_the_world_as_it_is(served) -> None:
    moved = JAM | {"state": [f"{DRAWER}=open"]}
    found = served.post("/api/v1/whatif", json=moved).json()
    assert "nothing to cause" in found["actual"]["diagnoses"][0]["reason"]


def test_the_smallest_share_that_turns_is_answered_as_on_the_shell(served, sdt) -> None:
    body = {"task": f"close:{DRAWER}", "state": [f"{DRAWER}=0.3"], "edits": [f"move:{DRAWER}=0.1"]}
    asked = JAM | body | {"turn": True}
    found = served.post("/api/v1/whatif", json=asked).json()
    case = (*CASE[:-1], f"close:{DRAWER}", "--state", f"{DRAWER}=0.3", "--edit", f"move:{DRAWER}=0.1")
    here = sdt("whatif", *case, "--turn", "--budget", str(BUDGET), "--json").json
    assert found["tried"] == here["tried"]
    assert (found["found"], found["searched"]) == (here["found"], here["searched"])
    whole = served.post("/api/v1/whatif", json=JAM | {"turn": True})
    assert (whole.status_code, "no edit can be made in part" in whole.json()["detail"]) == (400, True)


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        ("mesh:m=/etc/m.stl@1,0,0", "names a file"),
        (f"robot:{FOLDER / 'stretch.urdf'}", "no robot named"),
        ("kitchen:../a.urdf", "no kitchen named"),
        ("paint:it", "'paint:it' is no edit"),
        ("jam:nobody", "nobody"),
    ],
)
def test_an_edit_that_is_none_or_names_a_file_is_refused_and_nothing_is_judged(
    served, edit: str, said: str
) -> None:
    before = served.world.version
    answer = served.post("/api/v1/whatif", json=JAM | {"edits": [edit], "seed": 7})
    assert answer.status_code == 400, answer.text
    assert said in answer.json()["detail"]
    assert served.world.version == before


def test_several_questions_are_refused_before_one_is_judged(served) -> None:
    answer = served.post("/api/v1/whatif", json=JAM | {"task": "open"})
    assert (answer.status_code, answer.json()["detail"]) == (400, "'open' is 5 questions")


def test_base_poses_are_answered_as_on_the_shell_and_nothing_is_kept(served, sdt) -> None:
    before = served.world.version
    body = {"task": f"open:{DRAWER}", "state": [f"{DRAWER}=open"], "budget": 1}
    there = served.post("/api/v1/place", json=body)
    here = sdt("place", *CASE, "--state", f"{DRAWER}=open", "--budget", "1", "--json").json
    assert there.status_code == 200, there.text
    said = {"container", "robot", "task", "spots", "diagnoses"} & here.keys()
    assert {"spots", "diagnoses"} <= said
    assert {name: there.json()[name] for name in said} == {name: here[name] for name in said}
    assert served.world.version == before
    for wrong in ({"drive": "fixed"}, {"tee": "d_artic_dyn"}):
        assert served.post("/api/v1/place", json=body | wrong).status_code == 422
