"""`sdt whatif --grid` and `sdt codesign`, as people type them."""

import csv

import pytest

DRAWER = "sink_area_left_middle_drawer_main"


@pytest.mark.oracle
def test_a_grid_tells_every_case_what_turned_and_what_was_reused(sdt, tmp_path) -> None:
    file = tmp_path / "cases.csv"
    edits = f"box:crate=0.4,0.4,1@0.6,0.5,0.5 | drive:omni | jam:{DRAWER} | broken:nose"
    asked = ("--kitchen", "b", "--robot", "pr2", "--task", f"open:{DRAWER}", "--budget", "5")
    done = sdt("whatif", "--grid", *asked, "--edit", edits, "--csv", str(file), "--json")
    assert done.code == 0, done.err
    rows = {each["edits"]: each for each in done.json["cells"]}
    assert [each["outcome"] for each in rows.values()] == [
        "certified",
        "not_certified",
        "certified",
        "abstained",
        "no such world",
    ]
    assert rows["drive:omni"]["iri"] == rows["as it is"]["iri"]
    assert rows[f"jam:{DRAWER}"]["canPerform"] is None
    assert "no gripper 'nose'" in rows["broken:nose"]["why"]
    assert {each["world"] for each in done.json["turned"]} == {
        "box:crate=0.4,0.4,1@0.6,0.5,0.5",
        f"jam:{DRAWER}",
    }
    assert [each["outcome"] for each in csv.DictReader(file.read_text().splitlines())] == [
        each["outcome"] for each in rows.values()
    ]


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
        ("whatif", "--grid", "--turn", "--kitchen", "b", "--robot", "pr2", "--task", "open"),
        ("whatif", "--turn", "--kitchen", "b", "--robot", "pr2", "--task", "open"),
        ("codesign", "--edit", "dance:x"),
        ("codesign", "--kitchen", "nowhere"),
    ],
)
def test_nonsense_is_named(sdt, arguments: tuple[str, ...]) -> None:
    done = sdt(*arguments)
    assert done.code == 2
    assert done.err.startswith("error: ")
    assert "Traceback" not in done.err
