"""Every notebook, from top to bottom, on one drawer; their full size is in tests/soak."""

import re
from pathlib import Path

import pytest

from sdt_kg.errors import InputError
from services.reports.studies.learning import lesson
from tests.services.reports.cells import run
from tests.services.reports.conftest import DRAWER, Written

ONE = {"drive": "omni", "budget": 30.0}


def words(html: str) -> str:
    return re.sub(r"<[^>]+>", " ", html.replace("<wbr>", ""))


def test_diagnosis_of_a_motion_that_an_obstacle_stops_shows_who_meets_whom_and_when(written: Written) -> None:
    edits = "box:crate=0.2,0.2,0.3@0.45,0.1,0.15"
    headline, view, evidence, *_ = run(
        "diagnosis",
        kitchen="b",
        robot="stretch",
        task=f"open:{DRAWER}",
        edits=edits,
        store=str(written.store),
        **ONE,
    )
    assert "certified before the edits" in headline
    assert "measured" in headline
    assert "crate" in evidence
    assert '"ghost":true' in view
    assert '"red":["https://example.org/id/b/body/crate"' in view
    assert "nearest points" in view


def test_counterfactual_shows_what_turned_and_why_and_keeps_only_the_kitchen_as_it_is(tmp_path: Path) -> None:
    store = tmp_path / "store.nq"
    parameters = {
        "kitchen": "b",
        "robots": "stretch,pr2",
        "task": f"open:{DRAWER}",
        "turn": "",
        "store": str(store),
    }
    outcomes, turned, *_ = run("counterfactual", edits=f"jam:{DRAWER}; broken:left", **parameters, **ONE)
    assert "→ abstained" in outcomes
    assert "no such world" in outcomes
    assert "yes, otherwise not asked" in turned
    assert store.read_text().count("law#Verdict>") == 2


def test_codesign_counts_every_world_and_keeps_the_verdict_about_the_kitchen_as_it_is(tmp_path: Path) -> None:
    store = tmp_path / "store.nq"
    parameters = {"kitchen": "b", "robots": "stretch", "task": f"open:{DRAWER}", "jobs": 1}
    parameters |= {"store": str(store)}
    counts, *_, verdicts = run("codesign", edits=f"jam:{DRAWER}", **parameters, **ONE)
    assert re.search(r"as it is\s+0\s+1 / 1\s", words(counts))
    assert re.search(rf"jam:{DRAWER}\s+1\s+0 / 1 \(-1\)", words(counts))
    named = re.findall(r"https://example\.org/id/verdict/[0-9a-f]{64}", words(verdicts))
    assert len(set(named)) == 2
    (kept,) = (row for row in store.read_text().splitlines() if "law#Verdict>" in row)
    assert any(each in kept for each in named)
    *_, verdicts = run("codesign", edits=f"jam:{DRAWER}", **parameters, **ONE)
    assert "kept from before" in words(verdicts)


def test_learning_finds_the_hinge_that_was_moved_and_proposes_it() -> None:
    candidates, _, kitchen, view, proposed = run("learning", shift=0.06, noise=0.001)
    assert words(candidates).split().index("revolute") < words(candidates).split().index("prismatic")
    assert re.search(
        r"the proposed twin\s+iai_fridge_door\s+[\d.]+\s+yes\s+yes\s+open:iai_fridge_door", words(kitchen)
    )
    assert '"label":"learned"' in view
    assert re.search(r"0\.2[89]\d, 0\.3[56]\d, 0\.245", words(proposed))


def test_learning_proposes_nothing_where_the_twin_has_the_path_already() -> None:
    assert lesson("b", container="iai_fridge_door", shift=0.0, noise=0.001).proposal is None


@pytest.mark.parametrize(
    ("name", "parameters", "message"),
    [
        ("feasibility", {"drive": "wings"}, "no drive 'wings'"),
        ("counterfactual", {"edits": ""}, "no edit is given"),
        ("counterfactual", {"edits": "paint:door"}, "is no edit"),
        ("learning", {"container": ""}, "neither a track nor a container"),
    ],
)
def test_nonsense_is_refused_in_words(name: str, parameters: dict, message: str) -> None:
    with pytest.raises(InputError, match=message):
        run(name, **parameters)
