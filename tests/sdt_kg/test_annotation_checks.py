"""What an annotation names is there, is what it is named as, and is whole; else that is told at once."""

import re
import shutil
from pathlib import Path

import pytest

from sdt_kg.errors import AnnotationError
from sdt_kg.load import load_twin
from services.edits import parse_edit
from tests.services.embodiment.gantry import FOLDER

GANTRY = "https://example.org/id/gantry"
TOOL = f"sdt:hasPose <{GANTRY}/tool>"
CORE = f"b:palm sdt:hasCore <{GANTRY}/core> . <{GANTRY}/core> "
SIZES = "sdt:sizeX 0.01 ; sdt:sizeY 0.01"


def refused(folder: Path, pattern: str, replacement: str, more: str = "", urdf: str = "") -> str:
    """Why the gantry is refused with its annotation changed so, more said at its end, or another URDF."""
    for suffix in (".urdf", ".ttl"):
        shutil.copy(FOLDER / f"gantry{suffix}", folder)
    if urdf:
        (folder / "gantry.urdf").write_text(urdf, encoding="utf-8")
    file = folder / "gantry.ttl"
    text, count = re.subn(pattern, replacement, file.read_text(encoding="utf-8"), count=1)
    assert count
    file.write_text(text + more, encoding="utf-8")
    with pytest.raises(AnnotationError) as caught:
        load_twin(FOLDER / "cell.urdf", [folder / "gantry.urdf"])
    return str(caught.value)


LACKS = {
    "x of the tool": (r"sdt:x 0.07 ;", "", "", "lacks: tool sdt:x; robots/README.md"),
    "the tool's pose": (r"/tool> a sdt:Pose", "/tl> a sdt:Pose", "", "tool sdt:x, "),
    "a core's size": ("$", "", f"{CORE} a sdt:Box ; {TOOL} ; {SIZES} .", "lacks: core sdt:sizeZ;"),
    "a core's pose": ("$", "", f"{CORE} a sdt:Box ; {SIZES} ; sdt:sizeZ 1 .", "lacks: core sdt:hasPose;"),
    "a core's kind": ("$", "", f"{CORE} {TOOL} ; {SIZES} ; sdt:sizeZ 1 .", "lacks: core a sdt:Box;"),
    "one kind": (
        "$",
        "",
        f"{CORE} a sdt:Box, sdt:Sphere ; {TOOL} ; {SIZES} ; sdt:sizeZ 1 .",
        "lacks: core a sdt:Box;",
    ),
    "a coupling's joints": (
        r"sdt:overhang",
        f"sdt:hasCoupling <{GANTRY}/c> ; sdt:overhang",
        "",
        "lacks: c sdt:couples; robots/README.md",
    ),
    "a core": ("$", "", f"b:palm sdt:hasCore <{GANTRY}/core> .", "lacks: core sdt:hasPose, core sdt:sizeX,"),
}


@pytest.mark.parametrize("case", LACKS)
def test_what_a_part_lacks_is_named(tmp_path: Path, case: str) -> None:
    pattern, replacement, more, reason = LACKS[case]
    assert reason in refused(tmp_path, pattern, replacement, more)


def test_a_start_pose_that_lacks_a_number_is_refused(tmp_path: Path) -> None:
    shutil.copy(FOLDER / "cell.urdf", tmp_path)
    said = "sdt:x 0.0 ; sdt:y 0.0 ; sdt:z 0.0 ; sdt:qx 0.0 ; sdt:qy 0.0 ; sdt:qw 1.0"
    (tmp_path / "cell.ttl").write_text(
        f"@prefix sdt: <https://example.org/sdt#> . <https://example.org/id/cell> a sdt:Environment ; "
        f"sdt:startPose <https://example.org/id/cell/start> . <https://example.org/id/cell/start> {said} .",
        encoding="utf-8",
    )
    with pytest.raises(AnnotationError, match=r"lacks: start sdt:qz; kitchens/README.md"):
        load_twin(tmp_path / "cell.urdf")


WRONGLY_NAMED = {
    "a joint as tool": (
        r"sdt:toolBody b:palm",
        "sdt:toolBody j:wrist_joint",
        "toolBody of 'hand', is no body",
    ),
    "joints as fingers": (r"sdt:hasFinger b:up_finger", "sdt:hasFinger j:up_joint", "is no body of 'gantry'"),
    "a body of another": (
        r"sdt:hasFinger b:up_finger",
        "sdt:hasFinger <https://x.org/up_finger>",
        "is no body",
    ),
    "a joint as base": (
        r"sdt:baseBody b:base",
        "sdt:baseBody j:lift_joint",
        "sdt:baseBody of 'gantry', is no",
    ),
    "a body as what moves": (
        r"sdt:overhang",
        f"sdt:hasCoupling <{GANTRY}/c> . <{GANTRY}/c> sdt:couples j:lift_joint, b:arm . "
        f"<{GANTRY}> sdt:overhang",
        "body/arm>, sdt:couples of 'c', is no joint of 'gantry'; allowed: <https://example.org/id/gantry/joint/",
    ),
    "a joint that mimics": (
        r"sdt:hasFingerJoint j:up_joint",
        "sdt:hasFingerJoint j:down_joint",
        "mimics 'up_joint'; allowed: joints that are moved for themselves; name that joint instead",
    ),
    "a posture of another": (
        r"j:down_joint sdt",
        "<https://x.org/j> sdt",
        "which has sdt:accelerationLimit, is no",
    ),
}


@pytest.mark.parametrize("case", WRONGLY_NAMED)
def test_what_is_named_as_a_body_or_joint_is_one(tmp_path: Path, case: str) -> None:
    pattern, replacement, reason = WRONGLY_NAMED[case]
    assert reason in refused(tmp_path, pattern, replacement)


def test_a_joint_that_cannot_move_is_no_finger_joint(tmp_path: Path) -> None:
    arm = '<joint name="lift_joint" type="prismatic">'
    text = (FOLDER / "gantry.urdf").read_text(encoding="utf-8")
    assert arm in text
    reason = refused(
        tmp_path,
        r"sdt:hasFingerJoint j:up_joint",
        "sdt:hasFingerJoint j:lift_joint",
        "j:lift_joint sdt:openPosition 0.0 ; sdt:closedPosition 0.0 .",
        urdf=text.replace(arm, arm.replace("prismatic", "fixed")),
    )
    assert (
        "joint/lift_joint>, sdt:hasFingerJoint of 'hand', cannot move; allowed: a joint that moves" in reason
    )


STRUCTURE = {
    "another parent": (
        "sdt:parent b:palm",
        "'lift_joint' has sdt:parent <https://example.org/id/gantry/body/palm>",
    ),
    "a joint that mimics": ("sdt:mimics j:arm_joint", "'lift_joint' has sdt:mimics <"),
    "another kind": (
        "a sdt:RevoluteJoint",
        "'lift_joint' has the type <https://example.org/sdt#RevoluteJoint>",
    ),
}


@pytest.mark.parametrize("case", STRUCTURE)
def test_how_a_robot_is_made_is_for_its_file_to_say(tmp_path: Path, case: str) -> None:
    said, reason = STRUCTURE[case]
    told = refused(tmp_path, "$", "", f"j:lift_joint {said} .")
    assert told.startswith(reason)
    assert "allowed: what the model's file says of it; say it in the model's file" in told


def test_an_annotation_may_repeat_what_the_file_says(tmp_path: Path) -> None:
    for suffix in (".urdf", ".ttl"):
        shutil.copy(FOLDER / f"gantry{suffix}", tmp_path)
    with (tmp_path / "gantry.ttl").open("a", encoding="utf-8") as file:
        file.write("j:lift_joint a sdt:PrismaticJoint ; sdt:parent b:base .")
    load_twin(FOLDER / "cell.urdf", [tmp_path / "gantry.urdf"])


@pytest.mark.parametrize("number", ["0.5", "0.50", "5e-1"])
def test_a_number_that_an_annotation_repeats_is_said_once(tmp_path: Path, number: str) -> None:
    # Two literals of one number were two values, and put the joint out of scope.
    for suffix in (".urdf", ".ttl"):
        shutil.copy(FOLDER / f"gantry{suffix}", tmp_path)
    with (tmp_path / "gantry.ttl").open("a", encoding="utf-8") as file:
        file.write(f"j:lift_joint sdt:velocityLimit {number} .")
    twin = load_twin(FOLDER / "cell.urdf", [tmp_path / "gantry.urdf"])
    _, rows = twin.query(f"SELECT ?limit {{ <{GANTRY}/joint/lift_joint> sdt:velocityLimit ?limit }}")
    assert [row["limit"] for row in rows] == [0.5]


@pytest.mark.parametrize("degrees", ["180.0", "-90.0", "1.0e15"])
def test_degrees_of_a_joint_without_limits_are_refused(tmp_path: Path, degrees: str) -> None:
    # Planning would turn it all the way, in steps that fill the memory.
    said = refused(tmp_path, "j:wrist_joint ", f"j:wrist_joint sdt:parkedPosition {degrees} ; ")
    assert f"sdt:parkedPosition {float(degrees):g} of joint 'wrist_joint' is more than two turns away" in said
    assert "allowed: -12.5664 to 12.5664; give it in rad, without whole turns" in said


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (
            "wrist_joint.parkedPosition=180",
            "of joint 'wrist_joint' is more than two turns away; allowed: -12.5",
        ),
        ("lift_joint.parkedPosition=30", "of joint 'lift_joint' is outside its limits; allowed: 0 to 0.6"),
        ("lift_joint.lowerLimit=0.7", "joint 'lift_joint' between 0.7 and 0.6: its lower limit is above"),
        ("lift_joint.upperLimit=-1", "joint 'lift_joint' between 0 and -1: its lower limit is above"),
        ("up_joint.openPosition=2", "of joint 'up_joint' is outside its limits; allowed: 0 to 0.04"),
    ],
)
def test_an_edit_gives_positions_as_a_file_does(edit: str, said: str) -> None:
    twin = load_twin(FOLDER / "cell.urdf", [FOLDER / "gantry.urdf"])
    with pytest.raises(AnnotationError) as caught:
        parse_edit(twin, f"set:gantry/{edit}")
    assert said in str(caught.value)


def test_a_position_is_inside_the_limits_that_come_with_it() -> None:
    twin = load_twin(FOLDER / "cell.urdf", [FOLDER / "gantry.urdf"])
    lift = f"{GANTRY}/joint/lift_joint"
    edited = twin.with_edit(lift, upperLimit=0.9, parkedPosition=0.8)
    assert edited.robot(edited.robots[0]).parked["lift_joint"] == 0.8
    with pytest.raises(AnnotationError, match=r"allowed: 0 to 0\.2"):
        twin.with_edit(lift, upperLimit=0.2, parkedPosition=0.3)
