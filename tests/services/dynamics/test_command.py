"""`--tee d_artic_dyn` as a user types it."""

import json
import shlex
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from services.cli import sdt
from tests.services.dynamics.forced import DATA
from tests.small import FOLDER

KITCHEN, PUSHING = str(FOLDER / "b.urdf"), ("--tee", "d_artic_dyn", "--forces", str(DATA))


def run(*arguments: str) -> Result:
    return CliRunner().invoke(sdt, arguments)


def stiff(folder: Path) -> str:
    text = DATA.read_text(encoding="utf-8")
    for end in ("From", "To"):
        text = text.replace(f"sdt:latchForce{end} 0.0", f"sdt:latchForce{end} 180.0")
    (folder / "stiff.ttl").write_text(text, encoding="utf-8")
    return str(folder / "stiff.ttl")


def test_causes_tells_the_force_and_its_bound() -> None:
    result = run("causes", KITCHEN, "--task", "open:top_drawer", *PUSHING, "--json")
    (row,) = json.loads(result.output)
    assert (result.exit_code, row["outcome"], row["tee_class"]) == (0, "causes", "d_artic_dyn")
    assert row["figures"]["handle force, allowed"] == [60.0, "N"]
    assert "60 N allowed" in run("causes", KITCHEN, "--task", "open:top_drawer", *PUSHING).output


def test_too_much_force_is_told_with_quantity_unit_and_time(tmp_path: Path) -> None:
    asked = (
        "causes",
        KITCHEN,
        "--task",
        "open:top_drawer",
        "--tee",
        "d_artic_dyn",
        "--forces",
        stiff(tmp_path),
    )
    result = run(*asked, "--json")
    (row,) = json.loads(result.output)
    assert (result.exit_code, row["outcome"]) == (1, "does_not_cause")
    evidence = row["diagnoses"][0]["evidence"]
    assert (evidence["quantity"], evidence["unit"], evidence["bound"], evidence["time"]) == (
        "force",
        "N",
        60,
        0,
    )
    assert "needs 184.0 N where 60 N is allowed" in run(*asked).output.replace("\n", " ")


@pytest.mark.parametrize("form", [(), ("--json",), ("--format", "turtle")])
def test_scope_without_force_data_abstains_with_the_shacl_result(form: tuple[str, ...]) -> None:
    result = run("scope", KITCHEN, "--tee", "d_artic_dyn", *form)
    assert result.exit_code == 3
    assert "hasForceModel" in result.output
    assert run("scope", KITCHEN, *PUSHING, *form).exit_code == 0


def test_force_data_without_their_class_are_refused() -> None:
    result = run("causes", KITCHEN, "--task", "open", "--forces", str(DATA))
    assert "says nothing to d_artic" in str(result.exception)
    assert run("causes", KITCHEN, "--task", "open", "--tee", "d_artic_magic").exit_code == 2


def test_a_handle_force_that_is_given_is_the_bound() -> None:
    """Of each command that takes one; the verdict is about another twin than without."""
    asked = ("causes", KITCHEN, "--task", "open:top_drawer", *PUSHING, "--json")
    (usual,), (row,) = (json.loads(run(*asked, *more).output) for more in ((), ("--handle-force", "1")))
    assert (usual["outcome"], row["outcome"]) == ("causes", "does_not_cause")
    assert row["diagnoses"][0]["evidence"]["bound"] == 1
    assert run("scope", KITCHEN, *PUSHING, "--handle-force", "1").exit_code == 0


def test_a_handle_force_without_its_class_is_refused() -> None:
    result = run("causes", KITCHEN, "--task", "open", "--handle-force", "5")
    assert "handle_force 5.0 says nothing to d_artic" in str(result.exception)
    assert "not in the range" in run("causes", KITCHEN, "--task", "open", "--handle-force", "0").output


MODELS = ("--kitchens", KITCHEN, "--robots", str(FOLDER / "pr2.urdf"))
CASE = ("--kitchen", KITCHEN, "--robot", str(FOLDER / "pr2.urdf"), "--task", "open:top_drawer")
LITTLE = (*PUSHING, "--handle-force", "0.1", "--budget", "0.2")


def test_what_if_asks_in_both_worlds_with_the_handle_force() -> None:
    asked = ("whatif", *CASE, *LITTLE, "--edit", "move:top_drawer=0.01", "--json")
    said = json.loads(run(*asked).output)
    for world in ("actual", "counterfactual"):
        assert said[world]["diagnoses"][0]["evidence"]["bound"] == 0.1, world


@pytest.mark.parametrize("form", [("--grid", "--edit", "drive:fixed"), ("--turn", "--within", "1")])
def test_grids_and_smallest_changes_are_asked_with_the_handle_force(form: tuple[str, ...]) -> None:
    said = run("whatif", *CASE, *LITTLE, *form, "--json").output
    assert "needs 4.0 N where 0.1 N is allowed" in said


def test_codesign_counts_what_is_certified_with_the_handle_force() -> None:
    said = run("codesign", *MODELS, *LITTLE, "--no-plan", "--jobs", "1", "--json").output
    (cover,) = json.loads(said)["covers"]
    assert (cover["certified"], cover["of"]) == (0, 2)
    assert all("where 0.1 N is allowed" in each["why"] for each in cover["missing"])


def test_a_table_is_about_the_class_and_the_handle_force_that_are_named(tmp_path: Path) -> None:
    asked = ("table", *MODELS, *LITTLE, "--jobs", "1", "--save", str(tmp_path / "kept.trig"))
    made = json.loads(run(*asked, "--json").output)["verdicts"]
    assert {each["tee_class"] for each in made} == {"D_artic_dyn"}
    assert [each["diagnoses"][0]["evidence"]["bound"] for each in made] == [0.1, 0.1]
    assert "\nclass: D_artic_dyn\n" in run(*asked).output
    allowed = ("query", asked[-1], "SELECT ?n { ?kitchen sdt:allowedAtEveryHandle ?n }", "--json")
    assert json.loads(run(*allowed).output) == [{"n": 0.1}], "of the kitchen that is kept with the verdicts"


def test_a_stored_verdict_tells_the_handle_force_and_asks_with_it_again(tmp_path: Path) -> None:
    kept, achieve = str(tmp_path / "kept.trig"), ("achieve", *CASE)
    asked = ((*PUSHING, "--budget", "0.2"), LITTLE)
    iris = [json.loads(run(*achieve, *each, "--save", kept, "--json").output)[0]["iri"] for each in asked]
    usual, little = (run("why", iri, "--store", kept).output for iri in iris)
    assert "at every handle: 0.1 N allowed, whatever the force data say" in little
    assert "--handle-force" not in usual
    (line,) = [each for each in little.splitlines() if each.startswith("sdt achieve")]
    kitchen, robot, *rest = (" --kitchen b", " --robot pr2", " --tee d_artic_dyn --handle-force 0.1 ")
    assert all(each in line for each in (kitchen, robot, *rest))
    words = shlex.split(line.replace(kitchen, "").replace(robot, ""))[1:]
    again = run(*words, "--forces", str(DATA), *CASE[:4], "--json")
    assert json.loads(again.output)[0]["iri"] == iris[1]
