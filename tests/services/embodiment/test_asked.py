"""A τ with times and velocities is one curve: Φ judges it, the robot keeps it, the certificate says so."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from predicates.case import Answer, Case, Outcome, Quantity, Verdict
from predicates.law import law
from sdt_kg.annotation import Drive
from sdt_kg.errors import MotionError
from sdt_kg.iri import joint_iri
from sdt_kg.load import load_twin
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.embodiment.certify.certificate import read_certificate
from services.embodiment.oracle import WholeBody
from services.embodiment.recheck import recheck_artefact
from services.physics.oracle import Kinematics
from services.physics.points import as_poses
from services.physics.replay import spline_of, velocities_of
from services.physics.spline import Cubic
from services.physics.tree import build
from tests.services.embodiment.gantry import DRAWER, START, gantry_twin, opening

pytestmark = pytest.mark.oracle

EASY = "sink_area_left_middle_drawer_main"
UPPER = 0.48  # [m] of that drawer


@cache
def kitchen() -> Twin:
    return load_twin("b", ["tiago_dual"])


def asked(times: list[float], values: list[float], velocities: list[float] | None = None) -> Motion:
    """Of the easy drawer: seconds, shares of the way to its stop, and velocities [m/s]."""
    rates = None if velocities is None else np.array(velocities)[:, None]
    joint = kitchen().container(EASY).joint
    return Motion(joint, np.array(times), UPPER * np.array(values)[:, None], timed=True, velocities=rates)


def perform(motion: Motion) -> Answer:
    container = kitchen().container(EASY)
    case = Case(kitchen(), kitchen().robots[0], Task(Verb.OPEN, container.iri), motion)
    return WholeBody(drive=Drive.OMNI, budget=30.0).perform(case)


def off(motion: Motion, body: BodyMotion) -> float:
    """How far the robot's drawer is from τ at worst, on a fine grid, both ending together [m]."""
    grid = np.linspace(motion.times[0], motion.times[-1], 3001)
    wanted = Cubic(motion.times, motion.values, velocities_of(motion)).at(grid)[0]
    later = grid - motion.times[-1] + body.times[-1]
    return float(np.abs(wanted - Cubic(body.times, body.kitchen_q, body.kitchen_v).at(later)[0]).max())


@pytest.mark.parametrize(
    "motion",
    [
        asked([0, 5, 10, 15, 20], [0, 0.25, 0.5, 0.75, 1], [0, 0, 0, 0, 0]),
        asked([0, 5, 10, 15, 20], [0, 0.25, 0.5, 0.90, 0.92], [0, 0, 0, 0.03, 0]),
        asked([0, 5, 10, 15, 20], [0, 0.25, 0.5, 0.75, 0.95], [0, 0, 0, 0.1, 0]),
        asked([0, 20, 40], [0, 0.5, 0]),
        asked([100, 120], [0, 1]),
    ],
    ids=["rests in between", "swings past its end", "hurries", "comes back", "begins late"],
)
def test_the_robot_keeps_a_timed_motion_between_its_samples_too(motion: Motion) -> None:
    answer = perform(motion)
    assert answer.holds, [each.reason for each in answer.diagnoses]
    assert isinstance(answer.case.body_motion, BodyMotion)
    assert off(motion, answer.case.body_motion) < 1e-12
    executed = answer.case.motion
    assert isinstance(executed, Motion)
    grid = np.linspace(executed.times[0], executed.times[-1], 1001)
    one, other = (
        Cubic(each.times - each.times[0], each.values, velocities_of(each)) for each in (executed, motion)
    )
    np.testing.assert_allclose(one.at(grid)[0], other.at(grid)[0], atol=1e-12)


@pytest.mark.parametrize(
    ("motion", "said"),
    [
        (asked([0, 10, 20], [0, 0.8, 0.99], [0, 0.1, 0]), "reaches position"),
        (asked([0, 20], [0, 0]), "does not move"),
        (asked([0, 20], [0.004, 1]), "starts at"),
    ],
    ids=["past its stop between samples", "stands still", "begins elsewhere"],
)
def test_a_timed_motion_that_nobody_can_keep_is_refused_without_a_search(motion: Motion, said: str) -> None:
    answer = perform(motion)
    assert not answer.holds
    assert said in answer.diagnoses[0].reason
    assert any("none was searched for" in note for note in answer.notes)
    assert "holding" not in answer.seconds


def test_a_motion_past_its_stop_between_samples_is_refused_by_physics_and_by_the_robot() -> None:
    motion = asked([0, 10, 20], [0, 0.8, 0.99], [0, 0.1, 0])
    assert spline_of(motion).position()[1].max() > UPPER
    container = kitchen().container(EASY)
    case = Case(kitchen(), kitchen().robots[0], Task(Verb.OPEN, container.iri), motion)
    (verdict,) = law(case, Kinematics(), WholeBody(drive=Drive.OMNI))
    assert verdict.causes is not None
    assert verdict.can_perform is not None
    assert not verdict.causes.holds
    assert not verdict.can_perform.holds


@pytest.mark.parametrize("timed", [True, False])
def test_a_value_beyond_its_stop_by_the_rounding_of_single_precision_is_at_the_stop(timed: bool) -> None:
    beyond = float(np.nextafter(np.float32(UPPER), np.float32(1)))
    motion = replace(asked([0, 20], [0, beyond / UPPER]), timed=timed)
    assert motion.values[-1, 0] > UPPER
    assert perform(motion).holds


@pytest.mark.parametrize("timed", [True, False])
def test_a_sample_beyond_its_stop_is_refused_with_the_limit(timed: bool) -> None:
    answer = perform(replace(asked([0, 10, 20], [0, 1.1, 0.95]), timed=timed))
    assert not answer.holds
    assert "its limit is 0.48 m" in answer.diagnoses[0].reason


def test_a_motion_that_may_be_slower_goes_the_same_way_there_and_back() -> None:
    motion = replace(asked([0, 0.2, 0.4], [0, 0.8, 0.5]), timed=False)  # far too fast
    answer = perform(motion)
    assert answer.holds, [each.reason for each in answer.diagnoses]
    executed = answer.case.motion
    assert isinstance(executed, Motion)
    assert executed.values[:, 0].max() == pytest.approx(spline_of(motion).position()[1].max(), abs=1e-3)
    assert executed.values[-1, 0] == pytest.approx(0.5 * UPPER)
    assert executed.times[-1] > 1.0


def test_a_motion_given_by_the_joint_that_a_door_follows_is_that_doors() -> None:
    twin = load_twin("a", ["tiago_dual"])
    door = twin.container("cabinet4_door_bottom")
    assert door.multiplier == pytest.approx(1.2)
    last = (door.upper - door.offset) / door.multiplier
    motion = Motion(door.active_joint, np.array([0.0, 30.0]), np.array([[0.0], [last]]))
    answer = WholeBody(drive=Drive.OMNI).perform(
        Case(twin, twin.robots[0], Task(Verb.OPEN, door.iri), motion)
    )
    assert answer.holds, [each.reason for each in answer.diagnoses]
    executed = answer.case.motion
    assert isinstance(executed, Motion)
    assert executed.of == door.joint
    assert executed.values[-1, 0] == pytest.approx(door.upper)


def test_a_motion_of_another_container_than_the_tasks_is_an_error() -> None:
    other = kitchen().container("iai_fridge_door")
    case = Case(kitchen(), kitchen().robots[0], Task(Verb.OPEN, other.iri), asked([0, 20], [0, 1]))
    with pytest.raises(MotionError, match="does not move iai_fridge_door"):
        WholeBody(drive=Drive.OMNI).perform(case)


@pytest.mark.parametrize("timed", [True, False])
@pytest.mark.parametrize(
    ("off", "first"), [(0.0, 0), (0.05, 8), (0.3, 0)], ids=["as it goes", "aside", "higher"]
)
def test_a_path_that_leaves_the_joints_way_is_not_certified_for_what_a_robot_does_instead(
    timed: bool, off: float, first: int
) -> None:
    container, u = kitchen().container(EASY), np.linspace(0, 1, 25)
    values = replace(asked((20 * u).tolist(), (3 * u**2 - 2 * u**3).tolist()), timed=timed)
    path = as_poses(build(kitchen().mechanism(kitchen().environment)), kitchen(), values, container.handle)
    path.values[first:16, 2] += off
    case = Case(kitchen(), kitchen().robots[0], Task(Verb.OPEN, container.iri), path)
    (verdict,) = law(case, Kinematics(), WholeBody(drive=Drive.OMNI))
    assert verdict.causes is not None
    assert verdict.causes.holds is (off == 0)
    assert verdict.outcome is (Outcome.NOT_CERTIFIED if off else Outcome.CERTIFIED)


def test_a_motion_that_is_too_fast_is_certified_as_a_robot_slows_it_where_it_may() -> None:
    container, fast = kitchen().container(EASY), asked([0, 0.3], [0, 1])
    for timed, outcome in ((False, Outcome.CERTIFIED), (True, Outcome.NOT_CERTIFIED)):
        about = Task(Verb.OPEN, container.iri), replace(fast, timed=timed)
        case = Case(kitchen(), kitchen().robots[0], *about)
        (verdict,) = law(case, Kinematics(), WholeBody(drive=Drive.OMNI))
        assert verdict.outcome is outcome


def carried(later: float = 0.0) -> Motion:
    """What the gantry's motion does with the drawer, from the grasp on, that many seconds later."""
    body = opening()
    follow = body.times >= 11.0 - 1e-9
    arrays = body.times[follow] - 11.0 + later, body.kitchen_q[follow]
    return Motion(DRAWER, *arrays, timed=True, velocities=body.kitchen_v[follow])


def both(folder: Path, motion: Motion) -> Verdict:
    twin = gantry_twin(folder)
    task = Task(Verb.OPEN, twin.container("drawer_main").iri)
    case = Case(twin, twin.robots[0], task, motion, body_motion=opening())
    (verdict,) = law(case, Kinematics(), WholeBody(Drive.OMNI, START))
    return verdict


@pytest.mark.parametrize("later", [0.0, 7.0])
def test_a_body_motion_that_keeps_the_motion_that_is_asked_for_is_certified(
    tmp_path: Path, later: float
) -> None:
    verdict = both(tmp_path, carried(later))
    assert verdict.outcome is Outcome.CERTIFIED, [each.reason for each in verdict.diagnoses]


def slower(motion: Motion) -> Motion:
    assert motion.velocities is not None
    return replace(motion, times=motion.times * 1.1, velocities=motion.velocities / 1.1)


def resting(motion: Motion) -> Motion:
    assert motion.velocities is not None
    return Motion(
        motion.of, motion.times[::10], motion.values[::10], True, np.zeros_like(motion.values[::10])
    )


def one_percent_less(motion: Motion) -> Motion:
    assert motion.velocities is not None
    return replace(motion, values=0.99 * motion.values, velocities=0.99 * motion.velocities)


def mirrored(motion: Motion) -> Motion:
    """It goes where the drawer never is."""
    assert motion.velocities is not None
    return replace(motion, values=-motion.values, velocities=-motion.velocities)


def test_how_far_a_body_motion_is_from_where_it_never_comes_is_a_number(tmp_path: Path) -> None:
    verdict = both(tmp_path, mirrored(carried()))
    assert verdict.can_perform is not None
    (diagnosis,) = verdict.can_perform.diagnoses
    assert diagnosis.evidence is not None
    assert diagnosis.evidence.value == pytest.approx(0.46)


@pytest.mark.parametrize("change", [slower, resting, one_percent_less])
def test_a_body_motion_that_does_not_keep_the_motion_that_is_asked_for_is_not_certified(
    tmp_path: Path, change: Callable[[Motion], Motion]
) -> None:
    verdict = both(tmp_path, change(carried()))
    assert verdict.outcome is Outcome.NOT_CERTIFIED
    (diagnosis,) = verdict.diagnoses
    assert "off the motion that was asked for" in diagnosis.reason
    assert diagnosis.evidence is not None
    assert diagnosis.evidence.quantity is Quantity.POSITION
    assert diagnosis.evidence.value > diagnosis.evidence.bound


def test_a_recheck_compares_the_motion_that_was_asked_for(tmp_path: Path) -> None:
    verdict, twin = both(tmp_path, carried()), gantry_twin(tmp_path)
    assert verdict.can_perform is not None
    assert verdict.can_perform.artefact is not None
    certificate = read_certificate(verdict.can_perform.artefact.content)
    assert certificate.asked is not None
    assert recheck_artefact("as it is", certificate.content(), lambda *_: (twin, "given")).holds
    other = replace(certificate, asked=slower(certificate.asked))
    found = recheck_artefact("changed", other.content(), lambda *_: (twin, "given"))
    assert "off the motion that was asked for" in found.reasons[0]


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (lambda asked: replace(asked, of=joint_iri("cell", "drawer")), "no joint named 'drawer'"),
        (lambda asked: replace(asked, times=asked.times[::-1]), "times do not increase"),
        (lambda asked: replace(asked, values=asked.values[1:]), "values of shape"),
        (lambda asked: replace(asked, velocities=None, values=np.zeros((len(asked.times), 7))), "as poses"),
        (
            lambda asked: replace(asked, values=0 * asked.values, velocities=None),
            "0.46 m off the motion that was asked for",
        ),
    ],
    ids=["another joint", "times", "shape", "poses", "stands"],
)
def test_a_certificate_about_what_is_no_motion_does_not_hold(
    tmp_path: Path, edit: Callable[[Motion], Motion], said: str
) -> None:
    verdict, twin = both(tmp_path, carried()), gantry_twin(tmp_path)
    assert verdict.can_perform is not None
    assert verdict.can_perform.artefact is not None
    certificate = read_certificate(verdict.can_perform.artefact.content)
    assert certificate.asked is not None
    wrong = replace(certificate, asked=edit(certificate.asked))
    found = recheck_artefact("changed", wrong.content(), lambda *_: (twin, "given"))
    assert said in "; ".join(found.reasons)
