"""A container that rests on the way may be let go there, and taken hold of anew."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from predicates.case import Case, Diagnosis, Outcome, Quantity
from predicates.law import law
from sdt_kg.annotation import Drive
from sdt_kg.iri import joint_iri
from sdt_kg.load import load_twin
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.embodiment.certify import Certified, Tolerances, certify
from services.embodiment.certify.certificate import read_certificate
from services.embodiment.oracle import WholeBody
from services.embodiment.recheck.embodiment import Certifier
from services.physics.oracle import Kinematics
from tests.services.embodiment.gantry import DRAWER, FOLDER, RESTS, START, TWICE, gantry_twin, opening
from tests.services.embodiment.judging import judge, reasons, refusal

pytestmark = pytest.mark.oracle

CLEAR, BESIDE, BACK, SHUT = 6, 7, 8, 9  # rows of TWICE
Y, FINGER, VALUE = 2, 7, 8


@pytest.fixture(scope="module")
def twin(tmp_path_factory: pytest.TempPathFactory) -> Twin:
    return gantry_twin(tmp_path_factory.mktemp("gantry"))


def twice(*changes: tuple[int, int, float], step: float = 0.1) -> BodyMotion:
    """That motion with entries of its rests changed: row, column, value."""
    rests = TWICE.copy()
    for row, column, value in changes:
        rests[row, column] = value
    return opening(step, rests)


@pytest.mark.parametrize("step", [0.02, 0.1, 100.0])
def test_two_holds_are_certified_and_told(twin: Twin, step: float) -> None:
    found = judge(twin, twice(step=step))
    assert isinstance(found, Certified), found.diagnoses
    assert found.figures["holds"] == (2.0, "1")
    assert found.figures["container at the end"] == (pytest.approx(0.46), "m")
    assert found.figures["tool slip"][0] < 0.0005
    told = "let go on the way: drawer_main is held from 11.00 s to 15.00 s, then anew"
    assert any(one.startswith(told) for one in found.nearest)


def test_the_same_place_may_be_held_again(twin: Twin) -> None:
    rows = (BESIDE, BACK, SHUT, SHUT + 1)
    assert isinstance(judge(twin, twice(*((row, Y, 0.0) for row in rows))), Certified)


def test_a_rest_during_which_the_hand_stays_is_no_second_hold(twin: Twin) -> None:
    rests = np.vstack((TWICE[:5], TWICE[4], TWICE[4]))
    rests[5, 0], rests[6] = 20.0, (24.0, *RESTS[4, 1:])
    found = judge(twin, opening(rests=rests))
    assert isinstance(found, Certified)
    assert "holds" not in found.figures


def beside(aside: float, opened: float = 0.04) -> np.ndarray:
    """The fingers open where the drawer rests, and close again so far beside, without going back."""
    rests = TWICE[[*range(5), 5, BACK, SHUT, SHUT + 1]].copy()
    rests[6:, Y], rests[5:7, FINGER] = aside, opened
    return rests


@pytest.mark.parametrize("aside", [0.0, 0.001, 0.003, 0.03])
@pytest.mark.parametrize("step", [0.1, 100.0])
def test_a_hand_that_opens_may_close_again_in_place_or_beside(twin: Twin, aside: float, step: float) -> None:
    found = judge(twin, opening(step, beside(aside)))
    assert isinstance(found, Certified), found.diagnoses
    assert found.figures["holds"] == (2.0, "1")


@pytest.mark.parametrize(("opened", "lets_go"), [(0.0065, False), (0.008, True)])
def test_fingers_that_stay_near_the_handle_have_not_let_it_go(
    twin: Twin, opened: float, lets_go: bool
) -> None:
    rests = beside(0.001, opened)
    rests[[3, 4, 7, 8], FINGER] = 0.0035  # 1.5 mm deep in the handle
    found = judge(twin, opening(rests=rests))
    assert isinstance(found, Certified) is lets_go
    if not lets_go:
        assert "moves by up to 3.0 mm while it holds the handle" in reasons(twin, opening(rests=rests))


@pytest.mark.parametrize(("again", "certified"), [(0.0065, True), (0.0071, False), (0.04, False)])
def test_fingers_may_close_less_than_before_as_long_as_they_hold(
    twin: Twin, again: float, certified: bool
) -> None:
    rests = beside(0.0)
    rests[[3, 4], FINGER], rests[7:, FINGER] = 0.0035, again  # 1.5 mm deep in the handle; 2 mm off at most
    found = judge(twin, opening(rests=rests))
    assert isinstance(found, Certified) is certified
    if not certified:
        assert "moves on before it is held anew" in reasons(twin, opening(rests=rests))


def test_where_one_hold_is_asked_for_the_hand_does_not_open_on_the_way(twin: Twin) -> None:
    assert "is let go at 0.23 m" in reasons(twin, opening(rests=beside(0.0)), one_hold=True)


def test_a_certificate_of_two_holds_is_verified_again(twin: Twin) -> None:
    found = judge(twin, twice())
    assert isinstance(found, Certified)
    certificate = read_certificate(found.certificate.content())
    again = certify(
        twin,
        certificate.robot,
        certificate.motion,
        certificate.held_in(twin),
        certificate.tolerances,
        drive=certificate.drive,
        start=certificate.start,
        scene=Certifier(twin, certificate).scene,
    )
    assert isinstance(again, Certified)
    assert again.figures == found.figures


@pytest.mark.parametrize(("moved", "certified"), [(1e-12, True), (1e-7, False), (1e-3, False)])
def test_a_container_that_is_let_go_stays_where_it_is(twin: Twin, moved: float, certified: bool) -> None:
    rows = range(CLEAR, SHUT + 1)
    motion = twice(*((row, VALUE, 0.23 + moved) for row in rows))
    assert isinstance(judge(twin, motion), Certified) is certified


def test_a_container_that_creeps_is_held_by_somebody(twin: Twin) -> None:
    fine, n = 0.001, 3000
    rests = np.vstack((TWICE[:7], np.repeat(TWICE[6:7], n, axis=0), TWICE[6:]))
    rests[7 : 7 + n, 0] = TWICE[6, 0] + fine * np.arange(1, n + 1)
    rests[7 : 7 + n, VALUE] += 8e-10 * np.arange(1, n + 1)
    rests[7 + n :, 0] += fine * (n + 1)
    rests[7 + n : -1, VALUE] = rests[6 + n, VALUE]
    found = refusal(twin, opening(100.0, rests), Quantity.DISTANCE)
    assert "moves on before it is held anew" in found[0].reason


@pytest.mark.parametrize("aside", [0.0021, 0.005, 0.03])
def test_closed_fingers_do_not_slide_along_the_handle(twin: Twin, aside: float) -> None:
    rests = TWICE[[*range(5), SHUT, SHUT + 1]].copy()
    rests[5:, Y] = aside
    found = refusal(twin, opening(rests=rests), Quantity.DISTANCE)
    assert any("drawer_handle" in one.reason for one in found)


def test_fingers_that_touch_the_handle_between_two_holds_are_refused(twin: Twin) -> None:
    shut = (CLEAR, FINGER, 0.004), (BESIDE, FINGER, 0.004), (BACK, FINGER, 0.004)
    found = refusal(twin, twice(*shut), Quantity.DISTANCE)
    evidence = found[0].evidence
    assert evidence is not None
    assert evidence.time is not None
    assert 17 < evidence.time < 25


@pytest.mark.parametrize("row", [SHUT, BACK])
def test_a_second_grasp_that_misses_the_handle_is_refused(twin: Twin, row: int) -> None:
    rows = range(row if row == BACK else BESIDE, SHUT + 2)
    column, value = (FINGER, 0.04) if row == BACK else (Y, 0.5)
    found = refusal(twin, twice(*((each, column, value) for each in rows)), Quantity.DISTANCE)
    assert "moves on before it is held anew" in " ".join(one.reason for one in found)


def test_the_second_hold_keeps_its_grasp_too(twin: Twin) -> None:
    found = refusal(twin, twice((SHUT + 1, Y, 0.04)), Quantity.TOOL_ERROR)
    assert any("slips" in one.reason for one in found)


def test_the_container_does_not_move_on_before_the_hand_is_there(twin: Twin) -> None:
    early = twice((BACK, VALUE, 0.26), (SHUT, VALUE, 0.26))
    found: list[Diagnosis] = refusal(twin, early, Quantity.DISTANCE)
    assert "moves on before it is held anew" in found[0].reason


def test_one_hold_may_be_asked_for(twin: Twin) -> None:
    assert "is let go at 0.23 m, before it stops for good" in reasons(twin, twice(), one_hold=True)


@pytest.mark.parametrize("timed", [True, False])
def test_a_motion_with_times_of_its_own_is_followed_in_one_hold(twin: Twin, timed: bool) -> None:
    motion = twice()
    asked = Motion(DRAWER, motion.times, motion.kitchen_q, timed, motion.kitchen_v)
    if timed:
        assert "is let go at 0.23 m" in reasons(twin, motion, asked=asked)
        return
    container = twin.container("drawer_main")
    found = certify(
        twin, twin.robots[0], motion, container, Tolerances(), drive=Drive.OMNI, start=START, asked=asked
    )
    assert isinstance(found, Certified)


def test_a_refusal_in_full_does_not_call_it_lost_that_was_let_go(twin: Twin) -> None:
    motion = twice((CLEAR, 5, 0.9))  # through the front, instead of away from it
    said = reasons(twin, motion, in_full=True)
    assert "mm in each other" in said
    assert "is lost" not in said


def test_a_gripper_need_not_be_named(twin: Twin) -> None:
    assert isinstance(judge(twin, replace(twice(), gripper="")), Certified)


@pytest.mark.parametrize("step", [0.02, 0.1])
def test_where_the_kitchen_is_not_told_the_drawer_goes_with_each_hold(twin: Twin, step: float) -> None:
    motion = twice(step=step)
    bare = replace(motion, kitchen_joints=(), kitchen_q=np.zeros((0, 0)), kitchen_v=np.zeros((0, 0)))
    container = twin.container("drawer_main")
    carried = Kinematics().carried(twin, bare, container)
    np.testing.assert_allclose(carried.values, motion.kitchen_q, atol=1e-5)
    case = Case(twin, twin.robots[0], Task(Verb.OPEN, container.iri), body_motion=bare)
    (verdict,) = law(case, Kinematics(), WholeBody(start=START))
    assert verdict.outcome is Outcome.CERTIFIED, verdict.diagnoses


def test_a_hand_that_only_passes_by_with_open_fingers_drags_nothing(twin: Twin) -> None:
    motion = twice((SHUT, FINGER, 0.04), (SHUT + 1, FINGER, 0.04))
    bare = replace(motion, kitchen_joints=(), kitchen_q=np.zeros((0, 0)), kitchen_v=np.zeros((0, 0)))
    carried = Kinematics().carried(twin, bare, twin.container("drawer_main"))
    assert carried.values[-1, 0] == pytest.approx(0.23, abs=1e-5)


@pytest.mark.parametrize("ratio", [1.0, 2.0, 0.3])
@pytest.mark.parametrize("told", [True, False])
def test_a_container_that_follows_a_motor_is_held_twice_by_a_motion_of_that_or_of_none(
    tmp_path: Path, ratio: float, told: bool
) -> None:
    """What the body motion makes of the container is no motion that somebody asked for with its times."""
    cell = (FOLDER / "cell.urdf").read_text()
    upper = 0.5 / ratio
    motor = (
        '<link name="motor"/><joint name="motor_joint" type="prismatic"><parent link="world"/>'
        f'<child link="motor"/><limit lower="0" upper="{upper}" velocity="9" effort="9"/></joint>'
    )
    mimic = f'effort="10"/><mimic joint="motor_joint" multiplier="{ratio}"/></joint>'
    cell = cell.replace('effort="10"/></joint>', mimic).replace("<!-- more -->", motor)
    (tmp_path / "cell.urdf").write_text(cell)
    twin = load_twin(tmp_path / "cell.urdf", [FOLDER / "gantry.urdf"])
    moves = twice()
    joints = (joint_iri("cell", "motor_joint"),) if told else ()
    columns = slice(0, len(joints))
    moves = replace(
        moves,
        kitchen_joints=joints,
        kitchen_q=moves.kitchen_q[:, columns] / ratio,
        kitchen_v=moves.kitchen_v[:, columns] / ratio,
    )
    task = Task(Verb.OPEN, twin.container("drawer_main").iri)
    (verdict,) = law(
        Case(twin, robot=twin.robots[0], task=task, body_motion=moves),
        Kinematics(),
        WholeBody(Drive.OMNI, START),
    )
    assert verdict.outcome is Outcome.CERTIFIED, verdict.diagnoses
    assert verdict.can_perform is not None
    assert verdict.can_perform.figures["holds"] == (2.0, "1")
