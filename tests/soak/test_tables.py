"""Whole tables beyond Table 1: reference models, `close`, other states, real drives. `make soak`."""

from dataclasses import replace
from pathlib import Path
from typing import cast

import pytest

from sdt_kg.annotation import Drive
from services.app import Policy
from services.embodiment.hold import pool, sampling, spread
from services.embodiment.search import attempt, plan
from services.sweep.cell import CellResult
from services.table import TableResult, cells, run
from tests.services.conftest import loggers, sdt  # noqa: F401 - fixtures
from tests.services.test_table import check_holds

PAPER = {"a": (22, 22, 19), "b": (16, 16, 15)}
ROBOTS = ("pr2", "tiago_dual", "stretch")
REFERENCE_KITCHENS = {
    "a": "kitchen_a_apartment/apartment_local.urdf",
    "b": "kitchen_b_iai_kitchen/kitchen.urdf",
}
REFERENCE_ROBOTS = (
    "robot_pr2/pr2_with_ft2_cableguide.urdf",
    "robot_tiago_dual/tiago_dual.urdf",
    "robot_stretch/stretch_description.urdf",
)

TEN = 10
SEARCHED = (
    (attempt, "ROUNDS"),
    (attempt, "BLOCKED"),
    (plan, "MORE_ROUNDS"),
    (sampling, "HOPELESS"),
    (sampling, "TRIES"),
    (spread, "PATHS"),
    (pool, "GRASPS"),
    (pool, "BLOCKS"),
    (pool, "EMPTY_BLOCKS"),
    (pool, "LITTERS"),
)
"""What ends a search: of these there are ten times as many."""

FULL = sampling.FULL
TENFOLD = replace(
    FULL,
    first=TEN * FULL.first,
    batches=TEN * FULL.batches,
    few=TEN * FULL.few,
    fronts=tuple(TEN * each for each in FULL.fronts),
)
"""The same of postures that search together."""

SATURATED = 120.0  # [s] budget with which the search ends by itself, on a busy machine too

pytestmark = [pytest.mark.oracle, pytest.mark.slow]


def table(
    kitchen: str, robots: tuple[str, ...], verb: str, states: tuple[str, ...], policy: Policy
) -> TableResult:
    return run(cells((kitchen,), robots, verb, states, policy), 2, lambda result: None)


def open_question(result: CellResult) -> bool:
    """Whether a case is refused by search alone: not by Causes, and without a proof."""
    diagnoses = cast(list[dict[str, object]], result.verdict["diagnoses"])
    kinds, proved = {each["kind"] for each in diagnoses}, any(each["proof"] for each in diagnoses)
    return result.verdict["outcome"] != "certified" and kinds == {"embodiment"} and not proved


def unexplained(result: TableResult) -> list[object]:
    """Containers of refusals that name no reason."""
    refused = (each.verdict for each in result.results if each.verdict["outcome"] != "certified")
    return [each["container"] for each in refused if not each["diagnoses"]]


@pytest.mark.reference
@pytest.mark.parametrize("kitchen", PAPER)
def test_reference_models_give_the_papers_table(reference: Path, kitchen: str) -> None:
    robots = tuple(str(reference / robot) for robot in REFERENCE_ROBOTS)
    result = table(str(reference / REFERENCE_KITCHENS[kitchen]), robots, "open", (), Policy(drive=Drive.OMNI))
    (row,) = result.cells().values()
    assert [one for one, least in zip(row.values(), PAPER[kitchen], strict=True) if one[0] < least] == []
    assert unexplained(result) == []


@pytest.mark.reference
def test_ten_times_the_search_opens_nothing_more(reference: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    robots = tuple(str(reference / robot) for robot in REFERENCE_ROBOTS)
    models = tuple(str(reference / kitchen) for kitchen in REFERENCE_KITCHENS.values())
    policy = Policy(drive=Drive.OMNI, budget=SATURATED)
    asked = [*cells(models, robots, "open", (), policy), *cells(("a", "b"), ROBOTS, "open", (), policy)]
    searched = [each.cell for each in run(asked, 1, lambda result: None).results if open_question(each)]
    if not searched:
        return  # every refusal is proved or measured, which says more
    for module, limit in SEARCHED:
        monkeypatch.setattr(module, limit, TEN * getattr(module, limit))
    for module in (plan, attempt):
        monkeypatch.setattr(module, "FULL", TENFOLD)
    again = [replace(each, policy=replace(policy, budget=TEN * SATURATED)) for each in searched]
    results = run(again, 1, lambda result: None).results
    found = [each.cell.task for each in results if each.verdict["outcome"] == "certified"]
    assert found == [], f"of {len(searched)} refused without a proof"


CLOSED = {"a": (24, 24, 24), "b": (17, 17, 17)}
"""How many each robot closes from where they alone are open."""


@pytest.mark.parametrize("kitchen", PAPER)
def test_what_is_open_alone_is_closed_by_each_robot(kitchen: str) -> None:
    result = table(kitchen, ROBOTS, "close", ("asked=open",), Policy(drive=Drive.OMNI))
    (row,) = result.cells().values()
    assert [one for one, least in zip(row.values(), CLOSED[kitchen], strict=True) if one[0] < least] == []
    assert unexplained(result) == []


def test_what_the_command_says_of_them_holds_when_it_is_checked_again(sdt, tmp_path: Path) -> None:  # noqa: F811 - a fixture
    store = str(tmp_path / "kept.nq")
    asked = "--kitchens", "b", "--robots", "stretch", "--drive", "omni", "--task", "close", "--save", store
    found = sdt("table", *asked, "--state", "asked=open", "--json").json
    assert found["cells"] == {"b": {"stretch": [17, 17]}}
    check_holds(sdt, store, 17)


@pytest.mark.parametrize("drive", [Drive.OMNI, None])
@pytest.mark.parametrize("state", ["all=open", "all=half-open:7"])
@pytest.mark.parametrize("kitchen", PAPER)
def test_every_refusal_to_close_is_explained(kitchen: str, state: str, drive: Drive | None) -> None:
    result = table(kitchen, ROBOTS, "close", (state,), Policy(drive=drive))
    assert len(result.results) == len(ROBOTS) * {"a": 27, "b": 17}[kitchen]
    assert unexplained(result) == []


@pytest.mark.parametrize("kitchen", PAPER)
def test_real_drives_open_what_omnidirectional_ones_do_and_explain_the_rest(kitchen: str) -> None:
    real, free = (table(kitchen, ROBOTS, "open", (), Policy(drive=drive)) for drive in (None, Drive.OMNI))
    assert opened(real) == opened(free) != set()
    assert unexplained(real) == unexplained(free) == []


def opened(result: TableResult) -> set[tuple[object, object]]:
    """Robots and the containers that they open."""
    sure = (each.verdict for each in result.results if each.verdict["outcome"] == "certified")
    return {(each["robot"], each["container"]) for each in sure}
