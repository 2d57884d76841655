"""`sdt learn`: standing alone, with a kitchen, and nothing accepted silently."""

import json
from pathlib import Path

import numpy as np
import pyoxigraph as ox
import pytest
from click.testing import CliRunner
from scipy.spatial.transform import Rotation

from predicates.case import Case
from predicates.causes import causes
from predicates.learn import learn
from sdt_kg.errors import InputError
from sdt_kg.iri import LAW, local_name
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.app import load
from services.cli import sdt
from services.commands.law.learn import parse_up
from services.learning import seen_in
from services.physics.oracle import Kinematics
from services.tracks import read_track
from tests.predicates.learn.logs import log
from tests.predicates.learn.observed import door, drawer, seen, stopping
from tests.predicates.learn.test_proposal import handle, slid, turned
from tests.small import FOLDER

KITCHEN = str(FOLDER / "a.urdf")

TURN = np.array([[-0.6, 0.8, 0.0], [-0.8, -0.6, 0.0], [0.0, 0.0, 1.0]])
"""Turns the axis of the logs' drawer, (0.6, -0.8, 0), into that of low_drawer, (-1, 0, 0)."""


@pytest.fixture
def known(tmp_path: Path) -> str:
    """A drawer as the twin has it."""
    path = tmp_path / "known.csv"
    np.savetxt(path, slid("low_drawer", 0.47).positions)
    return str(path)


@pytest.fixture
def hinged(tmp_path: Path) -> str:
    """A drawer that is a door."""
    path = tmp_path / "hinged.csv"
    track = turned("low_drawer", (1.95, -1.4), 1.2)
    np.savetxt(path, np.column_stack([track.times, track.positions]), delimiter=",")
    return str(path)


def run(*arguments: str, code: int = 0) -> dict[str, object]:
    done = CliRunner().invoke(sdt, ["learn", *arguments, "--json"])
    assert done.exit_code == code, done.output
    return json.loads(done.stdout)


def test_a_track_alone_has_a_joint_and_no_task(known: str) -> None:
    row = run(known)
    assert (row["joint_type"], row["task"], row["radius"]) == ("prismatic", None, None)
    assert {each["joint_type"] for each in row["candidates"]} == {"fixed", "prismatic", "revolute"}
    assert row["limits"] == pytest.approx([0, 0.47], abs=0.005)
    assert row["residual_rms"] == pytest.approx(0.0028, abs=0.0004)


def test_people_read_no_minus_of_nothing(tmp_path: Path) -> None:
    path = tmp_path / "straight.csv"
    np.savetxt(path, np.column_stack((np.linspace(0, 0.4, 40), np.full(40, -1e-9), np.zeros(40))))
    shown = CliRunner().invoke(sdt, ["learn", str(path)]).output
    assert "axis      (1.000, 0.000, 0.000)" in shown
    assert "-0.000" not in shown


def test_fixed_is_told_with_what_it_does_not_exclude(tmp_path: Path) -> None:
    path = tmp_path / "still.csv"
    np.savetxt(path, seen(drawer(stopping(0.01)), 0, 0.003).positions)
    row = run(str(path))
    assert (row["joint_type"], row["limits"]) == ("fixed", None)
    assert 0.01 < row["moved_less_than"] < 0.05
    assert f"a motion of less than {row['moved_less_than'] * 1000:.0f} mm is not excluded" in row["notes"]
    assert row["sure"] is False
    shown = CliRunner().invoke(sdt, ["learn", str(path)]).output
    assert f"cannot tell; likeliest fixed, or moved less than {row['moved_less_than'] * 1000:.0f} mm" in shown


def test_what_gravity_makes_of_an_axis_is_told_beside_what_the_track_shows(tmp_path: Path) -> None:
    path, slant = tmp_path / "slanted.csv", Rotation.from_euler("x", 3, degrees=True)
    np.savetxt(path, seen(slant.apply(door(np.linspace(0, 0.45, 100), 0.45)), 0).positions)
    (note,) = (each for each in run(str(path))["notes"] if "vertical" in each)
    assert "the track alone shows it 4.6 ± 7.3 degrees from there: --up none takes that" in note


def test_a_joint_that_few_samples_show_is_told_to_be_unsure(tmp_path: Path) -> None:
    path = tmp_path / "poor.csv"
    np.savetxt(path, seen(drawer(np.linspace(0, 0.2, 20)), 0, 0.001, outliers=0.4).positions)
    assert any("samples lie off the path" in note for note in run(str(path))["notes"])


def test_a_known_motion_is_named_by_its_task(known: str) -> None:
    row = run(known, "--kitchen", KITCHEN)
    assert row["task"] == "open:low_drawer"
    assert row["kitchen"]["replayed"] is True
    assert row["proposal"] is None


def test_the_distance_from_a_path_beyond_its_limits_is_said_to_leave_them_aside(tmp_path: Path) -> None:
    path = tmp_path / "beyond.csv"
    np.savetxt(path, slid("low_drawer", 0.9).positions)  # the drawer goes to 0.5 m
    done = CliRunner().invoke(sdt, ["learn", str(path), "--kitchen", KITCHEN])
    (line,) = (each for each in done.output.splitlines() if each.startswith("kitchen "))
    assert line.startswith(
        "kitchen   low_drawer, 0.000 to 0.500: the twin cannot replay it, median distance "
    )
    assert float(line.split("median distance ")[1].split()[0]) < 10
    assert line.endswith(" mm, limits aside")


def test_another_joint_is_proposed_and_not_accepted_silently(hinged: str, tmp_path: Path) -> None:
    row = run(hinged, "--kitchen", KITCHEN, code=1)
    assert row["kitchen"]["replayed"] is False
    assert row["proposal"]["after"]["joint_type"] == "revolute"
    assert row["proposal"]["replayed"] is True
    assert row["accepted"] is None
    assert sorted(each.name for each in tmp_path.iterdir()) == ["hinged.csv"]


def test_what_a_proposed_joint_runs_into_is_told_where_it_is_not_accepted(tmp_path: Path) -> None:
    path, branch = tmp_path / "inward.csv", tmp_path / "branch.trig"
    track = turned("low_drawer", (1.95, -1.4), -1.2)  # the wall is behind it
    np.savetxt(path, np.column_stack([track.times, track.positions]), delimiter=",")
    words = ["learn", str(path), "--kitchen", KITCHEN, "--accept", "-o", str(branch)]
    with pytest.raises(InputError, match=r"does not replay the track either: .*low_drawer runs into wall"):
        CliRunner().invoke(sdt, words, catch_exceptions=False)
    assert not branch.exists()


def test_after_acceptance_the_branch_replays_the_track(hinged: str, tmp_path: Path) -> None:
    branch = tmp_path / "branch.trig"
    row = run(hinged, "--kitchen", KITCHEN, "--accept", "-o", str(branch))
    assert (row["accepted"], row["task"]) == (str(branch), "open:low_drawer")
    store = ox.Store()
    store.load(path=str(branch), format=ox.RdfFormat.TRIG)
    twin, physics = Twin.from_quads(store), Kinematics()
    seen = seen_in(twin, learn(read_track(Path(hinged))), physics, "low_drawer")
    (answer,) = causes(Case(twin, motion=seen.motion), physics)
    assert seen.replayed
    assert answer.holds
    question = (
        f"SELECT ?type ?rms ?to WHERE {{ GRAPH ?g {{ ?p <{LAW}jointType> ?type ; <{LAW}residual> ?rms ;"
    )
    (found,) = store.query(question + f" <{LAW}validTo> ?to }} }}")  # type: ignore[misc]
    assert found["type"].value == "revolute"
    assert float(found["rms"].value) == pytest.approx(0.0028, abs=0.0004)
    assert float(found["to"].value) == pytest.approx(1.2, abs=0.02)


def test_a_camera_track_is_placed_in_the_kitchen(tmp_path: Path) -> None:
    positions = slid("low_drawer", 0.47).positions - np.array([1.0, 2.0, 0.3])
    path = tmp_path / "camera.csv"
    np.savetxt(path, positions)
    row = run(str(path), "--kitchen", KITCHEN, "--at", "1,2,0.3")
    assert row["task"] == "open:low_drawer"


def test_a_latch_that_the_twin_does_not_know_is_proposed_too(tmp_path: Path) -> None:
    logged, truth = log("latch", 0)
    track = logged.positions @ TURN.T
    track += slid("low_drawer", 0.0).positions.mean(axis=0) - track[:20].mean(axis=0)
    path, branch = tmp_path / "log.csv", tmp_path / "branch.trig"
    assert logged.forces is not None
    np.savetxt(path, np.column_stack([logged.times, track, logged.forces @ TURN.T]))
    row = run(str(path), "--kitchen", KITCHEN, "--accept", "-o", str(branch))
    assert row["kitchen"]["replayed"] is True
    assert row["mechanism"]["kind"] == "latch"
    assert row["mechanism"]["force"] == pytest.approx(truth.force, abs=4)
    store = ox.Store()
    store.load(path=str(branch), format=ox.RdfFormat.TRIG)
    (found,) = store.query(f"SELECT ?n WHERE {{ GRAPH ?g {{ ?p <{LAW}breakAwayForce> ?n }} }}")  # type: ignore[misc]
    assert float(found["n"].value) == row["mechanism"]["force"]
    twin = Twin.from_quads(store)
    (answer,) = causes(Case(twin, task=Task(Verb.OPEN, twin.container("low_drawer").iri)), Kinematics())
    (note,) = (each for each in answer.notes if "learned" in each)
    assert f"to be held by a latch that gives way at {row['mechanism']['force']:.1f}" in note
    assert "no verdict counts with it" in note


def test_a_second_track_that_follows_has_its_multiplier(tmp_path: Path) -> None:
    paths = [str(tmp_path / f"{name}.csv") for name in ("first", "second")]
    for path, points in zip(paths, (door(stopping(1.2)), door(0.5 * stopping(1.2), 0.3)), strict=True):
        track = seen(points, len(points))
        np.savetxt(path, np.column_stack([track.times, track.positions]))
    row = run(paths[0], "--with", paths[1])
    assert row["coupling"]["holds"] is True
    assert row["coupling"]["multiplier"] == pytest.approx(0.5, abs=0.02)
    assert [row["joint_type"], row["second"]["joint_type"]] == ["revolute", "revolute"]
    for joint, radius in ((row, 0.4), (row["second"], 0.3)):
        assert joint["radius"] == pytest.approx(radius, abs=3 * joint["standard_deviations"]["radius"])


def test_a_drawer_that_follows_another_is_proposed_and_accepted(tmp_path: Path) -> None:
    paths = [str(tmp_path / f"{name}.csv") for name in ("low_drawer", "high_drawer")]
    for path, way in zip(paths, (0.46, 0.4), strict=True):
        track = slid(Path(path).stem, way)
        np.savetxt(path, np.column_stack([track.times, track.positions]))
    branch, asked = tmp_path / "both.trig", ("--kitchen", KITCHEN, "--with", paths[1])
    row = run(paths[0], *asked)
    assert (row["accepted"], row["coupling_proposal"]["replayed"]) == (None, True)
    assert not branch.exists(), "nothing is accepted silently"
    row = run(paths[0], *asked, "--accept", "-o", str(branch))
    assert row["coupling_proposal"]["multiplier"] == pytest.approx(0.4 / 0.46, abs=0.01)
    found = load(str(branch)).twin
    high = found.container("high_drawer")
    assert high.active_joint == found.container("low_drawer").joint
    assert high.multiplier == row["coupling_proposal"]["multiplier"]


def test_latches_are_kept_of_both_containers_that_move_together(tmp_path: Path) -> None:
    logged, _ = log("latch", 0)
    assert logged.forces is not None
    paths = [str(tmp_path / f"{name}.csv") for name in ("low_drawer", "high_drawer")]
    for path in paths:
        track = logged.positions @ TURN.T
        track += slid(Path(path).stem, 0.0).positions.mean(axis=0) - track[:20].mean(axis=0)
        np.savetxt(path, np.column_stack([logged.times, track, logged.forces @ TURN.T]))
    branch = tmp_path / "both.trig"
    row = run(paths[0], "--kitchen", KITCHEN, "--with", paths[1], "--accept", "-o", str(branch))
    assert (row["mechanism"]["kind"], row["second"]["mechanism"]["kind"]) == ("latch", "latch")
    store = ox.Store()
    store.load(path=str(branch), format=ox.RdfFormat.TRIG)
    held = f"SELECT ?c ?n WHERE {{ GRAPH ?g {{ ?p <{LAW}breakAwayForce> ?n ; <{LAW}container> ?c }} }}"
    twin, forces = (
        Twin.from_quads(store),
        {each["c"].value: float(each["n"].value) for each in store.query(held)},
    )  # type: ignore[misc]
    low, high = (twin.container(name) for name in ("low_drawer", "high_drawer"))
    assert high.active_joint == low.joint
    for joint, kept in ((low, row), (high, row["second"])):
        assert forces[joint.iri] == kept["mechanism"]["force"]
        (note,) = (
            each
            for each in twin.mechanism(twin.environment).joint(local_name(joint.joint)).notes
            if "to be held by" in each
        )
        assert "no verdict counts with it" in note


def test_a_drawer_that_is_seen_to_turn_is_no_container_and_the_reason_is_told(tmp_path: Path) -> None:
    path, q, name = str(tmp_path / "odd.csv"), stopping(1.2), "sink_area_left_middle_drawer_main"
    arc = 0.4 * np.column_stack([-np.sin(q), 1 - np.cos(q), 0 * q])
    track = seen(handle(load("b").twin, name) + arc, 5)
    np.savetxt(path, np.column_stack([track.times, track.positions]))
    done = CliRunner().invoke(sdt, ["learn", path, "--kitchen", "b", "--container", name])
    assert isinstance(done.exception, InputError)
    assert f"{name} is revolute, then it is no container: it is called a drawer" in str(done.exception)


def test_csv_has_a_row_for_each_candidate(known: str) -> None:
    done = CliRunner().invoke(sdt, ["learn", known, "--kitchen", KITCHEN, "--csv"])
    head, best, *others = done.output.splitlines()
    assert head.startswith("joint_type,evidence,probability,residual_rms,best")
    assert best.startswith("prismatic")
    assert "low_drawer,True,open:low_drawer" in best
    assert len(others) == 2


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--with-container", "x"], "--with-container without --with and --kitchen"),
        (["--accept"], "without a kitchen there is nothing to compare with; give --kitchen"),
        (["--kitchen", KITCHEN, "-o", "b.trig"], "-o without --accept"),
        (["--kitchen", KITCHEN, "--accept"], "the twin has the path of low_drawer already"),
        (["--kitchen", KITCHEN, "--container", "low_drawr"], "did you mean 'low_drawer'"),
        (["--kitchen", KITCHEN, "--container", "side_door"], "not near the handle of side_door"),
        (["--kitchen", KITCHEN, "--at", "9,9,9"], "not near any handle"),
        (["--kitchen", KITCHEN, "--at", "1,2"], "'1,2' is no pose"),
        (["--up", "north"], "'north' is no direction"),
    ],
)
def test_nonsense_is_refused(known: str, arguments: list[str], message: str) -> None:
    done = CliRunner().invoke(sdt, ["learn", known, *arguments])
    assert isinstance(done.exception, InputError)
    assert message in str(done.exception)


@pytest.mark.parametrize("length", ["1", "1e200", "1e-200"])
def test_up_is_a_direction_whatever_its_length(length: str) -> None:
    assert parse_up(f"{length},0,{length}") == pytest.approx([0.5**0.5, 0.0, 0.5**0.5])


def test_a_folder_by_its_relative_path_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(sdt, ["learn", "."])
    assert isinstance(done.exception, InputError)
    assert str(done.exception).startswith("the folder . is no ROS 2 bag: ")
