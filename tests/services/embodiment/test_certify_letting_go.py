"""A container that stays where it was brought may be let go: the hand opens and leaves."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from predicates.case import Case, Outcome, Quantity
from predicates.law import law
from sdt_kg.annotation import Drive
from sdt_kg.iri import model_iri
from sdt_kg.load import load_twin
from sdt_kg.motion import BodyMotion
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.embodiment.certify import Certified, Refused, certify
from services.embodiment.certify.collisions import survey
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.oracle import WholeBody
from services.physics import carry
from services.physics.oracle import Kinematics
from tests.services.embodiment.gantry import FOLDER, LETTING_GO, RESTS, START, gantry_twin, opening
from tests.services.embodiment.judging import judge, refusal
from tests.services.embodiment.mutations import before_it_moves, resting
from tests.small import FOLDER as SMALL

pytestmark = pytest.mark.oracle

OPENED, AWAY = map(tuple, LETTING_GO[-2:].tolist())


def letting_go(*more: tuple[float, ...], step: float = 0.1) -> BodyMotion:
    """The good motion, and then rests of one's own."""
    return opening(step, rests=np.vstack((RESTS, more)) if more else LETTING_GO)


@pytest.fixture(scope="module")
def twin(tmp_path_factory: pytest.TempPathFactory) -> Twin:
    return gantry_twin(tmp_path_factory.mktemp("gantry"))


@pytest.mark.parametrize("step", [0.1, 100.0])
def test_a_hand_may_open_and_leave_when_the_container_is_where_it_stays(twin: Twin, step: float) -> None:
    verdict = judge(twin, letting_go(step=step))
    assert isinstance(verdict, Certified), verdict.diagnoses
    assert verdict.figures["container at the end"] == (pytest.approx(0.46), "m")
    # A finger that is open by 0.04 m is 35 mm from a bar of 10 mm: nothing is nearer than what is told.
    assert verdict.figures["smallest distance, handle, let go"] == (0.02, "m")
    assert verdict.figures["tool slip"][0] < 0.0005
    assert (
        "let go: drawer_main is held from 11.00 s to 18.00 s, and nothing in D_artic moves it afterwards"
    ) in verdict.nearest


def test_a_hand_that_only_opens_has_let_go_too(twin: Twin) -> None:
    assert isinstance(judge(twin, letting_go(OPENED)), Certified)


def test_fingers_that_stay_closed_are_not_drawn_off_the_handle(twin: Twin) -> None:
    closed = (*AWAY[:7], 0.005, AWAY[8])
    found = refusal(twin, letting_go(closed), Quantity.DISTANCE)
    assert {
        one.evidence.links[1].rsplit("/", 1)[1] for one in found if one.evidence and one.evidence.links
    } == {"drawer_handle"}


def test_letting_go_before_the_container_stands_is_refused(twin: Twin) -> None:
    rests = np.vstack((RESTS, OPENED))
    rests[4, 7] = 0.04  # the fingers open on the way
    found = refusal(twin, opening(rests=rests), Quantity.TOOL_ERROR)
    assert "while it holds the handle" in found[0].reason


@pytest.mark.parametrize("farther", [0.47, 0.45])
def test_a_container_that_moves_on_when_it_was_let_go_is_refused(twin: Twin, farther: float) -> None:
    rolls = (*AWAY[:8], farther)
    found = refusal(twin, letting_go(OPENED, rolls), Quantity.DISTANCE)
    assert "moves on before it is held anew" in found[0].reason


def test_a_container_that_moves_by_itself_much_later_is_refused(twin: Twin) -> None:
    stays, creeps = (30.0, *AWAY[1:]), (40.0, *AWAY[1:8], 0.461)
    found = refusal(twin, letting_go(OPENED, AWAY, stays, creeps), Quantity.DISTANCE)
    assert "moves on before it is held anew" in found[0].reason


@pytest.mark.parametrize("finger", [0.002, 0.004])
def test_a_hand_that_comes_back_through_the_handle_is_refused(twin: Twin, finger: float) -> None:
    shut = (25.0, *AWAY[1:7], finger, AWAY[8])
    back = (28.0, *OPENED[1:7], finger, OPENED[8])
    found = refusal(twin, letting_go(OPENED, AWAY, shut, back), Quantity.DISTANCE)
    first = next(one.evidence for one in found if one.evidence)
    assert first.links is not None
    assert first.links[1].endswith("drawer_handle")
    assert first.time is not None
    assert 25 < first.time < 28


def test_a_hand_that_comes_back_and_closes_again_is_refused(twin: Twin) -> None:
    back, closed = (26.0, *OPENED[1:]), (28.0, *OPENED[1:7], 0.005, OPENED[8])
    assert isinstance(judge(twin, letting_go(OPENED, AWAY, back)), Certified)
    refusal(twin, letting_go(OPENED, AWAY, back, closed), Quantity.DISTANCE)


@pytest.mark.parametrize(("y", "clear"), [(0.5, False), (1.5, True)])
def test_the_way_back_is_checked_between_samples_as_all_else(tmp_path: Path, y: float, clear: bool) -> None:
    wall = f"""<link name="wall"><collision><geometry><box size="1 0.001 1"/></geometry></collision></link>
    <joint name="wall_joint" type="fixed"><parent link="world"/><child link="wall"/>
    <origin xyz="0.6 {y} 0.6"/></joint>"""
    beside = (28.0, 0.0, 0.6, *AWAY[3:])  # through the wall, with no sample near it
    motion = letting_go(OPENED, AWAY, beside, step=100.0)
    assert isinstance(judge(gantry_twin(tmp_path, wall), motion), Certified) is clear


@pytest.mark.parametrize("away", [AWAY, (23.0, -0.3, *AWAY[2:5], 0.575, *AWAY[6:])])
def test_a_container_goes_where_the_gripper_drags_it_until_the_fingers_open(
    twin: Twin, away: tuple[float, ...]
) -> None:
    # Both ways back lead along the drawer's own way: a hand that is thought to hold on would pull it farther.
    motion = letting_go(OPENED, away)
    bare = replace(motion, kitchen_joints=(), kitchen_q=np.zeros((0, 0)), kitchen_v=np.zeros((0, 0)))
    container = twin.container("drawer_main")
    carried = Kinematics().carried(twin, bare, container)
    assert carried.values == pytest.approx(motion.kitchen_q, abs=1e-5)
    assert carried.values[-1, 0] == pytest.approx(0.46, abs=1e-6)
    (verdict,) = law(
        Case(twin, twin.robots[0], Task(Verb.OPEN, container.iri), body_motion=bare),
        Kinematics(),
        WholeBody(start=START),
    )
    assert verdict.outcome is Outcome.CERTIFIED, verdict.diagnoses


def test_a_robot_that_is_not_asked_about_drags_nothing_though_it_is_loaded(tmp_path: Path) -> None:
    gantry_twin(tmp_path)
    none = {"kitchen_joints": (), "kitchen_q": np.zeros((0, 0)), "kitchen_v": np.zeros((0, 0))}
    robots = [SMALL / "pr2.urdf", FOLDER / "gantry.urdf"]
    said: list[tuple[object, ...]] = []
    for loaded in (robots[:1], robots):
        twin = load_twin(tmp_path / "cell.urdf", loaded)
        task = Task(Verb.OPEN, twin.container("drawer_main").iri)
        case = Case(twin, model_iri("pr2"), task, body_motion=replace(letting_go(), **none))
        (verdict,) = law(case, Kinematics(), WholeBody(start=START))
        assert verdict.satisfies_request is not None
        said.append(
            (verdict.iri, verdict.satisfies_request.holds, [each.reason for each in verdict.diagnoses])
        )
    assert said[0] == said[1]
    assert said[0][1] is False


@pytest.mark.parametrize(("angle", "holds"), [(0.05, True), (0.3, False)])
def test_a_finger_on_a_hinge_lets_go_by_the_way_of_its_tip(tmp_path: Path, angle: float, holds: bool) -> None:
    gantry_twin(tmp_path)  # 72 mm from a hinge to its tip
    urdf = (FOLDER / "gantry.urdf").read_text()
    for name, axis in (("up", "0 0 1"), ("down", "0 0 -1")):
        slide = f'name="{name}_joint" type="prismatic"'
        urdf = urdf.replace(slide, slide.replace("prismatic", "revolute"))
        urdf = urdf.replace(
            f'<axis xyz="{axis}"/>\n <limit lower="0" upper="0.04"',
            '<axis xyz="0 1 0"/><limit lower="0" upper="1"',
        )
    (tmp_path / "gantry.urdf").write_text(urdf)
    (tmp_path / "gantry.ttl").write_bytes((FOLDER / "gantry.ttl").read_bytes())
    twin, rests = load_twin(tmp_path / "cell.urdf", [tmp_path / "gantry.urdf"]), RESTS.copy()
    rests[4, 7] += angle  # on the way
    motion = opening(rests=rests)
    bare = replace(motion, kitchen_joints=(), kitchen_q=np.zeros((0, 0)), kitchen_v=np.zeros((0, 0)))
    carried = Kinematics().carried(twin, bare, twin.container("drawer_main"))
    assert (abs(float(carried.values[-1, 0]) - 0.46) < 1e-6) is holds


@pytest.mark.parametrize("told", [True, False])
def test_how_a_gripper_drags_a_container_is_no_proof_unless_the_motion_says_so(
    twin: Twin, told: bool
) -> None:
    rests = RESTS.copy()
    rests[-1] = rests[-2] + (rests[-1] - rests[-2]) * 0.5  # so far only, and
    rests[-1, 0] = rests[-2, 0] + 0.6  # [s] too fast
    motion, container = opening(rests=rests), twin.container("drawer_main")
    if not told:
        motion = replace(motion, kitchen_joints=(), kitchen_q=np.zeros((0, 0)), kitchen_v=np.zeros((0, 0)))
    case = Case(twin, twin.robots[0], Task(Verb.OPEN, container.iri), body_motion=motion)
    (verdict,) = law(case, Kinematics(), WholeBody(start=START))
    assert verdict.causes is not None
    assert verdict.satisfies_request is not None
    for answer in (verdict.causes, verdict.satisfies_request):
        assert {each.proof for each in answer.diagnoses} == {told}


def test_a_finely_sampled_motion_is_dragged_from_the_same_moment_with_few_looks(
    twin: Twin, monkeypatch: pytest.MonkeyPatch
) -> None:
    motion = letting_go(OPENED, AWAY, step=0.02)
    bare = replace(motion, kitchen_joints=(), kitchen_q=np.zeros((0, 0)), kitchen_v=np.zeros((0, 0)))
    container, looks, fit = twin.container("drawer_main"), [], carry.fitted_positions

    def counted(*about: object) -> object:
        looks.append(about)
        return fit(*about)  # type: ignore[arg-type]

    monkeypatch.setattr(carry, "fitted_positions", counted)
    every = Kinematics().carried(twin, bare, container).values
    most = len(looks)
    monkeypatch.setattr(carry, "BEGINS", 20)
    looks.clear()
    few = Kinematics().carried(twin, bare, container).values
    assert len(looks) < most / 2
    np.testing.assert_allclose(few, every, atol=1e-9)
    np.testing.assert_allclose(few, motion.kitchen_q, atol=1e-5)


def test_a_hand_that_rests_at_the_handle_for_long_is_looked_at_once(
    twin: Twin, monkeypatch: pytest.MonkeyPatch
) -> None:
    motion, none = letting_go(OPENED, AWAY), {"kitchen_joints": (), "phases": ()}
    still = resting(motion, before_it_moves(motion), np.linspace(0.0, 30.0, 3001)[1:])
    empty = np.zeros((len(still.times), 0))
    bare = replace(still, kitchen_q=empty, kitchen_v=empty, **none)
    looks, fit = [], carry.fitted_positions

    def counted(*about: object) -> object:
        looks.append(len(about[-1]))  # type: ignore[arg-type]
        return fit(*about)  # type: ignore[arg-type]

    monkeypatch.setattr(carry, "fitted_positions", counted)
    values = Kinematics().carried(twin, bare, twin.container("drawer_main")).values
    np.testing.assert_allclose(values, still.kitchen_q, atol=1e-5)
    assert sum(looks) < 50 * len(still.times)


@pytest.mark.parametrize("begins", [True, False])
def test_closed_fingers_do_not_slide_along_the_handle_between_samples(twin: Twin, begins: bool) -> None:
    """Before the drawer moves, or once it has stopped, four samples have the hand in its grasp."""
    motion = opening()
    at = before_it_moves(motion) if begins else len(motion.times) - 1
    still = resting(motion, at, np.array([2.0, 6.0, 8.0]))
    assert isinstance(judge(twin, still), Certified)
    still.base_v[at + 1 : at + 3, 1] = 0.06, -0.06  # [m/s] along the bar: 60 mm there and back
    found = refusal(twin, still, Quantity.DISTANCE)
    assert any("drawer_handle" in each.reason for each in found)


def test_every_kind_of_violation_is_told_of_a_hand_that_lets_go_wrongly(twin: Twin) -> None:
    shut, back = (25.0, *AWAY[1:7], 0.002, AWAY[8]), (28.0, *OPENED[1:7], 0.002, OPENED[8])
    motion = letting_go(OPENED, AWAY, shut, back)
    container = twin.container("drawer_main")
    verdict = certify(
        twin, twin.robots[0], motion, container, Tolerances(), drive=Drive.OMNI, start=START, in_full=True
    )
    assert isinstance(verdict, Refused)
    said = " ".join(one.reason for one in verdict.diagnoses)
    assert "contact with drawer_handle is lost" not in said
    assert "drawer_handle are" in said


def test_a_refusal_in_full_of_a_long_log_looks_at_some_of_its_times(
    twin: Twin, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(survey, "MOST_TIMES", 50)
    rests = RESTS.copy()
    rests[2:, 5] += 0.2  # into the front of the drawer, and on
    about = opening(0.01, rests), twin.container("drawer_main"), Tolerances()
    found = certify(twin, twin.robots[0], *about, drive=Drive.OMNI, start=START, in_full=True)
    assert isinstance(found, Refused)
    assert any("mm in each other" in one.reason for one in found.diagnoses)


def test_a_finger_that_comes_to_the_handle_and_goes_on_before_it_is_held_loses_nothing(twin: Twin) -> None:
    motion = opening()
    at = before_it_moves(motion)
    still = resting(motion, at, np.array([2.0, 6.0, 8.0]))
    still.base[at + 1 : at + 3, 0] -= 0.05  # back off, and come again
    container = twin.container("drawer_main")
    about = Tolerances(position=1e-9)  # so that there is something to tell
    found = certify(
        twin, twin.robots[0], still, container, about, drive=Drive.OMNI, start=START, in_full=True
    )
    assert isinstance(found, Refused)
    assert "is lost" not in " ".join(one.reason for one in found.diagnoses)
