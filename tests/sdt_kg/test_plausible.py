"""An annotation that is whole, and says what cannot be so, is refused at once; what can be is not."""

import shutil
from pathlib import Path

import pytest

from sdt_kg.errors import AnnotationError, GraphError
from sdt_kg.load import load_twin
from tests.sdt_kg.test_annotation_checks import GANTRY, refused
from tests.services.embodiment.gantry import FOLDER

COUPLED = f"<{GANTRY}> sdt:hasCoupling <{GANTRY}/c> . <{GANTRY}/c> sdt:couples j:lift_joint"
NOTHING = r"^(?=@prefix)"
"""Found before the first line: there nothing is put in place of nothing."""


@pytest.mark.parametrize(
    ("more", "named"),
    [("", "of lift_joint;"), (", j:lift_joint", "of lift_joint;"), (", j:wrist_joint", "of lift_joint, wr")],
)
def test_one_motor_moves_joints_that_can_move_equally(tmp_path: Path, more: str, named: str) -> None:
    reason = refused(tmp_path, NOTHING, "", f"{COUPLED}{more} .")
    assert f"coupling 'c' is {named}" in reason
    assert "allowed: two joints or more, all hinges or all slides" in reason


def test_two_slides_may_share_a_motor(tmp_path: Path) -> None:
    for suffix in (".urdf", ".ttl"):
        shutil.copy(FOLDER / f"gantry{suffix}", tmp_path)
    with (tmp_path / "gantry.ttl").open("a", encoding="utf-8") as file:
        file.write(f"{COUPLED}, j:arm_joint .")
    twin = load_twin(FOLDER / "cell.urdf", [tmp_path / "gantry.urdf"])
    assert twin.robot(twin.robots[0]).coupled == (("arm_joint", "lift_joint"),)


def test_a_tool_frame_in_millimetres_is_refused(tmp_path: Path) -> None:
    reason = refused(tmp_path, r"sdt:x 0.07 ;", "sdt:x 70 ;")
    assert "the tool frame of 'hand' is 70 m from its body; allowed: up to 2 m; give sdt:x" in reason


@pytest.mark.parametrize(
    ("name", "given", "said"),
    [
        (
            "baseLinearVelocity",
            "200",
            "sdt:baseLinearVelocity is 200 m/s; allowed: up to 10 m/s; give it in m",
        ),
        ("baseAngularVelocity", "45", "sdt:baseAngularVelocity is 45 rad/s; allowed: up to 12.57 rad/s"),
        ("baseLinearAcceleration", "400", "sdt:baseLinearAcceleration is 400 m/s2; allowed: up to 100 m/s2"),
        (
            "baseAngularAcceleration",
            "180",
            "is 180 rad/s2; allowed: up to 125.7 rad/s2; give it in m and rad",
        ),
    ],
)
def test_a_base_that_is_too_fast_for_metres_and_radians_is_refused(
    tmp_path: Path, name: str, given: str, said: str
) -> None:
    assert said in refused(tmp_path, rf"sdt:{name} [0-9.]+", f"sdt:{name} {given}")


def test_a_number_in_python_alone_is_none_of_an_annotation(tmp_path: Path) -> None:
    double = '"1_0"^^<http://www.w3.org/2001/XMLSchema#double>'
    assert "allowed: a finite number" in refused(tmp_path, r"sdt:x 0.07 ;", f"sdt:x {double} ;")


def test_a_class_that_is_none_is_refused(tmp_path: Path) -> None:
    reason = refused(tmp_path, r"a sdt:Gripper ;", "a sdt:Griper ;")
    assert "is a sdt:Griper: no such class; did you mean sdt:Gripper?" in reason


def test_a_core_is_turned_by_a_rotation(tmp_path: Path) -> None:
    for suffix in (".urdf", ".ttl"):
        shutil.copy(FOLDER / f"gantry{suffix}", tmp_path)
    size = "sdt:sizeX 0.01 ; sdt:sizeY 0.01 ; sdt:sizeZ 0.01"
    pose = "sdt:x 0 ; sdt:y 0 ; sdt:z 0 ; sdt:qx 0 ; sdt:qy 0 ; sdt:qz 1 ; sdt:qw 1"
    with (tmp_path / "gantry.ttl").open("a", encoding="utf-8") as file:
        file.write(f"b:palm sdt:hasCore <{GANTRY}/core> . <{GANTRY}/core> a sdt:Box ; {size} ; ")
        file.write(f"sdt:hasPose <{GANTRY}/at> . <{GANTRY}/at> a sdt:Pose ; {pose} .")
    with pytest.raises(
        GraphError, match=r"the quaternion of '.*gantry/at' has the norm 1\.41421; allowed: 1"
    ):
        load_twin(FOLDER / "cell.urdf", [tmp_path / "gantry.urdf"])


def started(folder: Path, pose: str) -> Path:
    """The cell, in whose annotation a robot starts there."""
    shutil.copy(FOLDER / "cell.urdf", folder)
    (folder / "cell.ttl").write_text(
        "@prefix sdt: <https://example.org/sdt#> . <https://example.org/id/cell> a sdt:Environment ; "
        "sdt:startPose <https://example.org/id/cell/start> . <https://example.org/id/cell/start> "
        f"a sdt:Pose ; sdt:x 1 ; sdt:y 2 ; {pose} .",
        encoding="utf-8",
    )
    return folder / "cell.urdf"


@pytest.mark.parametrize(
    "pose",
    [
        "sdt:z 1 ; sdt:qx 0 ; sdt:qy 0 ; sdt:qz 0 ; sdt:qw 1",
        "sdt:z 0 ; sdt:qx 1 ; sdt:qy 0 ; sdt:qz 0 ; sdt:qw 0",
        "sdt:z 0 ; sdt:qx 0 ; sdt:qy 0.6 ; sdt:qz 0 ; sdt:qw 0.8",
    ],
)
def test_a_start_that_leans_or_is_off_the_floor_is_refused(tmp_path: Path, pose: str) -> None:
    with pytest.raises(AnnotationError, match=r"start pose .* leans; allowed: sdt:z, sdt:qx and sdt:qy of 0"):
        load_twin(started(tmp_path, pose))


def test_a_start_turned_about_the_vertical_is_taken(tmp_path: Path) -> None:
    twin = load_twin(started(tmp_path, "sdt:z 0 ; sdt:qx 0 ; sdt:qy 0 ; sdt:qz 0.6 ; sdt:qw 0.8"))
    assert twin.kitchen().start == pytest.approx((1.0, 2.0, 1.2870022175866))
