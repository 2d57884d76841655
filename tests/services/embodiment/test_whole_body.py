"""CanPerform on the bundled kitchens and robots: what is found, certified, refused and why."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import kitchens
import robots
from predicates.case import Answer, ArtefactKind, Case, Kind, Quantity
from sdt_kg.annotation import Drive
from sdt_kg.load import load_twin
from sdt_kg.motion import LARGEST, BodyMotion, Motion
from sdt_kg.state import Interval, Region
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Container, Twin
from services.edits import parse_edit
from services.embodiment.certify.check import Certified, certify
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.oracle import WholeBody
from services.physics.model import Scene
from services.physics.oracle import Kinematics

pytestmark = pytest.mark.oracle

DRAWER = "sink_area_left_middle_drawer_main"
STAND = (-0.8, 0.0, 0.0)  # [m, rad] base from the handle of that drawer
FRIDGE = "iai_fridge_door"
ASIDE = (-0.9, 0.4, 0.0)  # [m, rad] the same of this door: the tool comes there, but not all the way with it


def motion_of(twin: Twin, container: Container, verb: Verb = Verb.OPEN) -> Motion:
    goal = (
        Interval(container.open_from, container.upper)
        if verb is Verb.OPEN
        else Interval(container.lower, container.closed_to)
    )
    return next(Kinematics().generate(twin, Region(((container.joint, goal),))))


def ask(body: WholeBody, twin: Twin, name: str, verb: Verb = Verb.OPEN) -> Answer:
    container = twin.container(name)
    task = Task(verb, container.iri)
    return body.perform(Case(twin, twin.robots[0], task, motion_of(twin, container, verb)))


def performed(answer: Answer) -> BodyMotion:
    assert answer.holds, [diagnosis.reason for diagnosis in answer.diagnoses]
    assert isinstance(answer.case.body_motion, BodyMotion)
    return answer.case.body_motion


def certified(answer: Answer, name: str, drive: Drive) -> bool:
    """Whether the certifier accepts the motion on a scene of its own."""
    twin, robot = answer.case.twin, answer.case.twin.robots[0]
    body = performed(answer)
    found = certify(twin, robot, body, twin.container(name), Tolerances(), drive=drive)
    return isinstance(found, Certified)


def test_pr2_opens_an_easy_drawer_from_its_start_pose_parked() -> None:
    twin = load_twin("b", ["pr2"])
    answer = ask(WholeBody(drive=Drive.OMNI), twin, DRAWER)
    body = performed(answer)
    assert certified(answer, DRAWER, Drive.OMNI)
    assert body.base[0, :2].tolist() == [0.0, 0.0]
    assert [name for name, _ in body.phases] == ["drive", "approach", "grasp", "follow"]
    assert body.kitchen_q[-1, 0] >= twin.container(DRAWER).open_from
    assert not body.base_v[-1].any()


def test_the_answer_carries_the_container_motion_as_it_is_executed() -> None:
    twin = load_twin("b", ["tiago_dual"])
    answer = ask(WholeBody(drive=Drive.OMNI), twin, DRAWER)
    body, executed = performed(answer), answer.case.motion
    assert isinstance(executed, Motion)
    assert executed.of == twin.container(DRAWER).joint
    assert not executed.timed
    follow = dict(body.phases)["follow"]
    np.testing.assert_allclose(executed.times, body.times[follow:] - body.times[follow], atol=1e-9)
    np.testing.assert_allclose(executed.values[:, 0], body.kitchen_q[follow:, 0], atol=1e-12)


def test_stretch_opens_an_upright_door() -> None:
    twin = load_twin("b", ["stretch"])
    assert certified(ask(WholeBody(drive=Drive.OMNI), twin, FRIDGE), FRIDGE, Drive.OMNI)


def test_tiago_opens_the_oven_whose_hinge_lies() -> None:
    twin = load_twin("b", ["tiago_dual"])
    answer = ask(WholeBody(drive=Drive.OMNI), twin, "oven_area_oven_door")
    assert certified(answer, "oven_area_oven_door", Drive.OMNI)


def test_an_open_drawer_is_closed() -> None:
    twin = load_twin("b", ["tiago_dual"])
    container = twin.container(DRAWER)
    answer = ask(WholeBody(drive=Drive.OMNI), twin.at({container.joint: container.upper}), DRAWER, Verb.CLOSE)
    assert performed(answer).kitchen_q[-1, 0] <= container.closed_to


@pytest.mark.parametrize("name", ["velocityLimit", "accelerationLimit"])
def test_a_joint_that_may_not_move_stands_and_the_others_do_it(name: str) -> None:
    twin = load_twin("b", ["pr2"])
    for side in "lr":
        twin = twin.with_edit(f"{twin.robots[0]}/joint/{side}_elbow_flex_joint", **{name: 0.0})
    body = performed(ask(WholeBody(), twin, DRAWER))
    assert not {"l_elbow_flex_joint", "r_elbow_flex_joint"} & {*body.joints}


def test_a_differential_base_never_moves_sideways() -> None:
    twin = load_twin("b", ["tiago_dual"])
    answer = ask(WholeBody(drive=Drive.DIFFERENTIAL), twin, DRAWER)
    body = performed(answer)
    assert certified(answer, DRAWER, Drive.DIFFERENTIAL)
    yaw = body.base[:, 2]
    sideways = -np.sin(yaw) * body.base_v[:, 0] + np.cos(yaw) * body.base_v[:, 1]
    assert np.abs(sideways).max() < 1e-9


def standing(twin: Twin) -> tuple[float, float, float]:
    """A base pose before the drawer, some way off, from which the arm reaches it."""
    return beside(twin, DRAWER, STAND)


def beside(twin: Twin, name: str, away: tuple[float, float, float]) -> tuple[float, float, float]:
    """A base pose so far from a container's handle, in the world's directions."""
    scene = Scene(twin, twin.robots[0])
    x, y, _ = scene.placement(scene.q((0.0, 0.0, 0.0), {}), twin.container(name).handle).translation
    return float(x) + away[0], float(y) + away[1], away[2]


def test_a_fixed_base_opens_what_it_stands_before_and_nothing_else() -> None:
    twin = load_twin("b", ["tiago_dual"])
    far = ask(WholeBody(drive=Drive.FIXED), twin, DRAWER)
    assert not far.holds
    assert [diagnosis.proof for diagnosis in far.diagnoses] == [True]
    assert far.artefact is not None
    assert far.artefact.kind is ArtefactKind.PROOF
    near = ask(WholeBody(drive=Drive.FIXED, start=standing(twin)), twin, DRAWER)
    assert np.ptp(performed(near).base, axis=0).max() == 0.0


def test_a_handle_higher_than_any_finger_is_proved_out_of_reach() -> None:
    twin = load_twin("a", ["stretch"])
    answer = ask(WholeBody(drive=Drive.OMNI), twin, "cabinet4_door_bottom")
    assert not answer.holds
    (diagnosis,) = answer.diagnoses
    assert diagnosis.kind is Kind.EMBODIMENT
    assert diagnosis.proof
    assert diagnosis.evidence is not None
    assert diagnosis.evidence.bound <= diagnosis.evidence.value


def test_a_start_pose_inside_the_furniture_is_refused_at_once() -> None:
    twin = load_twin("b", ["tiago_dual"])
    x, y, yaw = standing(twin)
    answer = ask(WholeBody(drive=Drive.OMNI, start=(x + 0.8, y, yaw)), twin, DRAWER)
    (diagnosis,) = answer.diagnoses
    assert not diagnosis.proof
    assert diagnosis.evidence is not None
    assert diagnosis.evidence.quantity is Quantity.DISTANCE
    assert diagnosis.evidence.value < 0
    assert diagnosis.evidence.scope == "environment"


@pytest.mark.parametrize("drive", [Drive.OMNI, Drive.FIXED])
def test_a_usual_start_pose_that_is_not_free_is_left_for_the_nearest_that_is(drive: Drive) -> None:
    twin = load_twin("a", ["tiago_dual"])
    open_ones = twin.at({one.joint: one.upper for one in twin.containers()})
    answer = ask(WholeBody(drive=drive), open_ones, "cabinet1_drawer_bottom", Verb.CLOSE)
    x, y, _ = twin.kitchen().start
    moved = [note for note in answer.notes if "beside" in note]
    assert bool(moved) == (drive is Drive.OMNI)
    assert answer.holds == bool(moved)
    if answer.holds:
        first = performed(answer).base[0, :2]
        assert 0.05 < np.hypot(*(first - (x, y))) < 1.5
        given = replace(answer.case, body_motion=performed(answer))
        assert WholeBody(drive=drive).perform(given).holds  # it starts there too


def test_a_search_that_gave_up_says_so_and_proves_nothing() -> None:
    twin = load_twin("b", ["tiago_dual"])
    answer = ask(WholeBody(drive=Drive.FIXED, start=beside(twin, FRIDGE, ASIDE), budget=1.0), twin, FRIDGE)
    assert not answer.holds
    first = answer.diagnoses[0]
    assert not first.proof
    assert first.search is not None
    assert first.search.seeds > 1000
    came = answer.diagnoses[1]
    assert not came.proof
    assert "what stopped it" in came.reason
    assert came.evidence is not None
    assert came.evidence.quantity is Quantity.POSITION
    assert (
        0 < came.evidence.value < came.evidence.bound == pytest.approx(1.419, abs=1e-3)
    )  # 0.9 · π / 2, and 0.005


def test_stretch_opens_a_door_that_tips_over_with_the_drive_that_it_has() -> None:
    twin = load_twin("b", ["stretch"])
    door = "sink_area_dish_washer_door"
    body = performed(answer := ask(WholeBody(drive=Drive.DIFFERENTIAL), twin, door))
    assert certified(answer, door, Drive.DIFFERENTIAL)
    follow = dict(body.phases)["follow"]
    assert np.linalg.norm(body.base[-1, :2] - body.base[follow, :2]) > 0.01
    assert np.ptp(body.base[follow:, 2]) < 1e-9


def test_a_required_time_that_joints_cannot_keep_is_refused() -> None:
    twin = load_twin("b", ["tiago_dual"])
    container = twin.container(DRAWER)
    slow = motion_of(twin, container)
    fast = replace(slow, times=slow.times / slow.times[-1] * 1.8, timed=True)  # the drawer may go so fast
    case = Case(twin, twin.robots[0], Task(Verb.OPEN, container.iri), fast)
    answer = WholeBody(drive=Drive.FIXED, start=standing(twin), budget=2.0).perform(case)
    assert not answer.holds
    assert "required times are too short" in answer.diagnoses[0].reason
    assert "timed: false lets the robot be slower" in answer.diagnoses[0].reason
    evidence = answer.diagnoses[0].evidence
    assert evidence is not None
    assert evidence.quantity in {Quantity.VELOCITY, Quantity.ACCELERATION}
    assert evidence.value > evidence.bound


def test_a_required_time_that_is_kept_is_kept_exactly() -> None:
    twin = load_twin("b", ["tiago_dual"])
    container = twin.container(DRAWER)
    asked = motion_of(twin, container)
    calm = replace(asked, times=asked.times / asked.times[-1] * 40.0, timed=True)
    case = Case(twin, twin.robots[0], Task(Verb.OPEN, container.iri), calm)
    answer = WholeBody(drive=Drive.OMNI).perform(case)
    body = performed(answer)
    follow = dict(body.phases)["follow"]
    at = np.interp(calm.times, body.times[follow:] - body.times[follow], body.kitchen_q[follow:, 0])
    np.testing.assert_allclose(at, calm.values[:, 0], atol=1e-9)
    assert body.times[-1] - body.times[follow] == pytest.approx(40.0)


def test_the_same_seed_gives_the_same_motion() -> None:
    twin = load_twin("b", ["tiago_dual"])
    one = performed(ask(WholeBody(drive=Drive.OMNI, seed=3), twin, DRAWER))
    other = performed(ask(WholeBody(drive=Drive.OMNI, seed=3), twin, DRAWER))
    np.testing.assert_array_equal(one.q, other.q)
    np.testing.assert_array_equal(one.times, other.times)


def test_a_given_body_motion_is_only_verified() -> None:
    twin = load_twin("b", ["tiago_dual"])
    found = ask(WholeBody(drive=Drive.OMNI), twin, DRAWER)
    again = WholeBody(drive=Drive.OMNI).perform(found.case)
    assert again.holds
    assert set(again.seconds) <= {"model", "compile", "certify"}
    body = performed(found)
    wrong = replace(body, q=body.q + np.linspace(0, 0.05, len(body.times))[:, None])
    refused = WholeBody(drive=Drive.OMNI).perform(replace(found.case, body_motion=wrong))
    assert not refused.holds
    assert refused.diagnoses[0].evidence is not None


def test_what_has_no_shape_to_collide_with_is_told_of_motions_that_are_found_and_given(
    tmp_path: Path,
) -> None:
    wall = '<link name="wall"><visual><geometry><box size="9 0.1 9"/></geometry></visual></link>'
    fixed = '<joint name="wall_joint" type="fixed"><parent link="world"/><child link="wall"/></joint>'
    kitchen = (kitchens.path("b") / "b.urdf").read_text().replace("</robot>", f"{wall}{fixed}</robot>")
    (tmp_path / "b.urdf").write_text(kitchen)
    hat = wall.replace("wall", "hat") + fixed.replace("wall", "hat").replace("world", "head_pan_link")
    robot = (robots.path("pr2") / "pr2.urdf").read_text().replace("</robot>", f"{hat}</robot>")
    (tmp_path / "pr2.urdf").write_text(robot)
    twin = load_twin(tmp_path / "b.urdf", [tmp_path / "pr2.urdf"])
    found = ask(WholeBody(drive=Drive.OMNI), twin, DRAWER)
    body, motion = performed(found), found.case.motion
    given = WholeBody(drive=Drive.OMNI).perform(replace(found.case, motion=motion, body_motion=body))
    told = "links with a visual but no collision geometry, which nothing can collide with: "
    for answer in (found, given):
        assert answer.holds
        assert {f"{told}wall", f"{told}hat"} <= {*answer.notes}
        assert (
            "Casters and laser are held at 0; the head stays there unless it is in the way." in answer.notes
        )


def test_a_search_that_could_not_begin_claims_nothing_of_grippers() -> None:
    answer = ask(WholeBody(budget=1e-9), load_twin("b", ["pr2"]), FRIDGE)
    none, spent = (each.reason for each in answer.diagnoses)
    assert "no grasp was found in time that fits around the handle" in none
    assert spent.endswith("its budget of 1e-09 s was spent")


def test_a_motion_of_centuries_is_no_answer_and_no_error() -> None:
    """What was planned with a joint that hardly moves ended in an error about times that nobody had given."""
    twin = load_twin("b", ["pr2"])
    slow = parse_edit(twin, "set:pr2/torso_lift_joint.velocityLimit=1e-12").applied(twin)
    assert performed(ask(WholeBody(Drive.OMNI), slow, FRIDGE)).times[-1] <= LARGEST
