"""Depths and the places of handles, as a descent is led by them: against coal, and by finite differences."""

from collections.abc import Callable
from itertools import combinations

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sdt_kg.load import load_twin
from services.embodiment.body.demands import Margins
from services.embodiment.body.limb import Limb
from services.embodiment.body.world import World
from services.embodiment.descent import placed, witness
from services.embodiment.descent.depths import Depths, make_depths
from services.embodiment.descent.pinch import Face, Pads, Room, face, grips, led
from services.embodiment.descent.solver import Bounds, Solver
from services.embodiment.hold.handle import Mechanics, find_bar
from services.embodiment.hold.kit import Kits
from services.embodiment.hold.parts import parts
from services.physics.geometry.gap import gap
from services.physics.geometry.packed import pack
from services.physics.geometry.shapes import Triangles, hull_of_solid
from services.physics.model import Scene

pytestmark = pytest.mark.oracle
Array = NDArray[np.float64]

CHANGE = 1e-6  # [rad or m] of a finite difference
ALIKE = 1e-4  # [1] of a derivative
DRAWER = "sink_area_left_middle_drawer_main"


def solids() -> list[coal.CollisionGeometry]:
    points = np.random.default_rng(0).normal(size=(60, 3)) * 0.1
    found = [
        coal.Box(0.1, 0.2, 0.3),
        coal.Cylinder(0.05, 0.2),
        coal.Capsule(0.05, 0.2),
        hull_of_solid(points),
    ]
    for one in found:
        one.computeLocalAABB()
    return found


def middle(shape: coal.CollisionGeometry) -> Array:
    return (shape.aabb_local.min_ + shape.aabb_local.max_) / 2


@pytest.mark.parametrize(("one", "other"), [*combinations(range(4), 2), (0, 0), (1, 1), (3, 3)])
def test_distances_and_depths_are_those_of_coal_and_so_is_their_direction(one: int, other: int) -> None:
    rng, shapes = np.random.default_rng(one + 10 * other), solids()
    packed, out, room = pack(shapes), np.zeros(12), witness.room()
    signs = set[bool]()
    for _ in range(100):
        a, b = Rotation.random(2, rng).as_matrix()
        p, q = rng.normal(size=(2, 3)) * 0.08
        at = a, p + a @ middle(shapes[one]), b, q + b @ middle(shapes[other])
        found = witness.signed(packed, one, other, *at, np.inf, out, room)
        told, way = gap(shapes[one], coal.Transform3s(a, p), shapes[other], coal.Transform3s(b, q))
        assert found == pytest.approx(told, abs=5e-6)
        if abs(told) > 1e-3:
            np.testing.assert_allclose(out[:3], -way, atol=0.02)
        signs.add(told > 0)
    assert signs == {True, False}


def test_a_ball_is_as_deep_in_a_mesh_as_beyond_its_nearest_triangle() -> None:
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    shapes = [coal.Sphere(0.2), Triangles(corners, np.array([[0, 1, 2], [1, 3, 2]]))]
    for one in shapes:
        one.computeLocalAABB()
    out, still = np.zeros(12), np.eye(3)
    for height in (0.3, 0.15):
        at = still, np.array([0.3, 0.2, height]), still, middle(shapes[1])
        found = witness.signed(pack(shapes), 0, 1, *at, np.inf, out, witness.room())
        assert found == pytest.approx(height - 0.2, abs=1e-9)
        np.testing.assert_allclose(out[:9], [0, 0, 1, 0.3, 0.2, height, 0.3, 0.2, 0], atol=1e-9)


def test_what_is_seen_to_be_far_is_not_looked_at() -> None:
    shapes, out = solids(), np.zeros(12)
    at = np.eye(3), np.zeros(3), np.eye(3), np.array([1.0, 0, 0])
    assert witness.signed(pack(shapes), 0, 1, *at, 0.1, out, witness.room()) == np.inf
    assert witness.signed(pack(shapes), 0, 1, *at, 1.0, out, witness.room()) == pytest.approx(0.9)


@pytest.fixture(scope="module", params=["pr2", "tiago_dual", "stretch"])
def depths(request: pytest.FixtureRequest) -> Depths:
    twin = load_twin("b", [request.param])
    world = World(Scene(twin, twin.robots[0]))
    kit = Kits(world, Margins()).of(world.scene.annotation.grippers[0])
    mechanics = Mechanics(world, twin.container(DRAWER))
    return make_depths(world, kit.limb, kit.hand, mechanics, np.zeros(3))


def drawn(limb: Limb, count: int) -> Array:
    low = np.where(np.isfinite(limb.lower), limb.lower, -3.0)
    high = np.where(np.isfinite(limb.upper), limb.upper, 3.0)
    xs = np.random.default_rng(3).uniform(low, high, (count, len(low)))
    xs[:, :3] = 0.3, 0.2, 0.1
    return xs


def differences(residual: Callable[[Array], Array], x: Array, size: int) -> Array:
    """Of a residual, shape (N, n), the base left out; not a number where its length differs."""
    found = np.zeros((size, len(x)))
    for k in range(3, len(x)):
        ends = [residual(x + way * CHANGE * np.eye(len(x))[k]) for way in (1, -1)]
        alike = all(len(one) == size for one in ends)
        found[:, k] = (ends[0] - ends[1]) / (2 * CHANGE) if alike else np.nan
    return found


def test_depths_change_as_their_derivatives_say(depths: Depths) -> None:
    shares, seen = np.zeros(len(depths.hand.closing[1])), list[bool]()
    for x in drawn(depths.limb, 60):
        lacks, rows = depths.residual(x, shares, 0.1)
        there = differences(lambda x: depths.residual(x, shares, 0.1)[0], x, len(lacks))
        known = np.isfinite(there)
        seen += (np.abs(there - rows) < ALIKE)[known & (rows != 0)].tolist()
        assert not rows[:, :3].any()
    assert len(seen) > 100
    # Where another face or edge becomes the nearest there are two, and round shapes have many faces.
    assert np.mean(seen) > 0.9


def pinched(x: Array, limb: Limb, goal: tuple[Face, Room]) -> tuple[Array, Array]:
    """What a hand lacks of its place about a part of a handle, and the derivatives."""
    values, rows = np.empty(4), np.empty((4, len(x)))
    count = placed.pinched(*limb.tool(x), limb.tool_jacobian(x), *goal, values, rows)
    return values[:count], rows[:count]


@pytest.mark.parametrize("scant", [False, True])
def test_the_place_of_a_handle_changes_as_its_derivatives_say(depths: Depths, scant: bool) -> None:
    limb, world, mechanics = depths.limb, depths.world, depths.mechanics
    q = limb.q(limb.parked)
    bar = find_bar(world, mechanics, q)
    assert bar is not None
    r, p = mechanics.handle_poses(q, bar.joint, np.array([0.1]))
    handle, pads = (r[0], p[0]), Pads(depths.hand)
    every, rows_seen = grips(parts(world, mechanics.container.handle, bar)), 0
    for x in drawn(limb, 10):
        for grip in every:
            goal = face(grip, handle, scant), pads.scant if scant else pads.room
            away, rows = pinched(x, limb, goal)
            there = differences(lambda x, g=goal: pinched(x, limb, g)[0], x, len(away))
            np.testing.assert_allclose(rows[:, 3:], there[:, 3:], atol=ALIKE)
            rows_seen += len(away)
    assert rows_seen > 10


def about(depths: Depths) -> Solver:
    limb = depths.limb
    return Solver(depths, Bounds(np.arange(len(limb.lower)) >= 3, limb.lower, limb.upper))


def test_the_tool_is_off_its_pose_as_its_derivatives_say(depths: Depths) -> None:
    limb = depths.limb
    for x, y in zip(drawn(limb, 10), drawn(limb, 20)[10:], strict=True):
        aim = limb.tool(y)
        off, rows = led(x, limb, aim)
        np.testing.assert_allclose(off[:3], limb.tool(x)[1] - aim[1], atol=1e-12)
        there = differences(lambda x, a=aim: led(x, limb, a)[0], x, 6)
        np.testing.assert_allclose(rows[:3, 3:], there[:3, 3:], atol=ALIKE)


def test_a_descent_leads_the_tool_to_its_pose(depths: Depths) -> None:
    limb, solver = depths.limb, about(depths)
    none = np.zeros(len(depths.hand.closing[1]))
    for x in drawn(limb, 10):
        y = solver.bounds.beside(x, np.full(len(x), 0.01))
        z, left = solver.lead(y, limb.tool(x), None, 30, 1e-9)
        assert left < 1e-6 or (z <= limb.lower).any() or (z >= limb.upper).any()
        np.testing.assert_array_equal(z[:3], y[:3])
        z, left = solver.lead(y, limb.tool(x), (none, 0.1), 30, 1e-9)
        lacks = [led(z, limb, limb.tool(x))[0], depths.residual(z, none, 0.1)[0]]
        assert left == pytest.approx(np.linalg.norm(np.concatenate(lacks)), abs=1e-9)


def test_no_pair_is_left_out_for_the_ball_that_it_is_in(depths: Depths) -> None:
    world, none = depths.world, np.zeros(len(depths.hand.closing[1]))
    shapes, demands, groups, widest, _ = depths.pairs
    assert groups[0, 2] == 0
    assert groups[-1, 3] == len(shapes)
    np.testing.assert_array_equal(groups[1:, 2], groups[:-1, 3])
    every = np.arange(len(shapes))
    assert all(demands[i:j].max() == most for (_, _, i, j), most in zip(groups, widest, strict=True))
    met = 0
    for x in drawn(depths.limb, 60):
        apart = world.distances(shapes, *world.frames(depths.q(x, none, 0.1)))
        count = len(depths.residual(x, none, 0.1)[0])
        found = set(depths.room[0][0][:count].tolist())
        near = set(every[apart < demands - 1e-6].tolist())
        assert near <= found
        assert found <= set(every[apart < demands + 1e-6].tolist())
        met += len(near)
    assert met > 10
