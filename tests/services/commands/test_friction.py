"""`--friction` of every command that searches: its verdicts are those of `sdt achieve` with the same."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from services.commands.exits import Exit
from services.sweep.plan import Axes
from services.sweep.sources import Listed, csv_rows
from tests.soak.doors import draw, write

pytestmark = pytest.mark.oracle

DRAWER = "sink_area_left_middle_drawer_main"
ROBOT = ("--kitchen", "b", "--robot", "pr2")
TASK = (*ROBOT, "--task", f"open:{DRAWER}")
MU = ("--friction", "0.3")
RUBS = 22  # a front that Stretch opens with friction of 0.54
ASKED = "holds that need friction of more than 0.3 are refused: as asked"


@pytest.fixture
def said(sdt) -> Callable[..., Any]:
    """What a command says as JSON."""
    return lambda *arguments: json.loads(sdt(*arguments, "--json").out)


def test_verdicts_of_other_commands_are_those_of_achieve(said: Callable[..., Any]) -> None:
    (verdict,) = said("achieve", *TASK, *MU)
    assert ASKED in verdict["notes"]
    (usual,) = said("achieve", *TASK)
    assert usual["iri"] != verdict["iri"]
    table = said("table", "--kitchens", "b", "--robots", "pr2", "--jobs", "1", *MU)["verdicts"]
    assert verdict["iri"] in {each["iri"] for each in table}
    other = said("whatif", *TASK, *MU, "--edit", "drive:omni")
    assert other["actual"]["iri"] == verdict["iri"]
    steps = said("task", "open_then_close", *ROBOT, *MU)["steps"]
    assert steps[0]["verdict"]["iri"] == verdict["iri"]


def test_a_query_has_cases_judged_with_that_friction(sdt, said: Callable[..., Any]) -> None:
    (verdict,) = said("achieve", *TASK, *MU)
    container = f"<https://example.org/id/b/body/{DRAWER}>"
    asked = f"SELECT ?v {{ ?v law:container {container} ; law:task/law:verb law:Open }}"
    how = ("--robot", "pr2", "--jobs", "1", *MU)
    found = said("query", "b", asked, "--compute", *how)
    assert [each["iri"] for each in found["computed"]["ran"]] == [verdict["iri"]]
    assert [each["v"] for each in found["rows"]] == [verdict["iri"]]
    alone = sdt("query", "b", asked, *MU)
    assert (alone.code, "--friction without --compute" in alone.err) == (Exit.BAD_INPUT, True)


def test_a_pose_that_place_gives_is_certified_with_that_friction(said: Callable[..., Any]) -> None:
    asked = ("--kitchen", "a", "--robot", "tiago_dual", "--task", "open:cabinet5_drawer_top")
    needed = []
    for more in ((), MU):
        best = said("place", *asked, *more, "--budget", "0.5")["spots"][0]["base"]
        (verdict,) = said("achieve", *asked, *more, "--drive", "fixed", "--base", best)
        assert verdict["outcome"] == "certified"
        needed.append(verdict["figures"]["friction needed"][0])
    assert needed[1] <= 0.3 < needed[0]


def test_codesign_counts_what_is_certified_with_that_friction(
    said: Callable[..., Any], tmp_path: Path
) -> None:
    kitchen = write(draw(np.random.default_rng(RUBS)), tmp_path, "front")
    asked = ("--kitchens", str(kitchen), "--robots", "stretch", "--no-plan", "--jobs", "1", "--budget", "0.4")
    slippery = ("--friction", "0.01")
    certified = [said("codesign", *asked, *more)["covers"][0]["certified"] for more in ((), slippery)]
    assert certified == [1, 0]


def test_frictions_of_a_sweep_are_cases_and_a_row_has_its_own(
    said: Callable[..., Any], tmp_path: Path
) -> None:
    asked = ("--kitchens", "b", "--robots", "pr2", "--task", f"open:{DRAWER}", "--plan")
    assert said("sweep", *asked, *MU, "--friction", "0.5")["cases"] == 2
    file = tmp_path / "cases.csv"
    file.write_text(f"container,friction\n{DRAWER},0.3\n{DRAWER},\n")
    cells = Listed(("b",), ("pr2",), Axes()).plan(csv_rows(file)).cells
    assert [each.policy.friction for each in cells] == [0.3, None]
