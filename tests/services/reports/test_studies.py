"""What reports say of verdicts: on what a refusal rests, where the time goes, which worlds there are."""

from pathlib import Path

import numpy as np
import pytest

from predicates.case import Case, Diagnosis, Kind, Outcome, Search, Verdict
from sdt_kg.errors import InputError
from sdt_kg.motion import BodyMotion, Motion
from services.app import Policy, load
from services.codesign.asked import Asked
from services.codesign.entries import Entry, Found, Grid, How
from services.motions import write_motion
from services.reports.studies import codesign, counterfactual, diagnosis
from services.reports.studies.feasibility import seconds
from services.reports.studies.judged import judged
from services.reports.studies.words import is_proved, said
from tests.small import small_twin

RUNS_INTO = Diagnosis(Kind.CAUSAL, "the drawer runs into the door")
PROVED = Diagnosis(Kind.EMBODIMENT, "no gripper comes there", proof=True)
GAVE_UP = Diagnosis(Kind.EMBODIMENT, "no body motion found", search=Search(1, 0, 0, 1.0))


def refused(*diagnoses: Diagnosis) -> Verdict:
    return Verdict("", Outcome.NOT_CERTIFIED, Case(small_twin()), None, None, None, diagnoses, (), 0.0)


def test_a_refusal_is_said_to_rest_on_what_its_first_failure_rests_on() -> None:
    assert said(refused(RUNS_INTO, PROVED)) == "causal, measured"
    assert is_proved(refused(RUNS_INTO, PROVED))
    assert said(refused(PROVED)) == "embodiment, proved"
    assert said(refused(RUNS_INTO, GAVE_UP)) == "causal, measured"
    assert said(refused(GAVE_UP)) == "embodiment, not proved"


def test_the_time_of_a_motion_in_several_holds_is_that_of_all_of_them() -> None:
    names = ("drive", "approach", "grasp", "follow", "let go", "leave", "approach 2", "grasp 2", "follow 2")
    begins = (0.0, 4.0, 6.0, 7.0, 10.0, 11.0, 13.0, 16.0, 17.0)
    times = np.array([*begins, 19.0])
    still, none = np.zeros((len(times), 3)), np.zeros((len(times), 0))
    phases = tuple((name, sample) for sample, name in enumerate(names))
    motion = BodyMotion("robot", "hand", (), times, still, none, none, still, phases=phases)
    assert seconds(motion) == {"drive": 4.0, "approach": 5.0, "grasp": 2.0, "follow": 5.0, "leave": 3.0}


def test_a_world_that_cannot_be_made_certifies_nothing_and_takes_nothing_away() -> None:
    done = Found("", Outcome.CERTIFIED, How.LAW, {})
    gone = Found("", None, How.NO_WORLD, {})
    edits = ("broken:left",)
    entries = [Entry("k", "stretch", "drawer", *each) for each in (((), done), (edits, gone))]
    coverage = codesign.Coverage(Asked(("k",), ("stretch",), "open", (edits,), Policy()), Grid(entries))
    rows = codesign.counts(coverage).rows
    assert [row[-1] for row in rows] == ["1 / 1", "no such world"]


@pytest.mark.oracle
@pytest.mark.parametrize(
    ("edits", "again"),
    [
        (
            "box:crate=0.3,0.3,0.4@0.6,-0.6,0.2",
            "sdt report diagnosis -p kitchen=b -p robot=pr2 -p task=open:iai_fridge_door -p drive=omni "
            "-p edits=box:crate=0.3,0.3,0.4@0.6,-0.6,0.2 -p motion=FILE",
        ),
        (
            "",
            "sdt achieve --kitchen b --robot pr2 --task open:iai_fridge_door --drive omni --budget 20 "
            "--seed 0",
        ),
    ],
)
def test_the_story_of_an_edited_world_says_so_and_asks_about_that_world(edits: str, again: str) -> None:
    # Told as of the kitchen as it is, it asked another question, whose answer is the other one.
    found = diagnosis.diagnosed("b", "pr2", "open:iai_fridge_door", edits=edits, drive="omni")
    told = [cell for row in diagnosis.story(found).rows for cell in row]
    assert (f"edited: {edits}" in told) is bool(edits)
    assert again in told


@pytest.mark.oracle
def test_a_motion_of_another_robot_is_refused_and_the_way_of_the_container_drawn(tmp_path: Path) -> None:
    drawer = "open:sink_area_left_middle_drawer_main"
    found = diagnosis.diagnosed("b", "pr2", drawer, edits="robot:stretch")
    assert found.verdict.outcome is Outcome.CERTIFIED
    assert isinstance(found.motion, BodyMotion)
    assert found.motion.robot == found.world.robot_iri, "it is looked for, as the other robot's fits no more"
    assert diagnosis.course(found).drawing.get_figheight() < 1.0, "a line that says that nothing was refused"

    write_motion(path := tmp_path / "stretch.npz", found.motion)
    other = diagnosis.diagnosed("b", "pr2", drawer, motion=str(path))
    assert other.verdict.outcome is Outcome.NOT_CERTIFIED
    assert "the motion is said to be of stretch, not of pr2" in other.verdict.diagnoses[0].reason
    assert isinstance(other.motion, Motion)
    (clip,) = diagnosis.view(other).clips
    assert "none of the robot: the one that is given is of another robot" in clip.note
    assert diagnosis.course(other).caption == "There is no motion of the robot to measure along."


@pytest.mark.oracle
def test_a_report_is_about_the_friction_that_is_asked_and_says_how_to_ask_again() -> None:
    box = "box:crate=0.3,0.3,0.4@0.6,-0.6,0.2"
    found = diagnosis.diagnosed("b", "pr2", "open:iai_fridge_door", edits=box, drive="omni", friction="0.4")
    told = [cell for row in diagnosis.story(found).rows for cell in row]
    assert any(
        str(cell).startswith("sdt report diagnosis") and "-p friction=0.4 -p edits=" in cell for cell in told
    )
    drawer = "open:sink_area_left_middle_drawer_main"
    (one,) = judged("b", "pr2", drawer, friction="0.4").all
    (here,) = load("b", ["pr2"], policy=Policy(friction=0.4)).achieve(drawer)
    assert one.verdict.iri == here.iri
    for study in (
        lambda mu: judged("b", "pr2", drawer, friction=mu),
        lambda mu: codesign.covered("b", "pr2", drawer, "drive:fixed", friction=mu),
        lambda mu: counterfactual.judged("b", "pr2", drawer, "drive:fixed", friction=mu),
    ):
        with pytest.raises(InputError, match="'much' is no coefficient of friction"):
            study("much")
