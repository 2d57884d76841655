"""Following 50 tool poses of a door's handle: ours beside pink and mink, the same problems in one run.

Each problem is a posture of the PR2 that holds the handle of a fridge door at its first pose, found by
inverse kinematics from a random seed; solved is a path on which the tool comes to all poses within the
joint limits, and no variable jumps between two of them. The peers run as in their examples,
differential inverse kinematics with a frame task and the limits of configurations, again and again
until a pose is met, to a hundredth of our exactness. No assertions on time: `extra_info` has what each
solved.
"""

from collections.abc import Callable
from dataclasses import dataclass

import mujoco
import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray
from pytest_benchmark.fixture import BenchmarkFixture

from sdt_kg.load import load_twin
from services.embodiment.body import ik
from services.embodiment.body.limb import Limb, make_limb
from services.embodiment.body.track import EXACT, JUMP, Base, mobility, track
from services.embodiment.body.world import World
from services.embodiment.hold.handle import Mechanics, find_bar
from services.physics.model import Scene

mink = pytest.importorskip("mink")
pink = pytest.importorskip("pink")

pytestmark = pytest.mark.oracle

Array = NDArray[np.float64]
Follow = Callable[["Problem"], bool]

DOOR = "iai_fridge_door"
POSES = 50
SEEDS = 96
PROBLEMS = 16
AWAY = 0.75  # [m] from handle to base, of seeds
TRIES = 30  # programs for one pose
MET = 1e-5  # [m, and rad · ik.ARM] tool error that counts as met by the peers
FAR = 100.0  # [m or rad] a limit for what has none
SOLVER = "daqp"


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """Tool poses (POSES, 3, 3), (POSES, 3), and variables x (n,) with the tool at the first."""

    limb: Limb
    rotation: Array
    translation: Array
    x: Array
    base: Base


def problems(base: Base) -> list[Problem]:
    twin = load_twin("b", ["pr2"])
    world = World(Scene(twin, twin.robots[0]))
    limb = make_limb(world, world.scene.annotation.grippers[0])
    mechanics = Mechanics(world, twin.container(DOOR))
    q = limb.q(limb.parked)
    bar = find_bar(world, mechanics, q)
    assert bar is not None
    values = np.linspace(0.0, twin.container(DOOR).open_from, POSES)
    handle_r, handle_p = mechanics.handle_poses(q, bar.joint, values)
    grasp = np.stack([-bar.outward, np.cross(bar.along, -bar.outward), bar.along], axis=1)
    rotation, translation = handle_r @ grasp, handle_r @ bar.centre + handle_p
    rng = np.random.default_rng(0)
    low, high = (np.clip(end, -np.pi, np.pi) for end in (limb.lower, limb.upper))
    seeds = rng.uniform(low, high, (SEEDS, len(low)))
    out = handle_r[0] @ bar.outward
    side = np.arctan2(out[1], out[0]) + rng.uniform(-1.0, 1.0, SEEDS)
    seeds[:, 0] = translation[0, 0] + AWAY * np.cos(side)
    seeds[:, 1] = translation[0, 1] + AWAY * np.sin(side)
    seeds[:, 2] = side + np.pi
    first = np.repeat(rotation[:1], SEEDS, axis=0), np.repeat(translation[:1], SEEDS, axis=0)
    met = ik.solve_many(seeds, *first, limb.chain, mobility(limb), limb.lower, limb.upper, 60, EXACT)
    assert met.sum() >= PROBLEMS
    return [Problem(limb, rotation, translation, x, base) for x in seeds[met][:PROBLEMS]]


def ours(problem: Problem) -> Follow:
    limits = problem.limb.lower, problem.limb.upper
    target = problem.rotation, problem.translation
    return lambda one: track(one.limb, one.x, target, one.base, limits) is not None


def joints(problem: Problem) -> list[tuple[pin.SE3, Array, bool, float, float]]:
    """Placement, axis, whether it turns, and limits of each joint from the world to the tool.

    A base that stands is part of the first placement.
    """
    place_r, place_p, axis, kind, variable, share, offset, _, _ = problem.limb.chain
    assert (variable == np.arange(len(variable))).all()
    assert (share == 1).all()
    assert (offset == 0).all()
    found, before = [], pin.SE3.Identity()
    for k in range(len(kind)):
        placed = before * pin.SE3(place_r[k], place_p[k])
        before = pin.SE3.Identity()
        turns = kind[k] == ik.REVOLUTE
        if k < 3 and problem.base is Base.STANDS:
            moved = axis[k] * problem.x[k]
            before = placed * (pin.SE3(pin.exp3(moved), np.zeros(3)) if turns else pin.SE3(np.eye(3), moved))
            continue
        ends = (float(np.clip(end[k], -FAR, FAR)) for end in (problem.limb.lower, problem.limb.upper))
        found.append((placed, axis[k], bool(turns), *ends))
    return found


def posture(problem: Problem) -> Array:
    return problem.x[3:] if problem.base is Base.STANDS else problem.x


def error(problem: Problem, k: int, rotation: Array, translation: Array) -> float:
    out = np.empty(6)
    ik.pose_error(rotation, translation, problem.rotation[k], problem.translation[k], out)
    out[3:] *= ik.ARM
    return float(np.linalg.norm(out))


@dataclass(frozen=True, slots=True, eq=False)
class Peer:
    """One pose after the other: take aim at pose k, the tool's pose and the variables now, one program."""

    aim: Callable[[int], None]
    at: Callable[[], tuple[Array, Array]]
    now: Callable[[], Array]
    step: Callable[[], None]

    def follows(self, problem: Problem) -> bool:
        last = self.now().copy()
        for k in range(POSES):
            self.aim(k)
            if not self._meets(problem, k) or (k > 0 and np.abs(self.now() - last).max() > JUMP):
                return False
            last = self.now().copy()
        return True

    def _meets(self, problem: Problem, k: int) -> bool:
        for _ in range(TRIES):
            if error(problem, k, *self.at()) < MET:
                return True
            try:
                self.step()
            except (pink.exceptions.PinkError, mink.MinkError):
                return False
        return False


def by_pink(problem: Problem) -> Follow:
    model, parent = pin.Model(), 0
    for placed, axis, turns, low, high in joints(problem):
        joint = (pin.JointModelRevoluteUnaligned if turns else pin.JointModelPrismaticUnaligned)(axis)
        limits = np.array([FAR]), np.array([FAR]), np.array([low]), np.array([high])
        parent = model.addJoint(parent, joint, placed, f"joint{parent}", *limits)
    end = pin.SE3(problem.limb.chain[7], problem.limb.chain[8])
    model.addFrame(pin.Frame("tool", parent, end, pin.OP_FRAME))
    limits = (pink.limits.ConfigurationLimit(model),)
    task = pink.tasks.FrameTask("tool", position_cost=1.0, orientation_cost=ik.ARM)

    def peer(one: Problem) -> Peer:
        configuration = pink.Configuration(model, model.createData(), posture(one))

        def at() -> tuple[Array, Array]:
            pose = configuration.get_transform_frame_to_world("tool")
            return pose.rotation, pose.translation

        def step() -> None:
            v = pink.solve_ik(configuration, (task,), 1.0, solver=SOLVER, limits=limits)
            configuration.integrate_inplace(v, 1.0)

        def aim(k: int) -> None:
            task.set_target(pin.SE3(one.rotation[k], one.translation[k]))

        return Peer(aim, at, lambda: configuration.q, step)

    return lambda one: peer(one).follows(one)


def for_mujoco(problem: Problem) -> mujoco.MjModel:
    def place(tag: str, at: pin.SE3, rest: str) -> str:
        x, y, z, w = pin.Quaternion(at.rotation).coeffs()
        p = at.translation
        return f'<{tag} pos="{p[0]!s} {p[1]!s} {p[2]!s}" quat="{w!s} {x!s} {y!s} {z!s}"{rest}'

    inner, count = place("site", pin.SE3(problem.limb.chain[7], problem.limb.chain[8]), ' name="tool"/>'), 0
    for placed, axis, turns, low, high in reversed(joints(problem)):
        kind, along = ("hinge" if turns else "slide"), " ".join(map(str, axis))
        joint = f'<joint type="{kind}" axis="{along}" range="{low} {high}" name="joint{count}"/>'
        mass = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
        inner, count = place("body", placed, f">{joint}{mass}{inner}</body>"), count + 1
    text = f'<mujoco><compiler angle="radian"/><worldbody>{inner}</worldbody></mujoco>'
    return mujoco.MjModel.from_xml_string(text)


def by_mink(problem: Problem) -> Follow:
    model = for_mujoco(problem)
    limits = [mink.ConfigurationLimit(model)]
    task = mink.FrameTask("tool", "site", position_cost=1.0, orientation_cost=ik.ARM)

    def peer(one: Problem) -> Peer:
        configuration = mink.Configuration(model, q=posture(one))

        def at() -> tuple[Array, Array]:
            pose = configuration.get_transform_frame_to_world("tool", "site")
            return pose.rotation().as_matrix(), pose.translation()

        def step() -> None:
            v = mink.solve_ik(configuration, [task], 1.0, SOLVER, limits=limits)
            configuration.integrate_inplace(v, 1.0)

        def aim(k: int) -> None:
            goal = mink.SO3.from_matrix(one.rotation[k])
            task.set_target(mink.SE3.from_rotation_and_translation(goal, one.translation[k]))

        return Peer(aim, at, lambda: configuration.q, step)

    return lambda one: peer(one).follows(one)


@pytest.mark.parametrize("base", [Base.STANDS, Base.FREE])
@pytest.mark.parametrize("make", [ours, by_pink, by_mink])
def test_following_a_door(make: Callable[[Problem], Follow], base: Base, benchmark: BenchmarkFixture) -> None:
    asked = problems(base)
    followers = [make(problem) for problem in asked]  # models are built before the clock runs
    solved = benchmark.pedantic(
        lambda: [follow(problem) for follow, problem in zip(followers, asked, strict=True)],
        rounds=3,
        warmup_rounds=1,
    )
    benchmark.extra_info["solved"] = f"{sum(solved)} of {len(solved)}"
    assert sum(solved) > 0
