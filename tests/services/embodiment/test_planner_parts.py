"""Parts of the planner against what they stand for: coal, Pinocchio, the limits."""

from collections import Counter

import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray

from predicates.case import Quantity
from sdt_kg.load import load_twin
from services.embodiment.body import ik
from services.embodiment.body.demands import Margins, rules
from services.embodiment.body.limb import Limb, make_limb
from services.embodiment.body.track import Base, track
from services.embodiment.body.world import World
from services.embodiment.hold.handle import Bar, Mechanics, find_bar
from services.embodiment.hold.sets import PITCHES, grasp_set
from services.embodiment.prove.heights import span
from services.embodiment.search.report import in_the_way
from services.physics.model import Scene

pytestmark = pytest.mark.oracle
Array = NDArray[np.float64]


@pytest.fixture(scope="module", params=["pr2", "tiago_dual", "stretch"])
def limb_world(request: pytest.FixtureRequest) -> tuple[World, Limb]:
    twin = load_twin("b", [request.param])
    world = World(Scene(twin, twin.robots[0]))
    return world, make_limb(world, world.scene.annotation.grippers[0])


def draw(limb: Limb, count: int, seed: int) -> np.ndarray:
    low = np.where(np.isfinite(limb.lower), limb.lower, -3.0)
    high = np.where(np.isfinite(limb.upper), limb.upper, 3.0)
    return np.random.default_rng(seed).uniform(low, high, (count, len(low)))


def test_frames_are_those_of_pinocchio(limb_world: tuple[World, Limb]) -> None:
    world, limb = limb_world
    data = pin.Data(world.scene.model)
    for x in draw(limb, 20, 0):
        q = limb.q(x)
        r, p = world.frames(q)
        pin.forwardKinematics(world.scene.model, data, q)
        for j in range(1, world.scene.model.njoints):
            np.testing.assert_allclose(r[j], data.oMi[j].rotation, atol=1e-12)
            np.testing.assert_allclose(p[j], data.oMi[j].translation, atol=1e-12)
        tool = world.scene.placement(q, world.scene.tool_frame(limb.gripper.name))
        np.testing.assert_allclose(limb.tool(x)[1], tool.translation, atol=1e-12)


def test_what_was_most_often_in_the_way_is_told_with_how_often_that_was(
    limb_world: tuple[World, Limb],
) -> None:
    world, _ = limb_world
    last, first = len(world.body) - 1, next(k for k, one in enumerate(world.body) if one != world.body[0])
    found = in_the_way(world, Counter({(0, last): 3, (first, last): 5}))
    assert found is not None
    assert (found.quantity, found.value, found.bound) == (Quantity.COUNT, 5.0, 0.0)
    assert found.links == (world.body[first], world.body[last])
    assert in_the_way(world, Counter()) is None


def keep_margins(world: World, pairs: NDArray[np.int64], margins: Array, r: Array, p: Array) -> None:
    """Coal is asked about those pairs whose balls are nearer than that."""
    centres = np.array([r[one.joint] @ one.centre + p[one.joint] for one in world.scene.solids])
    radii = np.array([one.radius for one in world.scene.solids])
    a, b = pairs.T
    apart = np.linalg.norm(centres[a] - centres[b], axis=1) - radii[a] - radii[b]
    near = np.flatnonzero(apart < margins)
    assert len(near)
    for k in near:
        assert world.distance((int(a[k]), int(b[k])), r, p) >= margins[k] - 1e-9


def test_free_means_that_every_pair_keeps_its_margin(limb_world: tuple[World, Limb]) -> None:
    world, limb = limb_world
    demands = rules(world, limb, Margins())
    found = {True: 0, False: 0}
    for x in draw(limb, 10, 1):
        q = limb.q(x)
        r, p = world.frames(q)
        contact = world.contact(q[None], demands)
        found[contact is None] += 1
        if contact is not None:
            a, b = contact.shapes
            assert world.distance((a, b), r, p) < Margins().free + world.scene.annotation.overhang + 1e-5
            continue
        keep_margins(world, demands.pairs, demands.own, r, p)
        k, e = np.nonzero(demands.environment >= 0)
        keep_margins(world, np.stack((world.split + k, e), axis=1), demands.environment[k, e], r, p)
    assert found[True]
    assert found[False]


def test_a_path_is_free_exactly_where_each_of_its_configurations_is(limb_world: tuple[World, Limb]) -> None:
    world, limb = limb_world
    demands = rules(world, limb, Margins())
    rng, found = np.random.default_rng(7), {True: 0, False: 0}
    for start in draw(limb, 24, 4):
        start[:3] = rng.uniform((-1.5, -1.5, -3), (1.0, 1.5, 3))
        end = start + rng.uniform(-0.6, 0.6, len(start))
        qs = limb.q(np.linspace(start, end, 40))
        contact = world.contact(qs, demands)
        alone = [world.contact(q[None], demands) for q in qs]
        assert (contact is None) == all(one is None for one in alone)
        if contact is not None:
            assert alone[contact.index] is not None
        found[contact is None] += 1
    assert found[True]
    assert found[False]


def test_postures_that_are_looked_at_together_touch_what_each_does_alone(
    limb_world: tuple[World, Limb],
) -> None:
    world, limb = limb_world
    demands = rules(world, limb, Margins())
    xs = draw(limb, 40, 9)
    xs[:, :3] = np.random.default_rng(9).uniform((-1.5, -1.5, -3), (1.0, 1.5, 3), (len(xs), 3))
    qs = limb.q(xs)
    qs[::2, : world.scene.base[0]] += 0.1  # the kitchen moves, too
    alone = [world.contact(q[None], demands) for q in qs]
    assert world.contact_each(qs, demands) == [one and one.shapes for one in alone]
    assert 0 < sum(one is None for one in alone) < len(qs)


def test_a_reachable_pose_is_reached_from_a_near_seed(limb_world: tuple[World, Limb]) -> None:
    _, limb = limb_world
    goals = draw(limb, 50, 2)
    poses = [limb.tool(x) for x in goals]
    seeds = np.clip(goals + 0.05, limb.lower, limb.upper)
    target_r, target_p = np.stack([r for r, _ in poses]), np.stack([p for _, p in poses])
    weight = np.ones(len(limb.lower))
    met = ik.solve_many(seeds, target_r, target_p, limb.chain, weight, limb.lower, limb.upper, 60, 1e-7)
    assert met.mean() > 0.9
    for x, r, p in zip(seeds[met], target_r[met], target_p[met], strict=True):
        np.testing.assert_allclose(limb.tool(x)[0], r, atol=1e-6)
        np.testing.assert_allclose(limb.tool(x)[1], p, atol=1e-6)
        assert (x >= limb.lower).all()
        assert (x <= limb.upper).all()


def test_a_base_that_drives_straight_on_keeps_its_line(limb_world: tuple[World, Limb]) -> None:
    _, limb = limb_world
    x = (np.clip(limb.lower, -1, 1) + np.clip(limb.upper, -1, 1)) / 2
    x[:3] = 0.3, -0.2, 0.7
    r, p = limb.tool(x)
    heading = np.array([np.cos(0.7), np.sin(0.7), 0.0])
    target = np.repeat(r[None], 11, axis=0), p + np.linspace(0, 0.3, 11)[:, None] * heading
    path = track(limb, x, target, Base.STRAIGHT, (limb.lower, limb.upper))
    assert path is not None
    side = -np.sin(0.7) * (path[:, 0] - 0.3) + np.cos(0.7) * (path[:, 1] + 0.2)
    assert np.abs(side).max() < 1e-12
    np.testing.assert_allclose(limb.tool(path[-1])[1], target[1][-1], atol=1e-6)


def test_no_finger_is_ever_outside_its_bound_of_height(limb_world: tuple[World, Limb]) -> None:
    world, limb = limb_world
    low, high = span(world, limb)
    joint, _, centre = world.boxes
    for x in draw(limb, 300, 3):
        r, p = world.frames(limb.q(x))
        for k in world.shapes_of(limb.fingers):
            height = r[joint[k], 2] @ centre[k] + p[joint[k], 2]
            assert low <= height <= high


def test_the_bar_of_a_handle_is_found_with_its_axis_and_thickness() -> None:
    twin = load_twin("b", ["stretch"])
    world = World(Scene(twin, twin.robots[0]))
    mechanics = Mechanics(world, twin.container("sink_area_left_middle_drawer_main"))
    bar = find_bar(world, mechanics, world.scene.q((0.0, 0.0, 0.0), {}))
    assert bar is not None
    assert bar.length == pytest.approx(0.706, abs=0.01)
    assert bar.depth == pytest.approx(0.016, abs=0.002)
    assert bar.width == pytest.approx(0.016, abs=0.002)
    np.testing.assert_allclose(np.abs(bar.along), [0, 1, 0], atol=1e-3)
    np.testing.assert_allclose(bar.outward, [1, 0, 0], atol=1e-3)


def test_steep_grasps_are_the_same_set_with_those_from_far_above_and_below_first() -> None:
    x, y, z = np.eye(3)
    bar = Bar(0, np.zeros(3), y, x, 0.2, 0.01, 0.01)
    straight, steep = list(grasp_set(bar)), list(grasp_set(bar, steep=True))
    by_number = {one.index: one for one in straight}
    assert len(by_number) == len(straight) == len(steep) == len({one.index for one in steep})
    for one in steep:
        np.testing.assert_array_equal(one.rotation, by_number[one.index].rotation)
        np.testing.assert_array_equal(one.translation, by_number[one.index].translation)
    np.testing.assert_allclose(straight[0].rotation[:, 0], -x)
    assert abs(steep[0].rotation[:, 0] @ z) == pytest.approx(np.sin(np.abs(PITCHES).max()))
