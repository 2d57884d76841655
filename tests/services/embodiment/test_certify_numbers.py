"""Numbers that would bound nothing certify nothing: no limit, one below zero, frames that scale, NaN."""

import re
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from sdt_kg.errors import AnnotationError, GraphError, InputError, MotionError, OracleRejectedError
from sdt_kg.iri import joint_iri, model_iri
from sdt_kg.load import load_twin
from sdt_kg.motion import BodyMotion
from sdt_kg.twin import Twin
from services.app import load
from services.embodiment.certify import Certified, Refused, Tolerances, check
from services.embodiment.certify.motion import MOST_SAMPLES
from tests.services.embodiment.gantry import FOLDER, gantry_twin, opening
from tests.services.embodiment.judging import judge, with_rests

pytestmark = pytest.mark.oracle


@pytest.fixture(scope="module")
def twin(tmp_path_factory: pytest.TempPathFactory) -> Twin:
    return gantry_twin(tmp_path_factory.mktemp("gantry"))


def test_a_joint_without_a_limit_of_speed_moves_in_no_certified_motion(twin: Twin) -> None:
    arm = joint_iri("gantry", "arm_joint")
    for name, quantity in (("velocityLimit", "velocity"), ("accelerationLimit", "acceleration")):
        verdict = judge(twin.with_edit(arm, **{name: None}), opening())
        assert isinstance(verdict, Refused)
        (found,) = verdict.diagnoses
        assert found.reason == f"arm_joint moves, and nothing says how fast: it has no limit of {quantity}"


@pytest.mark.parametrize("name", ["lowerLimit", "upperLimit"])
def test_a_slide_without_an_end_moves_in_no_certified_motion(twin: Twin, name: str) -> None:
    arm = joint_iri("gantry", "arm_joint")
    verdict = judge(twin.with_edit(arm, **{name: None}), opening())
    assert isinstance(verdict, Refused)
    (found,) = verdict.diagnoses
    assert found.reason == "arm_joint moves, and nothing says how far: it has no limit of position"


@pytest.mark.parametrize("name", ["velocityLimit", "accelerationLimit", "effortLimit"])
def test_a_limit_below_zero_is_none(twin: Twin, name: str) -> None:
    with pytest.raises(InputError, match=f"sdt:{name} cannot be -1.0; allowed: a finite number, 0 or above"):
        twin.with_edit(joint_iri("gantry", "arm_joint"), **{name: -1.0})


@pytest.mark.parametrize("name", ["overhang", "baseLinearVelocity", "baseAngularAcceleration"])
def test_no_robot_sticks_out_by_less_than_nothing_nor_drives_slower_than_not_at_all(
    twin: Twin, name: str
) -> None:
    with pytest.raises(InputError, match="0 or above"):
        twin.with_edit(twin.robots[0], **{name: -0.1})


@pytest.mark.parametrize("scale", [0.1, 0.9998, 7.0])
def test_a_tool_frame_that_would_scale_distances_is_refused(twin: Twin, scale: float) -> None:
    # The closing direction would be scaled too, and with it how far a finger may be from the handle.
    part = scale * np.sqrt(0.5)
    with pytest.raises(GraphError, match=rf"tool' has the norm {scale:g}; allowed: 1"):
        judge(twin.with_edit(f"{twin.robots[0]}/tool", qx=part, qw=part), opening())


@pytest.mark.parametrize("joint", [joint_iri("gantry", "arm_joint"), joint_iri("cell", "drawer_main_joint")])
def test_an_axis_that_would_scale_positions_is_refused(twin: Twin, joint: str) -> None:
    # A slide would go farther than its position says, and a hinge's turn would be none.
    with pytest.raises(GraphError, match=r"_joint' has the length \S+; allowed: 1"):
        judge(twin.with_edit(joint, axisX=3.0), opening())


@pytest.mark.parametrize("links", [r"\w+", r"\w+_finger"], ids=["no link", "no finger"])
def test_a_gripper_without_a_shape_holds_nothing_and_says_so(tmp_path: Path, links: str) -> None:
    text = (FOLDER / "gantry.urdf").read_text()
    (tmp_path / "gantry.urdf").write_text(
        re.sub(rf'<link name="({links})">.*?</link>', r'<link name="\1"/>', text)
    )
    (tmp_path / "gantry.ttl").write_bytes((FOLDER / "gantry.ttl").read_bytes())
    service = load(FOLDER / "cell.urdf", [tmp_path / "gantry.urdf"])
    with pytest.raises(AnnotationError, match="gripper 'hand' has no collision shape to hold a handle with"):
        next(service.achieve("open:drawer_main"))


@pytest.mark.parametrize("down", [0.01, 0.03])
def test_a_held_body_that_a_motion_moves_all_the_same_stays_above_the_floor(
    tmp_path: Path, down: float
) -> None:
    # Planning holds the lift, which ends 20 mm above the floor; the motion lowers it.
    tall = (FOLDER / "gantry.urdf").read_text().replace('"0.1 0.1 0.1"', '"0.1 0.1 0.56"')
    (tmp_path / "gantry.urdf").write_text(tall.replace('lower="0" upper="0.6"', 'lower="-0.6" upper="0.6"'))
    held = (FOLDER / "gantry.ttl").read_text() + "\nj:lift_joint sdt:held true ."
    (tmp_path / "gantry.ttl").write_text(held)
    twin = load_twin(FOLDER / "cell.urdf", [tmp_path / "gantry.urdf"])
    lowered = np.insert(with_rests(), 1, (4.0, 0.0, 0.0, 0.0, -down, 0.0, 0.0, 0.04, 0.0), axis=0)
    lowered[2:, 0] += 4.0
    verdict = judge(twin, opening(rests=lowered))
    assert isinstance(verdict, Certified if down < 0.02 else Refused)
    if isinstance(verdict, Refused):
        assert all("lift and floor are" in each.reason for each in verdict.diagnoses)


@pytest.mark.parametrize("away", [45.0, 60.0, -1e5])
def test_a_robot_beyond_the_end_of_the_floor_is_refused(tmp_path: Path, away: float) -> None:
    # Nothing would be below its arm.
    cell = (FOLDER / "cell.urdf").read_text().replace('xyz="1.5 0 0"', f'xyz="{1.5 + away} 0 0"')
    (tmp_path / "cell.urdf").write_text(cell)
    motion = opening()
    motion = replace(motion, base=motion.base + np.array((away, 0.0, 0.0)))
    verdict = judge(
        load_twin(tmp_path / "cell.urdf", [FOLDER / "gantry.urdf"]), motion, start=(away, 0.0, 0.0)
    )
    assert isinstance(verdict, Certified if 0 < away < 50 else Refused)
    if isinstance(verdict, Refused):
        (found,) = verdict.diagnoses
        assert "m from the kitchen's origin, and its floor ends after 50 m" in found.reason


@pytest.mark.parametrize("name", [field.name for field in fields(Tolerances)])
def test_a_tolerance_that_is_no_number_is_none(name: str) -> None:
    with pytest.raises(InputError, match=f"the tolerance '{name}' is not a number"):
        Tolerances(**{name: np.nan})


def test_nothing_is_certified_with_a_figure_that_is_no_number(twin: Twin, monkeypatch) -> None:
    monkeypatch.setattr(check, "tolerated", lambda *_: {"room": (np.nan, "m")})
    with pytest.raises(OracleRejectedError, match="figure 'room' came out as nan: nothing is certified"):
        judge(twin, opening(0.5))


def test_a_motion_of_more_samples_than_can_be_checked_is_told_so(twin: Twin) -> None:
    count = MOST_SAMPLES + 1
    none, still = np.zeros((count, 0)), np.zeros((count, 3))
    endless = BodyMotion(model_iri("gantry"), "hand", (), np.arange(count) / 100, still, none, none, still)
    with pytest.raises(MotionError, match=r"200001 samples; allowed: up to 200000; leave samples out"):
        judge(twin, endless)
