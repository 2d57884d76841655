"""`sdt achieve` and `sdt table`: outcomes, exit codes, files, JSON."""

import csv
from pathlib import Path

import numpy as np
import pytest

from sdt_kg.load import load_twin
from sdt_kg.motion import Motion
from services.commands.verdicts import hint_of_state
from services.motions import write_motion
from tests.services.store.test_folder import files_of_at_most
from tests.small import FOLDER

pytestmark = pytest.mark.oracle

DRAWER = "sink_area_left_middle_drawer_main"
KEYS = {
    "kitchen", "robot", "task", "container", "outcome", "satisfies_request", "causes", "can_perform",
    "gripper", "diagnoses", "seconds", "iri",
}  # fmt: skip


def achieve(sdt, *arguments: str, robot: str = "pr2", task: str = f"open:{DRAWER}"):
    return sdt("achieve", "--kitchen", "b", "--robot", robot, "--task", task, "--drive", "omni", *arguments)


def test_verdicts_that_cannot_be_kept_are_told_all_the_same(sdt, tmp_path: Path) -> None:
    store = str(tmp_path / "verdicts.trig")
    with files_of_at_most(100_000):
        one = achieve(sdt, "--save", store)
        words = ("--kitchens", str(FOLDER / "b.urdf"), "--robots", "pr2", "--budget", "1", "--save", store)
        table = sdt("table", *words)
    assert one.out.startswith(f"certified  open({DRAWER})")
    assert " / 2" in table.out
    for done in (one, table):
        assert done.code == 4
        assert "cannot be written: File too large; it is as it was before" in done.err
    assert "verdicts as triples" not in table.out


def test_a_drawer_is_certified_kept_and_verified(sdt, tmp_path: Path) -> None:
    motion, store = str(tmp_path / "drawer.npz"), str(tmp_path / "verdicts.trig")
    made = achieve(sdt, "--json", "--motion-out", motion, "--save", store)
    assert made.code == 0, made.err
    (verdict,) = made.json
    assert verdict.keys() >= KEYS
    assert (verdict["kitchen"], verdict["robot"], verdict["container"]) == ("b", "pr2", DRAWER)
    assert {verdict[name] for name in ("satisfies_request", "causes", "can_perform")} == {True}

    judged = achieve(sdt, "--json", "--motion", motion, "--save", store)
    assert judged.code == 0, judged.err
    assert judged.json[0]["iri"] != verdict["iri"], "a given motion is another input"

    asked = "SELECT ?v ?name WHERE { ?v law:outcome law:Certified ; law:container/rdfs:label ?name }"
    rows = sdt("query", store, "--json", asked).json
    assert {row["v"] for row in rows} == {verdict["iri"], judged.json[0]["iri"]}
    assert {row["name"] for row in rows} == {DRAWER}


def test_the_same_question_is_answered_from_the_store_with_its_motion(sdt, tmp_path: Path) -> None:
    store, motion = str(tmp_path / "verdicts.trig"), tmp_path / "drawer.npz"
    first, second = (
        achieve(sdt, "--json", "--save", store, "--motion-out", str(motion)).json[0] for _ in range(2)
    )
    assert first["iri"] == second["iri"]
    assert (first["stored"], second["stored"]) == (False, True)
    assert first["seconds"] == second["seconds"], "of the judging"
    assert achieve(sdt, "--motion", str(motion)).code == 0


def test_a_verdict_says_what_settings_may_have_changed(sdt) -> None:
    usual = achieve(sdt)
    other = achieve(sdt, "--state", "iai_fridge_door=0.5", "--contact-tolerance", "0.001")
    assert (usual.code, other.code) == (0, 0), other.err
    assert "iai_fridge_door_joint at 0.5\n" in other.out
    assert "note: a finger may be 1 mm from the handle that it holds, not 2 mm: as asked" in other.out
    assert "iai_fridge_door_joint at" not in usual.out
    assert "a finger may be" not in usual.out


def test_a_tolerance_with_which_nothing_holds_the_handle_is_refused_with_the_reason(sdt) -> None:
    done = achieve(sdt, "--contact-tolerance", "0.1")
    assert (done.code, done.out) == (2, "")
    assert "range 0<=x<=0.002: fingers that are farther from a handle do not hold it" in done.err


def test_the_state_in_which_was_judged_is_kept_with_the_verdicts(sdt, tmp_path: Path) -> None:
    store = str(tmp_path / "kept.trig")
    models = ("--kitchens", str(FOLDER / "b.urdf"), "--robots", str(FOLDER / "pr2.urdf"))
    done = sdt("table", *models, "--state", "all=open", "--jobs", "1", "--save", store)
    assert done.code == 0, done.err
    where = "SELECT ?at { ?joint sdt:position ?at . FILTER(CONTAINS(STR(?joint), 'top_drawer_joint')) }"
    assert [row["at"] for row in sdt("query", store, where, "--json").json] == [0.5]


def test_how_fast_the_base_is_assumed_to_move_is_noted_where_it_may(sdt, tmp_path: Path) -> None:
    store, speed = str(tmp_path / "verdicts.trig"), "note: Base speed 0.2 m/s"
    assert speed in achieve(sdt).out
    stands = sdt(
        *("achieve", "--kitchen", "b", "--robot", "stretch", "--drive", "fixed", "--save", store),
        *("--task", "open:iai_fridge_door"),
    )
    assert "note: Wheels are held at 0" in stands.out
    assert speed not in stands.out
    checked = sdt("recheck", store)
    assert "holds: proof" in checked.out
    assert "the verdict does not note" not in checked.out


def test_the_motion_of_another_robot_is_refused(sdt, tmp_path: Path) -> None:
    motion = str(tmp_path / "drawer.npz")
    assert achieve(sdt, "--motion-out", motion).code == 0
    done = achieve(sdt, "--motion", motion, "--json", robot="stretch")
    assert done.code in {1, 2}
    assert "Traceback" not in done.err


def test_too_much_speed_of_a_file_without_velocities_is_told_to_be_of_the_curve_through_its_points(
    sdt, tmp_path: Path
) -> None:
    made, bare = tmp_path / "made.npz", tmp_path / "bare.npz"
    assert achieve(sdt, "--motion-out", str(made)).code == 0
    with np.load(made) as arrays:
        np.savez(bare, **{each: arrays[each] for each in arrays if not each.endswith("velocities")})
    refused = achieve(sdt, "--motion", str(bare))
    assert refused.code == 1
    assert "hint: the motion has no velocities" in refused.err
    assert "no velocities" not in achieve(sdt, "--motion", str(made)).err


@pytest.mark.parametrize(
    ("array", "column", "hinted"),
    [("base", 0, "hint: --base 0.05,0,"), ("robot_positions", 1, "hint: --any-start has the robot begin")],
)
def test_a_motion_that_begins_elsewhere_is_refused_with_the_options_that_let_it(
    sdt, tmp_path: Path, array: str, column: int, hinted: str
) -> None:
    made, moved = tmp_path / "made.npz", tmp_path / "moved.npz"
    assert achieve(sdt, "--motion-out", str(made)).code == 0
    with np.load(made) as arrays:
        values = dict(arrays)
    values[array][:, column] += 0.05
    np.savez(moved, **values)
    refused = achieve(sdt, "--motion", str(moved))
    assert refused.code == 1
    assert refused.err.count("hint: ") == refused.err.count(hinted) == 1
    assert "hint" not in achieve(sdt, "--motion", str(moved), "--json").err
    others = ["--any-start"]
    if array == "base":
        others.append(f"--base={refused.err.split('--base ')[1].split()[0]}")
    for other in others:
        again = achieve(sdt, "--motion", str(moved), *other.split("="))
        assert "(parked)" not in again.out
        assert "hint" not in again.err


def test_a_motion_that_begins_with_the_drawer_ajar_is_refused_with_the_state_that_lets_it(
    sdt, tmp_path: Path
) -> None:
    motion = str(tmp_path / "ajar.npz")
    assert achieve(sdt, "--state", f"{DRAWER}=0.1", "--motion-out", motion).code == 0
    refused = achieve(sdt, "--motion", motion)
    assert refused.code == 1
    assert f"hint: --state {DRAWER}_joint=0.1 has the kitchen begin as the motion does" in refused.err
    assert achieve(sdt, "--motion", motion, "--state", f"{DRAWER}_joint=0.1").code == 0


def test_what_is_proved_of_a_motion_that_was_given_is_said_so(sdt, tmp_path: Path) -> None:
    twin = load_twin("b")
    times, positions = np.array([0.0, 1.0, 2.0]), np.array([[0.0], [0.1], [0.2]])
    short = tmp_path / "short.npz"
    write_motion(short, Motion(twin.container(DRAWER).joint, times, positions, timed=False))
    done = achieve(sdt, "--motion", str(short))
    assert done.code == 1, done.err
    assert "(proved of the motion that was given)" in done.out
    assert "(proved)" not in done.out
    (row,) = csv.DictReader(achieve(sdt, "--motion", str(short), "--csv").out.splitlines())
    assert row["why"].endswith("(proved of the motion that was given)")


def test_what_is_open_already_is_not_certified(sdt) -> None:
    done = achieve(sdt, "--state", f"{DRAWER}=open", "--json")
    assert done.code == 1
    (diagnosis,) = done.json[0]["diagnoses"]
    assert (diagnosis["kind"], diagnosis["proof"]) == ("causal", True)


@pytest.mark.parametrize("command", ["achieve", "causes"])
def test_where_all_is_closed_it_is_said_how_to_ask_about_what_is_open(sdt, command: str) -> None:
    models = ("--kitchen", "b", "--robot", "pr2") if command == "achieve" else ("b",)
    done = sdt(command, *models, "--task", "close")
    assert done.err.count("hint: --state CONTAINER=open begins where there is something to close") == 1
    assert "hint" not in sdt(command, *models, "--task", "close", "--json").err


@pytest.mark.parametrize("command", ["achieve", "causes"])
def test_a_container_s_motion_that_begins_elsewhere_is_told_where(sdt, tmp_path: Path, command: str) -> None:
    file, task = str(tmp_path / "opens.npz"), f"open:{DRAWER}"
    sdt("causes", "b", "--task", task, "--motion-out", file)
    models = ("--kitchen", "b", "--robot", "pr2") if command == "achieve" else ("b",)
    asked = (command, *models, "--task", task, "--motion", file, "--state", f"{DRAWER}=0.1")
    assert f"hint: --state {DRAWER}_joint=0 has the kitchen begin as the motion does" in sdt(*asked).err
    assert "hint" not in sdt(*asked, "--json").err
    assert '"kitchen_elsewhere"' in sdt(*asked, "--json").out


@pytest.mark.parametrize(("code", "hinted"), [("nothing_to_cause", True), (None, False)])
def test_whether_there_is_something_to_do_is_known_by_the_code_of_a_reason_not_by_its_words(
    capsys: pytest.CaptureFixture[str], code: str | None, hinted: bool
) -> None:
    hint_of_state([{"task": "open", "diagnoses": [{"reason": "nothing to cause: words", "code": code}]}])
    hint_of_state([{"task": "open", "diagnoses": [{"reason": "a server of before gives no code"}]}])
    assert capsys.readouterr().err.count("hint: --state CONTAINER=closed") == hinted


def test_how_long_was_searched_is_not_told_of_the_handle(sdt) -> None:
    done = achieve(sdt, "--budget", "0.001")
    assert "its budget of 0.001 s was spent" in done.out
    assert "time of" not in done.out


def test_people_read_what_was_certified(sdt) -> None:
    done = achieve(sdt)
    assert done.out.startswith(f"certified  open({DRAWER})  pr2 in kitchen b")
    assert "smallest distance, self" in done.out


@pytest.mark.parametrize("content", ["nothing", "<a:a> <a:b>"])
def test_a_broken_store_is_named(sdt, tmp_path: Path, content: str) -> None:
    store = tmp_path / "broken.trig"
    store.write_text(content)
    done = achieve(sdt, "--save", str(store))
    assert done.code == 2
    assert "broken.trig" in done.err
    assert store.read_text() == content, "what was there is not lost"
