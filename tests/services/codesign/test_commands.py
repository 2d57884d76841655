"""`sdt whatif --grid` and `sdt codesign`, as people type them."""

import csv
from pathlib import Path

import pytest

SMALL = Path(__file__).resolve().parents[2] / "small" / "b.urdf"
DRAWER = "sink_area_left_middle_drawer_main"


@pytest.mark.oracle
def test_a_grid_tells_every_case_what_turned_and_what_was_reused(sdt, tmp_path) -> None:
    file = tmp_path / "cases.csv"
    edits = f"box:crate=0.4,0.4,1@0.6,0.5,0.5 | drive:omni | jam:{DRAWER}"
    asked = ("--kitchen", "b", "--robot", "pr2", "--task", f"open:{DRAWER}", "--budget", "30")
    done = sdt("whatif", "--grid", *asked, "--edit", edits, "--csv", str(file), "--json")
    assert done.code == 0, done.err
    rows = {each["edits"]: each for each in done.json["cells"]}
    assert [each["outcome"] for each in rows.values()] == [
        "certified",
        "not_certified",
        "certified",
        "abstained",
    ]
    assert rows["drive:omni"]["iri"] == rows["as it is"]["iri"]
    assert rows[f"jam:{DRAWER}"]["canPerform"] is None
    assert {each["world"] for each in done.json["turned"]} == {
        "box:crate=0.4,0.4,1@0.6,0.5,0.5",
        f"jam:{DRAWER}",
    }
    assert [each["outcome"] for each in csv.DictReader(file.read_text().splitlines())] == [
        each["outcome"] for each in rows.values()
    ]


@pytest.mark.oracle
def test_a_world_that_cannot_be_made_is_told_beside_those_that_can(sdt) -> None:
    edits = ("--edit", "box:crate=0.4,0.4,0.9@3,3,0.45", "--edit", "without:crate")
    asked = ("--kitchen", "b", "--robot", "pr2", "--task", f"open:{DRAWER}", "--budget", "30")
    done = sdt("whatif", "--grid", *asked, *edits, "--json")
    assert done.code == 0, done.err
    rows = {each["edits"]: each for each in done.json["cells"]}
    outcomes = [each["outcome"] for each in rows.values()]
    assert outcomes == ["certified", "no such world", "certified", "certified"]
    assert "'crate'" in rows["without:crate"]["why"]


@pytest.mark.parametrize("edit", ["broken:nose", "move:iai_fridge_dor=1.5", "drive:omni | without:crate"])
def test_an_edit_that_can_be_made_nowhere_is_refused_before_anything_is_judged(sdt, edit: str) -> None:
    done = sdt(
        "whatif", "--grid", "--kitchen", "a,b", "--robot", "pr2,stretch", "--task", "open", "--edit", edit
    )
    assert done.code == 2
    assert edit.rpartition(":")[2].partition("=")[0] in done.err


@pytest.mark.parametrize(
    "arguments",
    [
        (
            "whatif",
            "--grid",
            "--kitchen",
            "b",
            "--robot",
            "pr2",
            "--task",
            "open:nothing",
            "--edit",
            "drive:omni",
        ),
        (
            "whatif",
            "--grid",
            "--kitchen",
            "b",
            "--robot",
            "pr2,pr2",
            "--task",
            "open",
            "--edit",
            "drive:omni",
        ),
        ("whatif", "--grid", "--kitchen", "b", "--robot", "pr2", "--task", "pour", "--edit", "drive:omni"),
        ("whatif", "--grid", "--kitchen", "b", "--robot", "pr2", "--task", "open", "--edit", "drive:omni |"),
        ("whatif", "--grid", "--kitchen", "b", "--robot", "pr2", "--task", "open:", "--edit", "drive:omni"),
        ("whatif", "--grid", "--turn", "--kitchen", "b", "--robot", "pr2", "--task", "open"),
        ("whatif", "--turn", "--kitchen", "b", "--robot", "pr2", "--task", "open"),
        ("codesign", "--edit", "dance:x"),
        ("codesign", "--kitchens", "nowhere"),
        ("codesign", "--forces", __file__),
    ],
)
def test_nonsense_is_named(sdt, arguments: tuple[str, ...]) -> None:
    done = sdt(*arguments)
    assert done.code == 2
    assert done.err.startswith("error: ")
    assert "Traceback" not in done.err


def test_a_plan_takes_no_edit_that_can_be_made_nowhere(sdt) -> None:
    done = sdt("codesign", "--robots", "pr2", "--edit", "move:iai_fridge_door=1", "--edit", "clear:nix")
    assert (done.code, done.out) == (2, "")
    assert done.err.startswith("error: no body named 'nix'"), "the other can be made, in kitchen b only"


@pytest.mark.oracle
def test_where_nothing_is_missing_a_plan_says_that_there_is_nothing_to_gain(sdt) -> None:
    asked = ("codesign", "--kitchens", str(SMALL), "--robots", "pr2", "--drive", "omni", "--within", "1")
    assert "nothing to gain" in sdt(*asked).out


@pytest.mark.parametrize("command", ["codesign", "whatif"])
def test_a_time_that_is_no_number_is_outside_the_range(sdt, command: str) -> None:
    done = sdt(command, "--within", "nan")
    assert done.code == 2
    assert "nan is not in the range" in done.err


@pytest.mark.oracle
def test_a_grid_relative_to_d_artic_dyn_asks_what_the_robot_bears_of_old_motions_too(sdt) -> None:
    edits = "box:crate=0.4,0.4,0.9@3,3,0.45"
    asked = ("--kitchen", "b", "--robot", "pr2", "--task", f"open:{DRAWER}", "--budget", "30")
    asked = (*asked, "--edit", edits)
    done, kinematic = (
        sdt("whatif", "--grid", *asked, "--tee", tee, "--json") for tee in ("d_artic_dyn", "d_artic")
    )
    assert done.code == 0, done.err
    assert [each["how"] for each in done.json["cells"]] == [
        "asked anew",
        "motion of the world as it is, certified again",
    ]
    assert not {each["iri"] for each in done.json["cells"]} & {
        each["iri"] for each in kinematic.json["cells"]
    }
