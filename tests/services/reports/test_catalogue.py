"""Notebooks keep what STYLE.md asks of them, and take no parameter that they do not have."""

import ast

import pytest

from sdt_kg.errors import InputError, UnknownEntityError
from services.reports.run.catalogue import PARAMETERS, Notebook, notebook, notebooks

ALL = {each.name: each for each in notebooks()}


def test_the_five_reports_of_the_issue_are_there() -> None:
    assert list(ALL) == ["codesign", "counterfactual", "diagnosis", "feasibility", "learning"]


@pytest.mark.parametrize("one", ALL.values(), ids=ALL)
def test_a_notebook_asks_one_question_in_at_most_20_short_cells_and_defines_nothing(one: Notebook) -> None:
    assert one.question.endswith("?")
    assert len(one.node.cells) <= 20
    for cell in one.node.cells:
        if cell.cell_type != "code" or PARAMETERS in cell.metadata.get("tags", []):
            continue
        lines = [line for line in cell.source.splitlines() if line.strip()]
        assert len(lines) <= 10, cell.source
        kinds = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Lambda)
        assert not [each for each in ast.walk(ast.parse(cell.source)) if isinstance(each, kinds)]


@pytest.mark.parametrize("one", ALL.values(), ids=ALL)
def test_every_parameter_has_a_meaning_and_a_simple_default(one: Notebook) -> None:
    for each in one.parameters:
        assert each.meaning, each.name
        assert isinstance(each.default, str | int | float | bool)


@pytest.mark.parametrize(
    "one", [each for each in ALL.values() if each.name != "learning"], ids=lambda one: one.name
)
def test_without_a_drive_each_robot_moves_as_its_hardware_does(one: Notebook) -> None:
    assert {each.name: each.default for each in one.parameters}["drive"] == ""


@pytest.mark.parametrize("given", ["kitchen=zz", "robots=pr2,zz"])
def test_a_kitchen_or_robot_that_is_not_there_is_told_before_anything_runs(given: str) -> None:
    with pytest.raises(UnknownEntityError, match="named 'zz'"):
        notebook("feasibility").values([given])


def test_values_have_the_type_of_the_default() -> None:
    values = notebook("counterfactual").values(["together=True", "steps=3", "budget=2", "edits=a=b;c"])
    assert values == {"together": True, "steps": 3, "budget": 2.0, "edits": "a=b;c"}


def test_unknown_names_are_told_with_the_nearest_ones() -> None:
    with pytest.raises(UnknownEntityError, match="did you mean 'feasibility'"):
        notebook("feasability")
    with pytest.raises(UnknownEntityError, match="did you mean 'robots'"):
        notebook("feasibility").values(["robot=pr2"])


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (["kitchen"], "NAME=VALUE"),
        (["kitchen=a", "kitchen=b"], "given twice"),
        (["budget=soon"], "a number"),
        (["jobs=1.5"], "a whole number"),
    ],
)
def test_a_value_that_is_none_says_what_is_allowed(given: list[str], words: str) -> None:
    with pytest.raises(InputError, match=words):
        notebook("feasibility").values(given)


def test_a_truth_is_true_or_false() -> None:
    with pytest.raises(InputError, match="true or false"):
        notebook("counterfactual").values(["together=maybe"])
