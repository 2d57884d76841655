"""The certifier accepts a good motion and refuses each way of spoiling it, for the right reason."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from predicates.case import Evidence, Quantity
from sdt_kg.annotation import Drive
from sdt_kg.errors import (
    MotionError,
    UnknownEntityError,
)
from sdt_kg.iri import body_iri, joint_iri, local_name, model_iri
from sdt_kg.motion import ANOTHER, BodyMotion
from sdt_kg.twin import Twin
from services.embodiment.certify import Certified, Refused, Tolerances
from services.embodiment.certify.findings import Findings, Violation
from services.motions.files import arrays_of, motion_of
from tests.services.embodiment.gantry import DRAWER, RESTS, gantry_twin, opening
from tests.services.embodiment.judging import judge, only, refusal, with_rests
from tests.services.embodiment.mutations import paced

pytestmark = pytest.mark.oracle

WALL = """<link name="wall"><collision><geometry><box size="0.001 0.5 0.3"/></geometry></collision></link>
<joint name="wall_joint" type="fixed"><parent link="world"/><child link="wall"/>
<origin xyz="{x} 0 {z}"/></joint>"""


@pytest.fixture(scope="module")
def twin(tmp_path_factory: pytest.TempPathFactory) -> Twin:
    return gantry_twin(tmp_path_factory.mktemp("gantry"))


@pytest.mark.parametrize(("sample", "when"), [(0, "begins"), (-1, "ends")])
def test_a_motion_begins_and_ends_at_rest(twin: Twin, sample: int, when: str) -> None:
    motion = opening()
    moving = motion.v.copy()
    moving[sample, 0] = 0.01
    (found,) = only(twin, replace(motion, v=moving), Quantity.VELOCITY)
    assert found.reason.startswith(f"the motion {when} while")


@pytest.mark.parametrize("step", [0.05, 0.5, 100.0])
def test_a_good_motion_is_certified_however_coarse_its_samples(twin: Twin, step: float) -> None:
    verdict = judge(twin, opening(step))
    assert isinstance(verdict, Certified), verdict.diagnoses
    figures = verdict.figures
    assert figures["container at the end"] == (pytest.approx(0.46), "m")
    assert figures["smallest distance, self"] == (pytest.approx(0.01, abs=1e-6), "m")  # finger to finger
    assert figures["finger to handle"][0] == pytest.approx(0, abs=1e-6)
    assert figures["tool slip"][0] < 0.0005
    assert figures["largest base velocity ratio"][0] == pytest.approx(
        0.6, abs=0.001
    )  # 1.5 · 0.4 m / 5 s / 0.2 m/s


def test_a_file_without_velocities_is_as_good_where_joints_stand_from_sample_to_sample(twin: Twin) -> None:
    arrays = {name: array for name, array in arrays_of(opening()).items() if not name.endswith("velocities")}
    motion = motion_of(arrays, twin)
    assert isinstance(motion, BodyMotion)
    assert isinstance(judge(twin, motion), Certified)  # nothing swings past a stop, or before it is held


def test_nothing_of_the_verdict_depends_on_the_phases_that_a_planner_names(twin: Twin) -> None:
    motion = replace(opening(), phases=(("follow", 0),))
    verdicts = [judge(twin, motion), judge(twin, opening())]
    assert all(isinstance(verdict, Certified) for verdict in verdicts)
    assert verdicts[0].figures == verdicts[1].figures


@pytest.mark.parametrize(
    ("named", "whose"),
    [("crane", "said to be of crane, not of gantry"), ("another robot", "of another robot than gantry")],
)
def test_a_motion_of_another_robot_is_refused_for_that_alone(twin: Twin, named: str, whose: str) -> None:
    other = replace(opening(), robot=model_iri(named), joints=("boom", "jib", "hoist", "hook"))
    (reason,) = refusal(twin, other, Quantity.COUNT)
    assert reason.reason == f"the motion is {whose}: gantry has 0 of its 4 joints, no boom or jib"


def test_whose_the_joints_of_another_robot_s_motion_seem_to_be_is_told(twin: Twin) -> None:
    joints = ("torso_lift_joint", "l_elbow_flex_joint", "l_wrist_roll_joint", "hook")
    for named, told in ((ANOTHER, "; pr2 has 3 of the motion's 4 joints"), ("pr2", "or l_elbow_flex_joint")):
        other = replace(opening(), robot=model_iri(named), joints=joints)
        (reason,) = refusal(twin, other, Quantity.COUNT)
        assert reason.reason.endswith(told)


@pytest.mark.parametrize("before", ["gantry/", "left_"])
def test_names_with_something_before_them_are_told_to_be_its_own_without(twin: Twin, before: str) -> None:
    motion = opening()
    named = replace(motion, robot=model_iri("another robot"), joints=tuple(before + n for n in motion.joints))
    (reason,) = refusal(twin, named, Quantity.COUNT)
    assert reason.reason.endswith(f"; without '{before}' before them they are its own")


def test_a_base_that_starts_elsewhere_is_told_by_how_much_in_each_direction(twin: Twin) -> None:
    motion = opening()
    found = refusal(twin, replace(motion, base=motion.base + np.array([0.3, -0.2, 0.1])), Quantity.POSITION)
    starts = [one.evidence for one in found if "(parked)" in one.reason]
    assert [
        (local_name(each.entity or ""), each.bound - each.value) for each in starts if each is not None
    ] == [
        ("base_x", pytest.approx(-0.3)),
        ("base_y", pytest.approx(0.2)),
        ("base_yaw", pytest.approx(-0.1)),
    ]


def test_a_wall_of_1_mm_between_two_samples_is_seen(tmp_path: Path) -> None:
    # Crossed by the palm at 0.1 to 0.2 m/s: with samples 2 s apart no sample is near it.
    twin = gantry_twin(tmp_path, WALL.format(x=0.85, z=0.6))
    motion = opening(step=100.0)
    found = refusal(twin, motion, Quantity.DISTANCE)
    evidence = [one.evidence for one in found if one.evidence]
    assert all(one.value < 0 and one.scope == "environment" for one in evidence)
    assert {one.links[1] for one in evidence if one.links} == {body_iri("cell", "wall")}
    first = evidence[0]
    assert first.time is not None
    # Worst: the 60 mm of a finger beyond the wall, or the 0.15 m of its height, whichever is less.
    assert 5.0 < first.time < 9.0


def test_the_depth_of_a_penetration_is_right_to_1_mm(twin: Twin) -> None:
    # The arm goes 20 mm too far before the fingers close: their tips, 45 mm from the front, do not
    # touch; 60 mm too far they are 15 mm deep in it.
    rests = RESTS.copy()
    rests[2:4, 5] += 0.06
    verdict = judge(twin, opening(rests=rests))
    assert isinstance(verdict, Refused)
    front = [
        one.evidence.value
        for one in verdict.diagnoses
        if one.evidence and one.evidence.links and one.evidence.links[1] == body_iri("cell", "drawer_main")
    ]
    # A plate of 20 mm: the tip is 25 mm beyond its surface, so the nearest way out is through it.
    assert min(front) == pytest.approx(-0.025, abs=0.001)


def test_a_thin_gap_is_kept_or_not_by_the_margin(tmp_path: Path) -> None:
    # The underside of the arm is at z = 0.48 m, the wall's top 2 mm below.
    twin = gantry_twin(tmp_path, WALL.format(x=0.7, z=0.328))
    assert isinstance(judge(twin, opening()), Refused)  # the palm and fingers are lower
    clear = gantry_twin(tmp_path, WALL.format(x=0.7, z=0.288))  # palm's underside 0.44, wall's top 0.438
    verdict = judge(clear, opening())
    assert isinstance(verdict, Certified), verdict.diagnoses
    assert verdict.figures["smallest distance, environment"] == (pytest.approx(0.002, abs=1e-6), "m")
    assert isinstance(judge(clear, opening(), tolerances=Tolerances(margin=0.003)), Refused)


def test_a_depth_that_is_rounded_to_nothing_is_told_with_more_digits(tmp_path: Path) -> None:
    # The palm's underside is at 0.44 m, the wall's top 0.02 mm above.
    found = refusal(gantry_twin(tmp_path, WALL.format(x=0.7, z=0.29002)), opening(), Quantity.DISTANCE)
    assert {each.reason for each in found} == {"palm and wall are 0.02 mm in each other (at 6.456 s)"}


def test_the_first_and_the_worst_violation_of_a_rule_say_which_they_are_and_when(twin: Twin) -> None:
    found = refusal(twin, paced(opening(), 0.5), Quantity.VELOCITY)
    assert [each.reason for each in found if "base_x" in each.reason] == [
        "base_x reaches velocity 0.2016 m/s, its limit is 0.2 m/s (first at 0.750 s)",
        "base_x reaches velocity 0.24 m/s, its limit is 0.2 m/s (at worst at 1.250 s)",
    ]


def test_what_happens_once_says_when_unless_it_is_at_the_start() -> None:
    def told(*violations: tuple[float | None, float]) -> list[str]:
        measured = Evidence(Quantity.POSITION, 1.0, 0.0, "m")
        each = [Violation("rule", "too far", replace(measured, time=at), much) for at, much in violations]
        return [diagnosis.reason for diagnosis in Findings(each).diagnoses()]

    assert told((2.0, 1.0)) == ["too far (at 2.000 s)"]
    assert told((0.0, 1.0)) == ["too far"]
    assert told((None, 1.0)) == ["too far"]
    assert told((3.0, 2.0), (0.0, 1.0)) == ["too far (first at 0.000 s)", "too far (at worst at 3.000 s)"]
    assert told((3.0, 1.0), (1.0, 2.0)) == ["too far (at 1.000 s)"]


def test_faster_than_the_limits(twin: Twin) -> None:
    motion = opening()
    slow = replace(motion, times=motion.times / 2, v=motion.v * 2, base_v=motion.base_v * 2)
    found = refusal(twin, replace(slow, kitchen_v=motion.kitchen_v * 2), Quantity.VELOCITY)
    assert "base_x" in found[0].reason
    assert "the base, x and y combined," in found[-1].reason
    assert found[-1].evidence is not None
    assert found[-1].evidence.value == pytest.approx(0.24, abs=0.001)  # 1.5 · 0.4 m / 2.5 s
    assert found[-1].evidence.bound == 0.2


def test_the_base_keeps_its_speed_along_diagonals_too(twin: Twin) -> None:
    rests = RESTS.copy()
    rests[1:, 2] = 0.5  # sideways at once: 0.12 m/s and 0.15 m/s are 0.192 m/s; 0.16 and 0.15 are more
    rests[1, 0], rests[2:, 0] = 4.4, RESTS[2:, 0]
    found = refusal(twin, opening(rests=rests), Quantity.VELOCITY)
    assert found[-1].evidence is not None
    assert found[-1].evidence.value == pytest.approx(1.5 * np.hypot(0.4, 0.5) / 4.4, abs=0.001)


def test_acceleration_between_samples_is_that_of_the_spline(twin: Twin) -> None:
    rests = with_rests(time=(3, 9.2))  # fingers close in 0.2 s: 6 · 0.035 m / 0.04 s² = 5.25 m/s²
    found = refusal(twin, opening(rests=rests), Quantity.ACCELERATION)
    assert max(one.evidence.value for one in found if one.evidence) == pytest.approx(5.25)


def test_a_container_keeps_the_acceleration_that_is_assumed_for_it(twin: Twin) -> None:
    rests = with_rests(time=(4, 12.5))  # the drawer opens in 1.5 s: 6 · 0.46 m / 2.25 s²; 1 m/s² is D_artic's
    found = refusal(twin, opening(rests=rests), Quantity.ACCELERATION)
    drawer = [one.evidence for one in found if one.evidence and one.evidence.entity == DRAWER]
    assert [one.bound for one in drawer] == [1.0]
    assert drawer[0].value == pytest.approx(6 * 0.46 / 2.25)


def test_a_jump_is_an_excess_of_velocity(twin: Twin) -> None:
    motion = opening()
    base = motion.base.copy()
    base[30:, 1] += 0.3
    refusal(twin, replace(motion, base=base), Quantity.VELOCITY)


@pytest.mark.parametrize("beyond", [1e-3, 1e-4])
def test_a_joint_out_of_limits_by_little(twin: Twin, beyond: float) -> None:
    rests = with_rests(lift=(0, 0.0))
    rests[0:, 4] = 0.2
    motion = opening(rests=rests)
    q = motion.q.copy()
    q[:20, 3] = 0.04 + beyond  # fingers open too far
    verdict = judge(twin, replace(motion, q=q), start=None)
    assert isinstance(verdict, Refused)
    found = [
        one.evidence
        for one in verdict.diagnoses
        if one.evidence and one.evidence.quantity is Quantity.POSITION
    ]
    assert {one.entity for one in found} <= {
        joint_iri("gantry", "up_joint"),
        joint_iri("gantry", "down_joint"),
    }
    # Between the last sample beyond and the next one the spline overshoots a little.
    assert max(one.value for one in found) == pytest.approx(0.04 + beyond, abs=beyond / 5)


def test_sideways_motion_needs_an_omnidirectional_drive(twin: Twin) -> None:
    assert isinstance(judge(twin, opening(), Drive.DIFFERENTIAL), Certified)  # straight ahead and back
    rests = with_rests(y=(1, 0.02))
    rests[2:, 2] = 0.02
    assert isinstance(judge(twin, opening(rests=rests)), Certified)
    found = refusal(twin, opening(rests=rests), Quantity.SIDEWAYS_VELOCITY, Drive.DIFFERENTIAL)
    assert found[-1].evidence is not None
    assert found[-1].evidence.value == pytest.approx(1.5 * 0.02 / 5, abs=0.0006)


def test_sideways_drift_below_the_velocity_is_summed_up(twin: Twin) -> None:
    rests = RESTS.copy()
    rests[1:, 0] += 15.0
    rests[1:, 2] = 0.015  # in 20 s: 1.1 mm/s at most
    verdict = judge(twin, opening(rests=rests), Drive.DIFFERENTIAL)
    assert isinstance(verdict, Refused)
    (found,) = verdict.diagnoses
    assert "sideways in all" in found.reason
    assert found.evidence is not None
    assert 0.015 <= found.evidence.value <= 0.016  # a bound, from above


def test_a_slow_drive_straight_ahead_has_not_drifted(twin: Twin) -> None:
    verdict = judge(twin, paced(opening(), 1e4), Drive.DIFFERENTIAL)
    assert isinstance(verdict, Certified)
    assert verdict.figures["sideways path"][0] < Tolerances().drift / 16


def test_a_fixed_base_never_moves(twin: Twin) -> None:
    found = only(twin, opening(), Quantity.POSITION, Drive.FIXED)
    assert "fixed" in found[0].reason


def test_a_kitchen_that_stands_still_is_not_opened(twin: Twin) -> None:
    motion = replace(opening(), kitchen_joints=(), kitchen_q=np.zeros((0, 0)), kitchen_v=np.zeros((0, 0)))
    verdict = judge(twin, motion)
    assert isinstance(verdict, Refused)
    assert verdict.diagnoses[0].reason == "drawer_main does not move"


def test_a_motion_starts_where_and_as_it_is_told(twin: Twin) -> None:
    assert isinstance(judge(twin, opening(), start=None), Certified)
    found = refusal(twin, opening(), Quantity.POSITION, start=(0.0, 0.1, 0.0))
    assert "base_y" in found[0].reason
    assert isinstance(judge(twin, opening(), start=(0.0, 0.0, 2 * np.pi)), Certified)  # the same yaw
    rests = with_rests(arm=(0, 0.1))
    found = refusal(twin, opening(rests=rests), Quantity.POSITION)
    assert "parked" in found[0].reason
    assert isinstance(judge(twin, opening(rests=with_rests(finger=(0, 0.03)))), Certified)


def test_a_joint_without_limits_starts_parked_a_turn_further_on_too(twin: Twin) -> None:
    motion = opening()
    turned = replace(motion, q=motion.q + np.array([0, 0, 2 * np.pi, 0]))  # the wrist
    assert isinstance(judge(twin, turned), Certified)
    halfway = replace(motion, q=motion.q + np.array([0, 0, np.pi, 0]))
    assert "parked" in refusal(twin, halfway, Quantity.POSITION)[0].reason


def test_a_motion_starts_in_the_twins_state(twin: Twin) -> None:
    found = refusal(twin.at({DRAWER: 0.1}), opening(), Quantity.POSITION)
    assert "the kitchen's state" in found[0].reason


def test_other_containers_stand_still(tmp_path: Path) -> None:
    other = """<link name="lid"/><joint name="lid_joint" type="revolute"><parent link="cabinet"/>
    <child link="lid"/><axis xyz="0 0 1"/><limit lower="0" upper="1" velocity="1" effort="1"/></joint>"""
    twin, motion = gantry_twin(tmp_path, other), opening()
    lid = joint_iri("cell", "lid_joint")
    two = replace(
        motion,
        kitchen_joints=(DRAWER, lid),
        kitchen_q=np.repeat(motion.kitchen_q, 2, axis=1),
        kitchen_v=np.repeat(motion.kitchen_v, 2, axis=1),
    )
    assert isinstance(judge(twin, motion), Certified)
    found = only(twin, two, Quantity.POSITION)
    assert {one.evidence.entity for one in found if one.evidence} == {lid}


def test_a_mimicking_finger_follows(twin: Twin) -> None:
    motion = opening()
    both = replace(
        motion,
        joints=(*motion.joints, "down_joint"),
        q=np.hstack((motion.q, motion.q[:, 3:])),
        v=np.hstack((motion.v, motion.v[:, 3:])),
    )
    assert isinstance(judge(twin, both), Certified)
    q = both.q.copy()
    q[:, 4] = 0.04
    found = refusal(twin, replace(both, q=q), Quantity.POSITION)
    assert "does not follow" in found[0].reason
    swinging = both.v.copy()
    swinging[60, 4] += 0.5  # [m/s] between two samples 0.1 s apart it leaves the other by 7 mm
    found = refusal(twin, replace(both, v=swinging), Quantity.POSITION)
    assert "does not follow" in found[0].reason
    assert found[0].evidence is not None
    assert found[0].evidence.value == pytest.approx(0.5 * 0.1 * 4 / 27, rel=1e-6)


def test_what_is_no_motion_is_an_error(twin: Twin) -> None:
    motion = opening()
    times = motion.times.copy()
    times[5] = times[4]
    q = motion.q.copy()
    q[3, 2] = np.nan
    far, wild = motion.times + 1e15, motion.v.copy()
    wild[3, 2] = -1e300
    spoiled = (
        (replace(motion, times=times), "times do not increase after sample 4"),
        (replace(motion, times=motion.times * 1e-12), "each 1e-09 s or more"),
        (replace(motion, times=far), "'times' of sample 0 is 1e.15; allowed: finite numbers up to 1e.10"),
        (replace(motion, q=q), "'q' of sample 3 is nan"),
        (replace(motion, v=wild), "'v' of sample 3 is -1e.300"),
        (replace(motion, v=motion.v[1:]), "v of a body motion has shape"),
    )
    for one, said in spoiled:
        with pytest.raises(MotionError, match=said):
            judge(twin, one)
    with pytest.raises(UnknownEntityError, match="lift_joint"):
        judge(twin, replace(motion, joints=("lift_jiont", *motion.joints[1:])))


@pytest.mark.parametrize("moved", ["base_x", "joint/lift_joint"])
def test_nothing_of_the_robot_moves_as_a_joint_of_the_kitchen(twin: Twin, moved: str) -> None:
    # What carries such a motion out moves base and joints as it says of these: here they stand still.
    motion, one = opening(), f"{model_iri('gantry')}/{moved}"
    listed = motion.joints.index("lift_joint")
    column, rate = motion.base[:, :1], motion.base_v[:, :1]
    stands = replace(motion, base=0 * motion.base, base_v=0 * motion.base_v)
    if moved != "base_x":
        column, rate = motion.q[:, [listed]], motion.v[:, [listed]]
        names = tuple(name for name in motion.joints if name != "lift_joint")
        without = np.delete(motion.q, listed, axis=1), np.delete(motion.v, listed, axis=1)
        stands = replace(motion, joints=names, q=without[0], v=without[1])
    kitchen = np.hstack((motion.kitchen_q, column)), np.hstack((motion.kitchen_v, rate))
    joints = (*motion.kitchen_joints, one)
    with pytest.raises(UnknownEntityError, match="no joint of the kitchen named"):
        judge(twin, replace(stands, kitchen_joints=joints, kitchen_q=kitchen[0], kitchen_v=kitchen[1]))
