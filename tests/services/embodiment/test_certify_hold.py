"""A container moves only while a gripper holds its handle between its fingers."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pyoxigraph as ox
import pytest

from predicates.case import Case, Quantity
from predicates.law import law
from predicates.meant import left_parked
from predicates.record import to_json, to_record
from sdt_kg.annotation import Drive
from sdt_kg.errors import UnknownEntityError
from sdt_kg.iri import LAW, joint_iri, local_name
from sdt_kg.load import load_twin
from sdt_kg.motion import BodyMotion
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.embodiment.certify import Certified, Refused
from services.embodiment.oracle import WholeBody
from services.physics.oracle import Kinematics
from tests.services.embodiment.gantry import FOLDER, RESTS, START, gantry_twin, opening
from tests.services.embodiment.judging import judge, only, refusal, with_rests
from tests.services.embodiment.mutations import closed

pytestmark = pytest.mark.oracle

BAR = '<box size="0.01 0.2 0.01"/>'


@pytest.fixture(scope="module")
def twin(tmp_path_factory: pytest.TempPathFactory) -> Twin:
    return gantry_twin(tmp_path_factory.mktemp("gantry"))


def gripping(
    short: float = 0.0, aside: float = 0.0, turned: float = 0.0, finger: float = 0.005
) -> BodyMotion:
    """The good motion, but that the hand stays short of the bar, moves up, turns, or closes otherwise."""
    rests = RESTS.copy()
    rests[2:, 5] -= short
    rests[1:, 4] += aside
    rests[1:, 6] = turned
    rests[3:, 7] = finger
    return opening(rests=rests)


def reason(twin: Twin, motion: BodyMotion) -> str:
    """Why it is not held."""
    (found,) = (one for one in refusal(twin, motion, Quantity.DISTANCE) if "before it is held" in one.reason)
    return found.reason


# Tips reach 15 mm over the bar's front, x = 1.2 m, if the hand does not stay short.
@pytest.mark.parametrize("finger", [0.0, 0.005])
@pytest.mark.parametrize("short", [0.0152, 0.0155, 0.0165, 0.0169])
def test_fingertips_in_front_of_the_bar_do_not_hold_it(twin: Twin, short: float, finger: float) -> None:
    assert "not between the fingers" in reason(twin, gripping(short=short, finger=finger))


@pytest.mark.parametrize("finger", [0.04, 0.02, 0.005])
@pytest.mark.parametrize("short", [0.0152, 0.0158, 0.0165])
def test_fingers_side_by_side_along_the_bar_do_not_hold_it(twin: Twin, short: float, finger: float) -> None:
    motion = gripping(short=short, turned=np.pi / 2, finger=finger)
    assert "not between the fingers" in reason(twin, motion)


@pytest.mark.parametrize("deep", [0.0005, 0.0019])
def test_closed_fingers_that_dent_the_front_do_not_hold_it(twin: Twin, deep: float) -> None:
    verdict = judge(twin, gripping(short=0.015 - deep, finger=0.0))
    assert isinstance(verdict, Refused)
    assert "before it is held" in verdict.diagnoses[0].reason


@pytest.mark.parametrize(("short", "holds"), [(0.0115, True), (0.0125, False)])
def test_fingers_reach_3_mm_over_the_bar(twin: Twin, short: float, holds: bool) -> None:
    motion = gripping(short=short)
    if holds:
        assert isinstance(judge(twin, motion), Certified)
    else:
        assert "finger reaches 2.5 mm over drawer_handle" in reason(twin, motion)


def test_fingers_beside_the_end_of_the_bar_do_not_hold_it(twin: Twin) -> None:
    # The bar ends at y = 0.1 m, a finger is 20 mm wide.
    for y, holds in ((0.105, True), (0.1085, False)):
        rests = RESTS.copy()
        rests[:, 2] = y
        verdict = judge(twin, opening(rests=rests), start=(0.0, y, 0.0))
        assert isinstance(verdict, Certified) is holds


@pytest.mark.parametrize(("turned", "holds"), [(0.3, True), (0.5, True), (0.55, False), (0.8, False)])
def test_faces_that_meet_look_along_the_closing_direction_within_30_degrees(
    twin: Twin, turned: float, holds: bool
) -> None:
    # A finger's edge, 10 mm from its middle, touches the bar, whose surface is 5 mm from its axis.
    motion = gripping(turned=turned, finger=(0.005 + 0.01 * np.sin(turned)) / np.cos(turned))
    if holds:
        assert isinstance(judge(twin, motion), Certified)
    else:
        assert "mm over drawer_handle" in reason(twin, motion)


@pytest.mark.parametrize("aside", [0.0155, -0.0155])
def test_closed_fingers_on_one_side_do_not_hold(twin: Twin, aside: float) -> None:
    assert "finger is 10.5 mm away" in reason(twin, gripping(aside=aside, finger=0.0))


@pytest.mark.parametrize(
    ("handle", "finger"),
    [
        ('<sphere radius="0.012"/>', 0.012),
        ('<box size="0.02 0.03 0.024"/>', 0.012),
        ('<cylinder radius="0.012" length="0.02"/>', 0.01),
        ('<box size="0.01 0.2 0.0015"/>', 0.00075),
    ],
)
def test_knobs_and_boxes_are_held_between_the_fingers(tmp_path: Path, handle: str, finger: float) -> None:
    twin = with_handle(tmp_path, handle)
    verdict = judge(twin, gripping(finger=finger))
    assert isinstance(verdict, Certified), verdict.diagnoses
    assert verdict.figures["finger to handle"][0] == pytest.approx(0, abs=2e-6)
    assert "before it is held" in reason(twin, gripping(short=0.024, finger=finger))


def test_a_handle_without_a_shape_cannot_be_held(tmp_path: Path) -> None:
    twin = with_handle(tmp_path, "")
    verdict = judge(twin, gripping())
    assert isinstance(verdict, Refused)
    (found,) = (one for one in verdict.diagnoses if "before it is held" in one.reason)
    assert "has a shape to touch with" in found.reason
    assert found.evidence is not None
    assert found.evidence.value == 0.0


def with_handle(folder: Path, handle: str) -> Twin:
    """The cell with a handle of that geometry, without posts."""
    cell = (FOLDER / "cell.urdf").read_text()
    start = cell.index('<link name="drawer_handle">')
    end = cell.index("</link>", start)
    shape = f"<collision><geometry>{handle}</geometry></collision>" if handle else ""
    body = f'<link name="drawer_handle">{shape}'
    (folder / "cell.urdf").write_text(cell[:start] + body + cell[end:])
    return load_twin(folder / "cell.urdf", [FOLDER / "gantry.urdf"])


def test_a_container_does_not_move_before_it_is_held(twin: Twin) -> None:
    motion = opening()
    kitchen_q = motion.kitchen_q.copy()
    kitchen_q[60:100] += 0.003  # it creeps open by 3 mm and back while the arm comes
    found = refusal(twin, replace(motion, kitchen_q=kitchen_q), Quantity.DISTANCE)
    assert "moves before it is held" in found[0].reason


def test_a_container_does_not_move_by_itself(twin: Twin) -> None:
    rests = RESTS.copy()
    rests[2:, 5] = 0.5  # the arm stays away
    found = refusal(twin, opening(rests=rests), Quantity.DISTANCE)
    assert "moves before it is held" in found[0].reason


def test_one_finger_on_the_handle_is_no_grasp(twin: Twin) -> None:
    rests = RESTS.copy()
    rests[3:, 7] = 0.009  # 4 mm from the bar on both sides
    found = refusal(twin, opening(rests=rests), Quantity.DISTANCE)
    assert found[0].evidence is not None
    assert found[0].evidence.value == pytest.approx(0.004, abs=1e-6)
    rests[1:, 4] -= 0.004  # the upper finger touches, the lower one is 8 mm away
    found = refusal(twin, opening(rests=rests), Quantity.DISTANCE)
    assert found[0].evidence is not None
    assert found[0].evidence.value == pytest.approx(0.008, abs=1e-6)


def test_fingers_that_open_while_they_pull_let_go(twin: Twin) -> None:
    found = refusal(twin, opening(rests=with_rests(finger=(4, 0.02))), Quantity.TOOL_ERROR)
    assert "while it holds the handle" in found[0].reason


def test_fingers_do_not_sink_into_the_handle(twin: Twin) -> None:
    rests = RESTS.copy()
    rests[3:, 7] = 0.001
    found = only(twin, opening(rests=rests), Quantity.DISTANCE)
    assert found[-1].evidence is not None
    assert found[-1].evidence.value == pytest.approx(-0.004, abs=0.001)


def test_the_wrong_gripper_does_not_hold(twin: Twin) -> None:
    found = refusal(twin, replace(opening(), gripper="other"), Quantity.DISTANCE)
    assert "moves before it is held" in found[0].reason
    assert isinstance(judge(twin, replace(opening(), gripper="")), Certified)  # the one that does is found
    with pytest.raises(UnknownEntityError):
        judge(twin, replace(opening(), gripper="hnd"))


@pytest.mark.parametrize("gap", [2e-5, 5e-5, 8e-5])
def test_what_is_too_near_to_be_shown_clear_is_not_said_to_be_nearer_than_it_may_be(
    twin: Twin, gap: float
) -> None:
    beside = replace(closed(opening(), 0.005 + gap), gripper="other")
    found = [one for one in refusal(twin, beside, Quantity.DISTANCE) if "drawer_handle are" in one.reason]
    assert found
    assert all("apart, closer than the check can resolve" in one.reason for one in found)
    for one in found:
        assert one.evidence is not None
        assert one.evidence.value <= one.evidence.bound == pytest.approx(1e-4)


def test_a_shifted_waypoint_slips_off_the_handle(twin: Twin) -> None:
    motion = opening()
    q = motion.q.copy()
    q[150, 1] += 0.004  # arm at 15 s
    found = refusal(twin, replace(motion, q=q), Quantity.TOOL_ERROR)
    assert found[-1].evidence is not None
    assert found[-1].evidence.value == pytest.approx(0.004, abs=0.0003)
    assert found[-1].evidence.time == pytest.approx(15.0, abs=0.1)


def test_a_slip_between_samples_is_seen(twin: Twin) -> None:
    motion = opening(step=1.0)
    v = motion.v.copy()
    v[14, 1] += 0.05  # the samples are right, the spline between them is not
    found = refusal(twin, replace(motion, v=v), Quantity.TOOL_ERROR)
    assert found[-1].evidence is not None
    assert found[-1].evidence.value == pytest.approx(0.05 * 4 / 27, rel=0.05)  # Hermite's bump, h = 1 s


def test_a_turn_of_the_wrist_on_the_handle_is_seen(twin: Twin) -> None:
    rests = with_rests(wrist=(4, 0.03))
    found = refusal(twin, opening(rests=rests), Quantity.ORIENTATION_ERROR)
    assert found[-1].evidence is not None
    assert found[-1].evidence.value == pytest.approx(0.03, abs=0.001)


@pytest.mark.parametrize(
    ("gripper", "joint", "holds"),
    [
        ("hand", "lift_joint", False),
        ("", "lift_joint", False),
        ("other", "lift_joint", False),
        ("hand", "wrist_joint", True),
        ("", "wrist_joint", True),
    ],
)
def test_an_answer_tells_which_joints_of_the_arm_the_motion_leaves_out(
    twin: Twin, gripper: str, joint: str, holds: bool
) -> None:
    body = opening()
    kept = [k for k, name in enumerate(body.joints) if name != joint]
    names = tuple(body.joints[k] for k in kept)
    short = replace(body, gripper=gripper, joints=names, q=body.q[:, kept], v=body.v[:, kept])
    task = Task(Verb.OPEN, twin.container("drawer_main").iri)
    for motion, whole in ((body, True), (short, False)):
        case = Case(twin, twin.robots[0], task, body_motion=motion)
        answer = WholeBody(start=START).perform(case)
        assert answer.holds is (whole or holds)
        assert (f"not listed in the motion, so parked: {joint}" in answer.notes) is not whole
        (verdict,) = law(case, Kinematics(), WholeBody(Drive.OMNI, START))
        parked = [] if whole else [joint]
        assert to_json(verdict)["parked"] == parked
        said = [each for _, name, each in to_record(verdict).triples if name == LAW + "leavesParked"]
        assert said == [ox.NamedNode(joint_iri(local_name(twin.robots[0]), each)) for each in parked]
        assert left_parked(replace(case, body_motion=replace(motion, robot="https://example.org/id/r"))) == ()
