"""Φ: values and poses agree, generation ends in the goal, every limit is kept or named."""

import math

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from predicates.case import Quantity
from predicates.oracle import Replayed
from predicates.satisfies_request import demanded
from sdt_kg.errors import DisconnectedFrameError, MotionError, OracleRejectedError, UnknownEntityError
from sdt_kg.motion import Motion
from sdt_kg.state import Interval, Region
from sdt_kg.task import Verb
from sdt_kg.twin import Container, Twin
from services.physics.chain import chain
from services.physics.oracle import Kinematics
from services.physics.tree import build
from tests.small import small_twin

PHYSICS = Kinematics()
TWIN = small_twin("a")
NAMES = ("folding_door", "high_drawer", "low_drawer", "side_door")
MODEL = build(TWIN.mechanism(TWIN.environment))


def poses(container: Container, twin: Twin, values: np.ndarray) -> np.ndarray:
    """Handle poses from Pinocchio's own kinematics, shape (T, 7)."""
    rows = []
    for value in values:
        state = twin.at({container.joint: float(value)}).state
        q = np.zeros(MODEL.model.nq)
        for joint, position in state.positions:
            q[MODEL.coordinate[joint]] = position
        data = pin.Data(MODEL.model)
        pin.forwardKinematics(MODEL.model, data, q)
        frame = MODEL.model.getFrameId(container.handle)
        rows.append(pin.SE3ToXYZQUAT(pin.updateFramePlacement(MODEL.model, data, frame)))
    return np.array(rows)


def generated(container: Container, twin: Twin, verb: Verb) -> Motion:
    (motion,) = PHYSICS.generate(twin, demanded(container, verb))
    return motion


def quantities(replayed: Replayed) -> set[Quantity]:
    return {each.evidence.quantity for each in replayed.violations if each.evidence is not None}


@settings(max_examples=80)
@given(st.sampled_from(NAMES), st.sampled_from(Verb), st.floats(0, 1))
def test_what_generation_makes_replay_ends_in_the_goal(name: str, verb: Verb, share: float) -> None:
    container = TWIN.container(name)
    goal = demanded(container, verb)
    twin = TWIN.at({container.joint: share * container.upper})
    if twin.state in goal:
        return
    replayed = PHYSICS.replay(twin, generated(container, twin, verb))
    assert replayed.violations == ()
    assert replayed.final in goal


@settings(max_examples=40)
@given(st.sampled_from(NAMES), st.floats(0, 1), st.floats(0, 1), st.floats(0.5, 8))
def test_values_and_poses_give_the_same_answer(name: str, begin: float, end: float, seconds: float) -> None:
    container = TWIN.container(name)
    twin = TWIN.at({container.joint: begin * container.upper})
    values = container.upper * np.linspace(begin, end, 15)
    times = np.linspace(0, seconds, 15)
    by_values = PHYSICS.replay(twin, Motion(container.joint, times, values[:, None]))
    by_poses = PHYSICS.replay(twin, Motion(container.handle, times, poses(container, twin, values)))
    np.testing.assert_allclose(by_poses.motion.values, by_values.motion.values, atol=1e-9)
    assert by_poses.motion.of == by_values.motion.of == container.joint
    assert dict(by_poses.final) == pytest.approx(dict(by_values.final), abs=1e-9)
    assert quantities(by_poses) == quantities(by_values)


@pytest.mark.parametrize("name", NAMES)
def test_the_chain_is_pinocchios_kinematics(name: str) -> None:
    container = TWIN.container(name)
    twin = TWIN.at({"https://example.org/id/a/joint/side_door_joint": 0.3})
    values = np.linspace(0, container.upper, 7)
    path = chain(MODEL, container.handle, twin.state)
    found, _ = path.poses((values - container.offset) / container.multiplier)
    expected = np.array([pin.XYZQUATToSE3(row).homogeneous for row in poses(container, twin, values)])
    np.testing.assert_allclose(found, expected, atol=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_the_chains_rate_is_its_derivative(name: str) -> None:
    container, a, h = TWIN.container(name), np.array([0.4]), 1e-6
    path = chain(MODEL, container.handle, TWIN.state)
    difference = (path.poses(a + h)[0] - path.poses(a - h)[0]) / (2 * h)
    np.testing.assert_allclose(path.poses(a)[1], difference, atol=1e-8)


def test_a_path_that_leaves_the_hinge_by_3_mm_is_no_motion_of_the_door() -> None:
    door = TWIN.container("side_door")
    path = poses(door, TWIN, (1 - np.cos(np.linspace(0, np.pi, 21))) / 2)
    path[10, 2] += 0.003
    (diagnosis,) = PHYSICS.replay(TWIN, Motion(door.handle, np.linspace(0, 4, 21), path)).violations
    assert diagnosis.evidence is not None
    assert diagnosis.evidence.quantity is Quantity.POSITION
    assert diagnosis.evidence.value == pytest.approx(0.003, abs=1e-6)
    assert diagnosis.evidence.time == pytest.approx(2.0)


def test_a_path_that_turns_the_handle_by_2_degrees_is_no_motion_of_the_drawer() -> None:
    drawer = TWIN.container("low_drawer")
    path = poses(drawer, TWIN, np.linspace(0, 0.3, 21))
    path[5:, 3:] = [0, 0, math.sin(math.radians(1)), math.cos(math.radians(1))]
    assert Quantity.ORIENTATION_ERROR in quantities(
        PHYSICS.replay(TWIN, Motion(drawer.handle, np.linspace(0, 4, 21), path))
    )


def test_noise_within_the_tools_tolerance_is_no_violation_of_the_path() -> None:
    drawer = TWIN.container("low_drawer")
    path = poses(drawer, TWIN, np.linspace(0, 0.3, 7))
    path[:, 1] += [0, 0.001, -0.001, 0.001, 0, 0.001, 0]  # across the slide
    assert PHYSICS.replay(TWIN, Motion(drawer.handle, np.linspace(0, 9, 7), path)).violations == ()


def test_a_motion_past_the_stop_ends_at_the_stop() -> None:
    drawer = TWIN.container("low_drawer")
    motion = Motion(drawer.joint, np.array([0.0, 3.0, 6.0]), np.array([[0.0], [0.3], [0.55]]))
    replayed = PHYSICS.replay(TWIN, motion)
    assert replayed.final[drawer.joint] == 0.5
    assert quantities(replayed) == {Quantity.POSITION}


@pytest.mark.parametrize(("beyond", "kept"), [(5e-6, True), (2e-5, False)])
def test_a_stop_is_as_hard_for_physics_as_for_the_certifier(beyond: float, kept: bool) -> None:
    drawer = TWIN.container("low_drawer")
    values = np.array([[drawer.lower], [drawer.upper + beyond]])
    replayed = PHYSICS.replay(TWIN, Motion(drawer.joint, np.array([0.0, 9.0]), values))
    assert (Quantity.POSITION not in quantities(replayed)) is kept
    if not kept:  # the figures are not both 0.5
        assert "is 0.50002 m (allowed 0.5)" in replayed.violations[0].reason


def test_a_stop_is_not_passed_between_samples_either() -> None:
    drawer = TWIN.container("low_drawer")
    values = np.array([[0.0], [0.49], [0.49], [0.0]])  # the spline swings past 0.5 in the middle
    replayed = PHYSICS.replay(TWIN, Motion(drawer.joint, np.array([0.0, 4.0, 8.0, 12.0]), values))
    assert quantities(replayed) == {Quantity.POSITION}


def test_the_folding_doors_speed_is_bounded_by_the_panel_that_carries_it() -> None:
    door = TWIN.container("folding_door")  # own limit 3 rad/s; the upper panel's 1 rad/s doubles to 2
    values = np.array([[0.0], [1.0], [2.0]])
    replayed = PHYSICS.replay(TWIN, Motion(door.joint, np.array([0.0, 0.5, 1.0]), values))
    bounds = {e.evidence.bound for e in replayed.violations if e.evidence and e.evidence.unit == "rad/s"}
    assert bounds == {2.0}


def test_a_motion_with_velocities_must_begin_and_end_at_rest() -> None:
    drawer = TWIN.container("low_drawer")
    motion = Motion(
        drawer.joint, np.array([0.0, 1.0]), np.array([[0.0], [0.3]]), velocities=np.array([[0.3], [0.3]])
    )
    reasons = [each.reason for each in PHYSICS.replay(TWIN, motion).violations]
    assert reasons == [
        "low_drawer_joint begins at 0.3 m/s, not at rest",
        "low_drawer_joint ends at 0.3 m/s, not at rest",
    ]


def test_a_frame_that_nothing_moves_is_an_error() -> None:
    path = np.tile([0.0, 0, 0, 0, 0, 0, 1], (2, 1))
    with pytest.raises(DisconnectedFrameError, match="no joint moves 'wall'"):
        PHYSICS.replay(TWIN, Motion(f"{TWIN.environment}/body/wall", np.array([0.0, 1.0]), path))


def test_a_fixed_joint_is_an_error() -> None:
    with pytest.raises(DisconnectedFrameError, match="'wall_joint' is fixed"):
        PHYSICS.replay(
            TWIN, Motion(f"{TWIN.environment}/joint/wall_joint", np.array([0.0, 1.0]), np.zeros((2, 1)))
        )


@pytest.mark.parametrize("timed", [True, False])
def test_that_proposed_times_are_too_short_proves_nothing(timed: bool) -> None:
    container = TWIN.container("side_door")
    share = np.linspace(0.0, 1.0, 9)[:, None]
    hasty = Motion(container.joint, 0.1 * share[:, 0], container.upper * share, timed, 0.0 * share + 0.1)
    found = PHYSICS.replay(TWIN, hasty).violations
    proved = {each.evidence.quantity: each.proof for each in found if each.evidence is not None}
    assert proved == {Quantity.VELOCITY: timed, Quantity.ACCELERATION: timed}
    beyond = Motion(container.joint, 100 * share[:, 0], 2 * container.upper * share, timed)
    (where,) = {each.proof for each in PHYSICS.replay(TWIN, beyond).violations}
    assert where


def test_an_unknown_joint_names_the_nearest() -> None:
    with pytest.raises(UnknownEntityError, match="did you mean 'low_drawer_joint'"):
        PHYSICS.replay(
            TWIN, Motion(f"{TWIN.environment}/joint/lowdrawer_joint", np.array([0.0, 1.0]), np.zeros((2, 1)))
        )


@pytest.mark.parametrize(
    ("times", "values", "message"),
    [
        ([0.0, 1.0], [[0.0], [math.nan]], "'values' of sample 1 is nan"),
        ([0.0, 0.0], [[0.0], [0.1]], "do not increase after sample 0"),
        ([0.0], [[0.0]], "1 samples"),
        ([0.0, 1.0], [[0.0, 0.1], [0.1, 0.2]], "shape"),
        ([0.0, 1.0], [[0, 0, 0, 0, 0, 0, 2.0]] * 2, "norm 2"),
    ],
)
def test_what_is_no_motion_is_an_error(times: list[float], values: list[list[float]], message: str) -> None:
    drawer = TWIN.container("low_drawer")
    of = drawer.handle if len(values[0]) == 7 else drawer.joint
    with pytest.raises(MotionError, match=message):
        PHYSICS.replay(TWIN, Motion(of, np.array(times), np.array(values)))


def test_a_goal_beyond_the_limits_is_rejected() -> None:
    goal = Region(((TWIN.container("low_drawer").joint, Interval(0.6, 0.7)),))
    with pytest.raises(OracleRejectedError):
        list(PHYSICS.generate(TWIN, goal))
