"""`sdt branch`, `sdt diff`, `sdt patch`: as people type them."""

import re
from pathlib import Path

import numpy as np
import pytest

from sdt_kg.history import Trajectory
from tests.small import FOLDER

KITCHEN = str(FOLDER / "b.urdf")


def test_edits_make_branches_whose_file_is_a_kitchen_again(sdt, tmp_path: Path) -> None:
    saved = str(tmp_path / "branch.nq")
    edits = (
        "move:top_drawer=open",
        "box:crate=0.3,0.3,0.3@1,0,0.15",
        "set:top_drawer_joint.velocityLimit=0.2",
    )
    rows = sdt("branch", KITCHEN, *edits, "-o", saved, "--json").json
    assert [row["edit"].split()[0] for row in rows] == ["the", "moved", "b:", "b:"]
    assert [event["type"] for event in rows[1]["events"]][:1] == ["Opened"]
    again = sdt("branch", saved, "without:crate", "--json").json
    assert again[0]["content_hash"] == rows[-1]["content_hash"]
    (row,) = sdt("query", saved, "-f", str(QUERIES / "when_opened.rq"), "--json").json
    assert row["container"].endswith("top_drawer")


QUERIES = Path(__file__).parents[3] / "ontology" / "queries"


def test_a_difference_goes_there_and_back(sdt, tmp_path: Path) -> None:
    other, patch, made = (str(tmp_path / name) for name in ("other.nq", "p.rdfp", "made.nq"))
    assert sdt("branch", KITCHEN, "move:top_drawer=open", "-o", other).code == 0
    assert sdt("diff", KITCHEN, f"{KITCHEN}@top_drawer=open").out.startswith(
        "top_drawer_joint moved from 0 to"
    )
    assert "top_drawer closed → open" in sdt("diff", KITCHEN, other, "--patch", patch).out
    assert sdt("patch", patch, KITCHEN, "-o", made).code == 0
    assert sdt("diff", other, made).out == "nothing differs\n"
    assert sdt("patch", patch, made, "--reverse", "-o", made).code == 0
    assert sdt("diff", KITCHEN, made, "--json").json == {"removed": 0, "added": 0, "sentences": []}
    refused = sdt("patch", patch, other, "-o", made)
    assert refused.code == 2
    assert "not made for these quads" in refused.err


def test_samples_of_a_followed_motion_are_kept_beside_the_graph(sdt, tmp_path: Path) -> None:
    motion, saved = tmp_path / "m.npz", tmp_path / "branch.trig"
    assert sdt("causes", KITCHEN, "--task", "open:top_drawer", "--motion-out", str(motion)).code == 0
    rows = sdt("branch", KITCHEN, f"follow:{motion}", "-o", str(saved), "--json").json
    assert [event["type"] for event in rows[1]["events"]][:2] == ["NoLongerClosed", "Opened"]
    (beside,) = tmp_path.glob("branch.*.npz")
    trajectory = Trajectory.from_bytes(beside.read_bytes())
    assert (np.diff(trajectory.times) > 0).all()
    assert trajectory.joints == ("https://example.org/id/b/joint/top_drawer_joint",)


@pytest.mark.parametrize("name", ["history.ttl", "history.csv", "file", "folder"])
def test_a_place_that_keeps_no_history_is_told_before_the_work(sdt, tmp_path: Path, name: str) -> None:
    (tmp_path / "file").write_text("a list")
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "list.txt").write_text("a list")
    done = sdt("branch", "gone", "move:door=open", "--history", str(tmp_path / name))
    assert (done.code, done.out) == (2, "")
    assert "cannot save verdicts to" in done.err or "holds something else than a store" in done.err


@pytest.mark.parametrize("name", ["history.trig", "history"])
def test_a_kept_history_goes_on_unkept_and_says_so(sdt, tmp_path: Path, name: str) -> None:
    place = str(tmp_path / name)
    assert "nothing is kept" not in sdt("branch", KITCHEN, "move:top_drawer=open", "--history", place).err
    done = sdt("branch", place, "move:top_drawer=closed")
    assert (done.code, done.err) == (0, f"note: nothing is kept; --history {place} keeps it there\n")
    assert len(sdt("branch", place, "--json").json) == 2
    assert sdt("branch", place).err == "", "nothing was made"
    assert sdt("branch", KITCHEN, "move:top_drawer=open").err == ""


@pytest.mark.parametrize("name", ["history.trig", "history"])
def test_a_kept_history_goes_on_after_a_restart(sdt, tmp_path: Path, name: str) -> None:
    motion, place = tmp_path / "m.npz", str(tmp_path / name)
    assert sdt("causes", KITCHEN, "--task", "open:top_drawer", "--motion-out", str(motion)).code == 0
    begun = sdt("branch", KITCHEN, f"follow:{motion}", "move:top_drawer=closed", "--history", place, "--json")
    again = sdt("branch", place, "box:crate=0.3,0.3,0.3@1,0,0.15", "--history", place, "--json")
    assert again.json[:-1] == begun.json
    other = sdt("branch", place, "move:top_drawer=0.1", "--from", begun.json[1]["branch"], "--json").json
    assert [row["iri"] for row in other[:-1]] == [row["iri"] for row in begun.json[:2]]
    last = sdt("branch", place, "--json").json
    assert last == again.json
    (row,) = sdt("query", place, "-f", str(QUERIES / "when_opened.rq"), "--json").json
    assert (row["branch"], row["time"]) == (last[1]["iri"], last[1]["events"][1]["time"])
    assert "crate" in sdt("diff", KITCHEN, f"{place}@top_drawer=0.2", "--json").out
    assert sdt("branch", place, "--from", "nothing").code == 2
    next(tmp_path.glob("history.*.npz")).unlink()
    assert "samples of the trajectory" in sdt("branch", place).err


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        ("nonsense", "is no edit"),
        ("move:drawer=1", "no joint or container named 'drawer'"),
        ("move:top_drawer=9", "outside its limits"),
        ("set:top_drawer_joint.uperLimit=1", "did you mean 'upperLimit'"),
        ("set:top_drawer_joint=1", "names no property"),
        ("set:top_drawer_joint.upperLimit=wide", "finite number"),
        ("box:crate=1,1", "allowed: 3 finite numbers"),
        ("box:crate=1,1,0", "not above 0"),
        ("box:crate=1,1,1", "allowed: 3 or 4 finite numbers"),
        ("box:top_drawer=1,1,1@0,0,0", "cannot name an obstacle"),
        ("pose:nowhere=1,2,3", "no joint named 'nowhere'"),
        ("without:crate", "no obstacle named 'crate'"),
        ("robot:nobody", "no robot named 'nobody'"),
        ("follow:nowhere.npz", "no file at nowhere.npz"),
    ],
)
def test_a_wrong_edit_is_refused_in_one_line(sdt, edit: str, message: str) -> None:
    done = sdt("branch", KITCHEN, edit)
    assert done.code == 2
    assert message in done.err
    assert done.err.count("\n") == 1


def test_a_difference_tells_of_the_world_and_counts_what_is_recorded_of_branches(sdt, tmp_path: Path) -> None:
    saved = str(tmp_path / "branch.nq")
    assert sdt("branch", KITCHEN, "move:top_drawer=open", "-o", saved).code == 0
    done = sdt("diff", KITCHEN, saved)
    (moved, recorded) = done.out.splitlines()
    assert moved.startswith("top_drawer_joint moved from 0 to ")
    assert re.fullmatch("and [0-9]+ triples differ in what is recorded of branches", recorded)


def test_a_saved_branch_is_a_kitchen_for_every_command(sdt, tmp_path: Path) -> None:
    saved = str(tmp_path / "branch.nq")
    robot = str(FOLDER / "pr2.urdf")
    assert sdt("branch", KITCHEN, "--robot", robot, "move:top_drawer=open", "-o", saved).code == 0
    assert {row["name"] for row in sdt("containers", saved, "--json").json} == {"oven_door", "top_drawer"}
    met = sdt("satisfies", saved, "--json").json
    assert {(row["task"], row["container"]) for row in met} >= {("open", "top_drawer")}
    assert sdt("scope", saved, "--robot", robot).code in (0, 3)
    broken = tmp_path / "broken.nq"
    text = Path(saved).read_text(encoding="utf-8")
    broken.write_text(text.replace("openFrom", "closedTo"), encoding="utf-8")
    done = sdt("satisfies", str(broken))
    assert (done.code, done.err.count("\n")) == (2, 1)


def test_a_history_is_not_begun_where_what_is_there_cannot_be_read(sdt, tmp_path: Path) -> None:
    place = tmp_path / "kept.trig"
    place.write_text("garbage <<", encoding="utf-8")
    done = sdt("branch", KITCHEN, "move:top_drawer=open", "--history", str(place))
    assert (done.code, done.out) == (2, "")
    assert "kept.trig is not valid RDF" in done.err
    assert place.read_text(encoding="utf-8") == "garbage <<"
