"""A differential base that drives and turns while the tool follows: exact arcs, tool error, limits."""

import numpy as np
import pytest

from predicates.case import Case
from sdt_kg.annotation import Drive
from sdt_kg.load import load_twin
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.state import Interval, Region
from sdt_kg.task import Task, Verb
from services.embodiment.body import ik
from services.embodiment.body.limb import BASE, Limb, make_limb
from services.embodiment.body.rolling import EXACT, LONGEST, arc, arc_jacobian, roll, telescope
from services.embodiment.body.track import Base, bases, mobility, track
from services.embodiment.body.world import World
from services.embodiment.certify.check import Certified, certify
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.oracle import WholeBody
from services.physics.model import Scene
from services.physics.oracle import Kinematics

pytestmark = pytest.mark.oracle

Array = np.ndarray
WAYPOINTS = 40


@pytest.fixture(scope="module", params=["pr2", "tiago_dual", "stretch"])
def limb(request: pytest.FixtureRequest) -> Limb:
    twin = load_twin("b", [request.param])
    world = World(Scene(twin, twin.robots[0]))
    return make_limb(world, world.scene.annotation.grippers[0])


@pytest.fixture(scope="module")
def stretch() -> Limb:
    twin = load_twin("b", ["stretch"])
    world = World(Scene(twin, twin.robots[0]))
    return make_limb(world, world.scene.annotation.grippers[0])


def middle(limb: Limb) -> Array:
    """A posture well inside the limits, the base anywhere."""
    low = np.where(np.isfinite(limb.lower), limb.lower, -1.0)
    high = np.where(np.isfinite(limb.upper), limb.upper, 1.0)
    x = low + 0.45 * (high - low)
    x[BASE] = 0.4, -0.3, 0.7
    return x


def driven_arc(limb: Limb, length: float, turn: float) -> tuple[Array, tuple[Array, Array]]:
    """Tool poses that a base makes which drives an arc, the arm still: followable by construction."""
    x = middle(limb)
    poses = []
    for share in np.linspace(0, 1, WAYPOINTS):
        there = x.copy()
        there[BASE] = arc(x[BASE], share * length, share * turn)
        poses.append(limb.tool(there))
    return x, (np.stack([r for r, _ in poses]), np.stack([p for _, p in poses]))


def tool_errors(limb: Limb, path: Array, target: tuple[Array, Array]) -> Array:
    out = np.empty((len(path), 6))
    for k, x in enumerate(path):
        r, p = limb.tool(x)
        ik.pose_error(r, p, target[0][k], target[1][k], out[k])
    out[:, 3:] *= ik.ARM
    return np.linalg.norm(out, axis=1)


def slips(before: Array, after: Array) -> float:
    """How far a base pose is from the arc that begins along the heading of the one before [m]."""
    half = (after[2] - before[2]) / 2
    along = before[2] + half
    way = after[:2] - before[:2]
    return float(abs(-np.sin(along) * way[0] + np.cos(along) * way[1]))


@pytest.mark.parametrize("turn", [0.0, 1e-5, -0.3, 1.4])
def test_an_arc_is_what_many_small_steps_along_the_heading_add_up_to(turn: float) -> None:
    pose, count = np.array([0.3, -1.0, 2.0]), 20_000
    heading = pose[2] + turn * (np.arange(count) + 0.5) / count
    steps = 0.7 / count * np.stack([np.cos(heading), np.sin(heading)])
    np.testing.assert_allclose(arc(pose, 0.7, turn)[:2], pose[:2] + steps.sum(axis=1), atol=1e-9)
    assert arc(pose, 0.7, turn)[2] == pose[2] + turn


@pytest.mark.parametrize("turn", [0.0, 2e-5, -0.3, 1.4])
def test_the_derivative_of_an_arc_is_its_difference_quotient(turn: float) -> None:
    pose, h = np.array([0.3, -1.0, 2.0]), 1e-6
    by_way = (arc(pose, 0.7 + h, turn) - arc(pose, 0.7 - h, turn)) / (2 * h)
    by_turn = (arc(pose, 0.7, turn + h) - arc(pose, 0.7, turn - h)) / (2 * h)
    np.testing.assert_allclose(arc_jacobian(pose, 0.7, turn), np.stack([by_way, by_turn], 1), atol=1e-8)


@pytest.mark.parametrize(("length", "turn"), [(0.4, 0.6), (-0.4, 0.6), (0.3, 0.0)])
def test_the_tool_stays_on_its_way_and_the_base_never_slips(limb: Limb, length: float, turn: float) -> None:
    x, target = driven_arc(limb, length, turn)
    path = roll(limb, x, target, mobility(limb), (limb.lower, limb.upper))
    assert path is not None
    assert tool_errors(limb, path, target).max() < EXACT
    before = np.vstack([x[None], path[:-1]])
    assert max(slips(a[BASE], b[BASE]) for a, b in zip(before, path, strict=True)) < 1e-12
    assert (path[:, 3:] >= limb.lower[3:]).all()
    assert (path[:, 3:] <= limb.upper[3:]).all()
    steps = np.abs(np.diff(path[:, 3:], axis=0))
    assert (steps <= LONGEST * limb.velocity[3:] + 1e-9).all()


def test_the_base_takes_over_where_the_arm_is_held(stretch: Limb) -> None:
    x, target = driven_arc(stretch, 0.5, 0.8)
    lower, upper = stretch.lower.copy(), stretch.upper.copy()
    lower[3:], upper[3:] = x[3:] - 1e-3, x[3:] + 1e-3
    path = roll(stretch, x, target, mobility(stretch), (lower, upper))
    assert path is not None
    assert np.abs(path[:, 3:] - x[3:]).max() <= 1e-3
    np.testing.assert_allclose(path[-1, BASE], arc(x[BASE], 0.5, 0.8), atol=5e-3)


def test_a_way_out_of_reach_is_none(stretch: Limb) -> None:
    x, (r, p) = driven_arc(stretch, 0.5, 0.8)
    p = p + np.linspace(0, 2, WAYPOINTS)[:, None] * np.array([0.0, 0.0, 1.0])
    assert roll(stretch, x, (r, p), mobility(stretch), (stretch.lower, stretch.upper)) is None


def test_turning_follows_where_driving_straight_cannot(stretch: Limb) -> None:
    x, target = driven_arc(stretch, 0.6, 1.2)
    lower, upper = stretch.lower.copy(), stretch.upper.copy()
    lower[3:], upper[3:] = x[3:] - 0.05, x[3:] + 0.05
    limits = lower, upper
    for base in (Base.STANDS, Base.STRAIGHT):
        assert track(stretch, x, target, base, limits) is None
    assert track(stretch, x, target, Base.ROLLS, limits) is not None


def test_only_a_differential_base_on_a_turning_way_rolls() -> None:
    assert Base.ROLLS in bases(Drive.DIFFERENTIAL, turning=True)
    assert Base.ROLLS not in bases(Drive.DIFFERENTIAL, turning=False)
    assert Base.ROLLS not in bases(Drive.OMNI, turning=True)
    assert Base.ROLLS not in bases(Drive.FIXED, turning=True)


def test_the_telescope_of_stretch_points_to_its_right(stretch: Limb) -> None:
    angle = telescope(stretch)
    assert angle is not None
    assert angle == pytest.approx(-np.pi / 2, abs=0.05)
    twin = load_twin("b", ["tiago_dual"])
    world = World(Scene(twin, twin.robots[0]))
    assert telescope(make_limb(world, world.scene.annotation.grippers[0])) is None


def certified(robot: str, name: str) -> tuple[BodyMotion, Certified]:
    """The robot's motion on its real wheels and its certificate."""
    twin = load_twin("b", [robot])
    container = twin.container(name)
    goal = Interval(container.open_from, container.upper)
    motion = next(Kinematics().generate(twin, Region(((container.joint, goal),))))
    assert isinstance(motion, Motion)
    case = Case(twin, twin.robots[0], Task(Verb.OPEN, container.iri), motion)
    answer = WholeBody(drive=Drive.DIFFERENTIAL).perform(case)
    assert answer.holds, [diagnosis.reason for diagnosis in answer.diagnoses]
    body = answer.case.body_motion
    assert isinstance(body, BodyMotion)
    found = certify(twin, twin.robots[0], body, container, Tolerances(), drive=Drive.DIFFERENTIAL)
    assert isinstance(found, Certified)
    return body, found


@pytest.mark.parametrize("name", ["sink_area_left_middle_drawer_main", "iai_fridge_door"])
def test_stretch_opens_a_drawer_and_a_door_on_its_real_wheels(name: str) -> None:
    body, _ = certified("stretch", name)
    assert body.kitchen_q[-1, 0] > body.kitchen_q[0, 0]


@pytest.mark.parametrize("robot", ["tiago_dual", "stretch"])
def test_a_door_opened_while_the_base_drives_and_turns_is_certified(
    robot: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("services.embodiment.hold.holding.bases", lambda drive, turning: (Base.ROLLS,))
    # Many postures would follow with straight ways.
    monkeypatch.setattr("services.embodiment.search.plan.ALONE", 0)
    body, found = certified(robot, "iai_fridge_door")
    follow = body.base[dict(body.phases)["follow"] :]
    assert np.ptp(follow[:, 2]) > 0.01
    assert found.figures["sideways velocity"][0] < Tolerances().sideways / 10
