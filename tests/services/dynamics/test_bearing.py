"""CanPerform of D_artic_dyn: a robot that follows the motion must also bear what the handle asks."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from predicates.case import Answer, Case, Kind, Outcome, Verdict
from predicates.causes import causes
from predicates.law import law
from predicates.record import to_record
from sdt_kg.errors import InputError
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.app import load
from services.dynamics.cells import Cells, cells, instants
from services.dynamics.data import with_forces
from services.dynamics.oracle import Dynamics
from services.dynamics.robot.balls import Vectors
from services.dynamics.robot.bearing import Bearing
from services.dynamics.robot.checks import checks
from services.dynamics.robot.load import Loads, loads
from services.dynamics.robot.newton import Placed
from services.dynamics.robot.tipping import Polygon, tipped, tipping
from services.embodiment.certify.motion import whole_motion
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.geometry.interval import Interval
from services.physics.model import Scene
from tests.services.dynamics.forced import forced_twin
from tests.small.lift import Lift

PHYSICS = Dynamics()
ROBOT = "https://example.org/id/pr2"
GRIPPER, LIFT = f"{ROBOT}/gripper/gripper", f"{ROBOT}/joint/lift_joint"


def judged(container: str, **known: Mapping[str, object]) -> Verdict:
    """The verdict with what is known of gripper, lift and robot: `gripper={"gripForce": 40.0}`."""
    twin = forced_twin(("pr2",))
    for subject, name in ((GRIPPER, "gripper"), (LIFT, "lift"), (ROBOT, "robot")):
        if name in known:
            twin = twin.with_edit(subject, **known[name])  # pyright: ignore[reportArgumentType] - values of terms
    (verdict,) = law(asked(twin, container), PHYSICS, Bearing(Lift()))
    return verdict


def asked(twin: Twin, container: str) -> Case:
    return Case(twin, robot=ROBOT, task=Task(Verb.OPEN, twin.container(container).iri))


def performed(verdict: Verdict) -> Answer:
    assert verdict.can_perform is not None
    return verdict.can_perform


def test_what_is_not_known_is_not_checked_and_the_verdict_says_so() -> None:
    verdict = judged("top_drawer")
    assert verdict.outcome is Outcome.CERTIFIED
    notes = " ".join(performed(verdict).notes)
    for what in ("efforts of lift_joint", "grip at the handle", "slip of the base", "tipping of the base"):
        assert f"not checked: {what}" in notes


def test_pads_that_hold_the_handle_are_checked_and_the_share_is_told() -> None:
    verdict = judged("top_drawer", gripper={"gripForce": 200.0, "padFriction": 0.5})
    assert verdict.outcome is Outcome.CERTIFIED
    (share,) = [v for name, (v, _) in performed(verdict).figures.items() if "pads" in name]
    assert 0 < share < 1
    assert "not checked: grip" not in " ".join(performed(verdict).notes)


def test_pads_that_slip_whatever_the_drawer_needs_are_a_refusal_of_the_motion_that_was_found() -> None:
    known = {"gripForce": 1.0, "gripForceMost": 2.0, "padFriction": 0.3, "padFrictionMost": 0.4}
    verdict = judged("top_drawer", gripper=known)
    assert verdict.outcome is Outcome.NOT_CERTIFIED
    (diagnosis,) = verdict.diagnoses
    assert (diagnosis.kind, diagnosis.proof) == (Kind.EMBODIMENT, False)
    assert "press of the pads" in diagnosis.reason
    assert diagnosis.evidence is not None
    assert (diagnosis.evidence.bound, diagnosis.evidence.unit) == (2.0, "N")
    assert diagnosis.evidence.value == pytest.approx(3.0 / 0.4 / 2, rel=0.5)


def test_pads_that_may_slip_leave_it_open() -> None:
    verdict = judged("top_drawer", gripper={"gripForce": 2.0, "padFriction": 0.3})
    assert verdict.outcome is Outcome.ABSTAINED, "that more than the least is not there nobody said"
    assert (verdict.satisfies_request, verdict.causes, verdict.can_perform) == (None, None, None)
    assert "leave open whether the robot bears it" in verdict.diagnoses[0].reason
    assert to_record(verdict).triples


@pytest.mark.parametrize("friction", [0.0, -0.3, float("nan")])
def test_a_friction_that_there_cannot_be_is_no_friction(friction: float) -> None:
    with pytest.raises(InputError, match="padFriction"):
        judged("top_drawer", gripper={"gripForce": 200.0, "padFriction": friction})


@pytest.mark.parametrize("name", ["left", "right"])
def test_tiagos_fingers_press_with_what_their_model_says_and_pr2s_grip_is_not_checked(name: str) -> None:
    twin = with_forces(load("b", ["pr2", "tiago_dual"]).twin)
    facts = twin.entities.facts
    tiago = "https://example.org/id/tiago_dual"
    finger = f"{tiago}/joint/gripper_{name}_left_finger_joint"
    assert facts.number(f"{tiago}/gripper/{name}", "gripForce") == facts.number(finger, "effortLimit") == 16.0
    notes = {
        robot: " ".join(checks(Scene(twin, robot), twin, name, None).missing) for robot in (tiago, ROBOT)
    }
    assert "grip at the handle" not in notes[tiago]
    assert "not checked: grip at the handle" in notes[ROBOT]
    assert "slip of the base" not in notes[tiago] + notes[ROBOT]


def test_a_lift_that_is_too_weak_for_the_oven_door_is_refused() -> None:
    strong = judged("oven_door", lift={"effortLimitKnown": True})
    assert strong.outcome is Outcome.CERTIFIED
    weak = judged("oven_door", lift={"effortLimitKnown": True, "effortLimit": 1.0})
    assert weak.outcome is Outcome.NOT_CERTIFIED
    assert "effort of lift_joint" in weak.diagnoses[0].reason


def test_slip_is_not_checked_where_the_model_gives_no_masses() -> None:
    verdict = judged("top_drawer", robot={"wheelFriction": 0.5})
    assert verdict.outcome is Outcome.CERTIFIED
    assert "not checked: slip of the base, since the model gives no mass of" in " ".join(
        performed(verdict).notes
    )


def felt(force: float, along: tuple[float, float, float], weight: float = 98.1, height: float = 1.0) -> Loads:
    """What a block of 10 kg feels whose hand, 0.5 m before it, pulls a handle along a direction."""
    zero, one = np.zeros(1), np.ones(1)
    still, up = Vectors(np.zeros((1, 3)), zero), Vectors(np.array([[0.0, 0.0, weight]]), zero)
    base = Placed(np.eye(3)[None], zero, still, still, still, still, still)
    flat, given = Interval(zero, zero), Interval(force * one, force * one)
    path, arm = Vectors(np.array([along]), zero), Vectors(np.array([[0.5, 0.0, height]]), zero)
    return Loads(zero, one, {}, {}, {}, given, path, flat, up, still, arm, base)


@pytest.mark.parametrize(("force", "slips"), [(49.0, False), (49.2, True)])
def test_wheels_hold_friction_times_weight(force: float, slips: bool) -> None:
    twin = load("b", ["pr2"]).twin.with_edit(ROBOT, wheelFriction=0.5, wheelFrictionMost=0.5)
    (slip,) = checks(Scene(twin, ROBOT), twin, "left", None).of
    (bound,) = slip(felt(force, (1.0, 0.0, 0.0)))
    assert bound.least == pytest.approx(force - 0.5 * 98.1, abs=1e-6)
    assert (bound.most > 0, bound.least > 0) == (slips, slips)


@pytest.mark.parametrize("degrees", [0.0, 10.0])
def test_pads_on_faces_that_look_elsewhere_hold_by_what_is_left_of_the_cone(degrees: float) -> None:
    name, slant = "https://example.org/id/tiago_dual", np.radians(degrees)
    twin = load("b", ["tiago_dual"]).twin
    friction = {"padFriction": 0.3, "padFrictionMost": 1.2, "gripForce": 16.0, "gripForceMost": 28.0}
    twin = twin.with_edit(f"{name}/gripper/left", **friction)
    (press,) = checks(Scene(twin, name), twin, "left", slant).of
    (bound,) = press(felt(10.0, (1.0, 0.0, 0.0)))
    assert bound.least == pytest.approx(10.0 / 2 / np.tan(np.arctan(1.2) + slant))
    assert bound.most == pytest.approx(10.0 / 2 / np.tan(np.arctan(0.3) - slant))


def test_pads_on_faces_that_look_farther_off_than_they_rub_surely_hold_nothing() -> None:
    name = "https://example.org/id/tiago_dual"
    twin = load("b", ["tiago_dual"]).twin.with_edit(f"{name}/gripper/left", padFriction=0.3, gripForce=16.0)
    (press,) = checks(Scene(twin, name), twin, "left", np.radians(39.2)).of
    (bound,) = press(felt(0.1, (1.0, 0.0, 0.0)))
    assert bound.most > 1e6
    assert bound.least == 0.0


def oven(spans: Callable[[Motion], Cells]) -> tuple[Scene, Loads, BodyMotion]:
    """The lift opens the oven door: what it feels."""
    twin = forced_twin(("pr2",))
    (caused,) = causes(asked(twin, "oven_door"), PHYSICS)
    answer = Lift().perform(replace(asked(twin, "oven_door"), motion=caused.case.motion))
    body, container = answer.case.body_motion, twin.container("oven_door")
    assert isinstance(body, BodyMotion)
    scene, mechanics = Scene(twin, ROBOT), PHYSICS.mechanics(twin, container)
    carried = PHYSICS.carried(twin, body, container)
    return scene, loads(scene, body, mechanics, spans(carried)), body


def test_the_handle_pulls_on_the_robot_as_virtual_work_says() -> None:
    """A joint's effort for one newton is what its motion moves the tool along the handle's path."""
    scene, found, body = oven(partial(cells, parts=4))
    pieces, _ = whole_motion(scene, body, Tolerances())
    lift, frame = scene.coordinate[LIFT], scene.tool_frame("gripper")
    for i in range(0, len(found.begin), len(found.begin) // 7):
        time, piece = float(found.begin[i]), i // 4
        q = pieces.at(np.array([piece]), np.array([time - pieces.start[piece]]))[0][0]
        above = q.copy()
        above[lift] += 1e-6
        step = scene.placement(above, frame).translation - scene.placement(q, frame).translation
        each = float(step @ found.along.centre[i]) / 1e-6
        spread = float(found.along.radius[i]) + 1e-6
        assert found.each[lift].lo[i] - spread <= each <= found.each[lift].hi[i] + spread
        assert np.linalg.norm(found.along.centre[i]) == pytest.approx(1.0)
        assert found.force.lo[i] <= found.force.hi[i]


def test_spans_leave_no_gap_and_finer_ones_bound_closer() -> None:
    _, coarse, body = oven(partial(cells, parts=1))
    _, fine, _ = oven(partial(cells, parts=8))
    for found in (coarse, fine):
        assert found.begin[0] == body.times[0]
        assert found.end[-1] == body.times[-1]
        assert found.begin[1:] == pytest.approx(found.end[:-1])
    assert (fine.beside.hi - fine.beside.lo).max() < (coarse.beside.hi - coarse.beside.lo).max() / 4


def test_what_an_instant_leaves_open_no_span_about_it_decides() -> None:
    _, spans, _ = oven(partial(cells, parts=8))
    _, found, _ = oven(instants)
    about = np.searchsorted(spans.end, found.begin)
    assert (spans.begin[about] <= found.begin).all()
    near = 1e-9
    for name in ("force", "beside"):
        at, over = getattr(found, name), getattr(spans, name)
        assert (over.lo[about] - near <= at.lo).all()
        assert (at.hi <= over.hi[about] + near).all()


def standing(width: float, force: float) -> Interval:
    """The moment that tips the block, on four wheels `width` apart."""
    half = width / 2
    normals = np.array([[-1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0]])
    return tipped(felt(force, (1.0, 0.0, 0.0)), Polygon(normals, np.full(4, -half), 0.0))


def test_a_block_tips_when_its_pull_times_height_exceeds_weight_times_half_its_width() -> None:
    """The handle pulls back with F at 1 m; weight 98.1 N holds it by half its width: F > 98.1 · 0.2."""
    for force, width, tips in ((19.0, 0.4, False), (20.0, 0.4, True), (20.0, 0.5, False)):
        moment = standing(width, force)
        assert moment.hi[0] == pytest.approx(force * 1.0 - 98.1 * width / 2, abs=1e-6)
        assert bool(moment.lo[0] > 0) is tips


def test_a_robot_without_wheels_in_its_data_is_not_called_safe_from_tipping() -> None:
    notes = " ".join(performed(judged("top_drawer")).notes)
    assert "not checked: tipping of the base, since no data (sdt:standsOn)" in notes


@pytest.mark.parametrize(("name", "points"), [("pr2", 4), ("tiago_dual", 6), ("stretch", 0)])
def test_bundled_robots_say_where_their_wheels_touch_the_floor(name: str, points: int) -> None:
    service = load("b", [name]).with_forces()
    robot = service.robot(name)
    assert len(service.twin.entities.facts.iris(robot, "standsOn")) == points
    over, absent = tipping(Scene(service.twin, robot), service.twin)
    assert (over is None, bool(absent)) == (points == 0, points == 0)


def test_a_wheel_that_touches_the_floor_less_than_nowhere_off_is_refused() -> None:
    """A negative distance would widen what the wheels span."""
    service = load("b", ["tiago_dual"]).with_forces()
    robot = service.robot("tiago_dual")
    twin = service.twin.with_edit(f"{robot}/body/caster_front_left_1_link", contactWithin=-0.2)
    with pytest.raises(InputError, match=r"contactWithin of caster_front_left_1_link is -0\.2 m; allowed: 0"):
        tipping(Scene(twin, robot), twin)
