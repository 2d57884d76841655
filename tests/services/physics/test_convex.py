"""Compiled distances of convex shapes, against coal."""

from collections.abc import Sequence

import coal
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from services.physics.geometry.convex import EXACT, HULL, ROOM, parted
from services.physics.geometry.packed import bounds_of, pack
from services.physics.geometry.shapes import hull

pytestmark = pytest.mark.oracle

COUNT = 2000
COAL_IS_RIGHT_TO = 5e-6  # [m] its GJK stops at a relative 1e-6


def shape(rng: np.random.Generator) -> coal.CollisionGeometry:
    size = rng.uniform(0.01, 0.3, 3)
    made = (
        lambda: coal.Box(*size),
        lambda: coal.Sphere(size[0]),
        lambda: coal.Cylinder(size[0], size[1]),
        lambda: coal.Capsule(size[0], size[1]),
        lambda: hull(rng.normal(size=(20, 3)) * size),
    )[rng.integers(5)]()
    made.computeLocalAABB()
    return made


@pytest.mark.parametrize("aligned", [False, True])
def test_distances_are_those_of_coal_and_their_bounds_meet(aligned: bool) -> None:
    rng = np.random.default_rng(3)
    shapes = [shape(rng) for _ in range(60)]
    pairs = rng.integers(0, len(shapes), (COUNT, 2))
    turns = [np.tile(np.eye(3), (COUNT, 1, 1)) if aligned else Rotation.random(COUNT, rng).as_matrix()] * 2
    turns[1] = np.ascontiguousarray(turns[1][::-1])
    at = rng.uniform(-0.4, 0.4, (2, COUNT, 3))
    poses = centred(shapes, pairs, turns, at)
    packed = pack(shapes)
    low, high = bounds(packed, pairs, poses)
    apart = np.isfinite(low)
    assert COUNT / 20 < apart.sum() < COUNT
    assert (high - low)[apart].max() <= 100 * EXACT
    for n in range(COUNT):
        one, other = ((shapes[pairs[n, i]], coal.Transform3s(turns[i][n], at[i][n])) for i in (0, 1))
        expected = coal.distance(*one, *other, coal.DistanceRequest(), coal.DistanceResult())
        frames = (poses[i][k][n] for i in (0, 1) for k in (0, 1))
        assert parted(packed, *pairs[n], *frames) <= high[n] + EXACT
        if apart[n]:
            assert expected == pytest.approx(low[n], abs=COAL_IS_RIGHT_TO)
        else:
            assert expected <= high[n] + COAL_IS_RIGHT_TO


def bounds(
    packed: tuple[np.ndarray, ...], pairs: np.ndarray, poses: list[tuple[np.ndarray, np.ndarray]]
) -> np.ndarray:
    """Lower and upper bounds of the distance of each pair, shape (2, M) [m]."""
    work = np.zeros(ROOM)
    frames = zip(*poses[0], *poses[1], strict=True)
    return np.array(
        [
            bounds_of(packed, *pair, *frame, np.inf, -np.inf, work)
            for pair, frame in zip(pairs, frames, strict=True)
        ]
    ).T


def centred(
    shapes: Sequence[coal.CollisionGeometry], pairs: np.ndarray, turns: Sequence[np.ndarray], at: np.ndarray
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Rotations and centres of both shapes of each pair, whose frames are turned so and at those places."""
    middle = np.array([(one.aabb_local.min_ + one.aabb_local.max_) / 2 for one in shapes])
    return [(turns[i], at[i] + (turns[i] @ middle[pairs[:, i]][:, :, None])[:, :, 0]) for i in (0, 1)]


def surface(rng: np.random.Generator) -> coal.BVHModelBase:
    """A mesh of as many triangles as come out of it, none joined to another."""
    mesh = coal.BVHModelOBBRSS()
    mesh.beginModel(0, 0)
    corners = rng.uniform(-0.3, 0.3, (rng.integers(1, 80), 1, 3)) + rng.uniform(-0.1, 0.1, (1, 3, 3))
    for corner in corners:
        mesh.addTriangle(*corner)
    mesh.endModel()
    mesh.computeLocalAABB()
    return mesh


def test_a_mesh_is_as_far_as_its_nearest_triangle() -> None:
    rng = np.random.default_rng(5)
    shapes = [*(shape(rng) for _ in range(40)), *(surface(rng) for _ in range(40))]
    pairs = np.stack([rng.integers(0, 40, COUNT), rng.integers(40, 80, COUNT)], axis=1)
    pairs[::2] = pairs[::2, ::-1]
    turns = [np.ascontiguousarray(Rotation.random(COUNT, rng).as_matrix()) for _ in range(2)]
    at = rng.uniform(-0.6, 0.6, (2, COUNT, 3))
    poses = centred(shapes, pairs, turns, at)
    low, high = bounds(pack(shapes), pairs, poses)
    apart = np.isfinite(low)
    assert COUNT / 20 < apart.sum() < COUNT
    assert (high - low)[apart].max() <= 100 * EXACT
    for n in range(COUNT):
        one, other = ((shapes[pairs[n, i]], coal.Transform3s(turns[i][n], at[i][n])) for i in (0, 1))
        expected = coal.distance(*one, *other, coal.DistanceRequest(), coal.DistanceResult())
        assert max(expected, 0.0) == pytest.approx(max(low[n], 0.0), abs=COAL_IS_RIGHT_TO)


@pytest.mark.parametrize("margin", [0.0, 0.003, 0.05])
def test_whether_a_mesh_is_nearer_than_a_margin_needs_no_distance(margin: float) -> None:
    rng = np.random.default_rng(6)
    shapes = [*(shape(rng) for _ in range(20)), *(surface(rng) for _ in range(20))]
    packed, near = pack(shapes), 0
    for _ in range(COUNT):
        a, b = int(rng.integers(20)), int(rng.integers(20, 40))
        turns, at = Rotation.random(2, rng).as_matrix(), rng.uniform(-0.6, 0.6, (2, 3))
        poses = np.ascontiguousarray(turns[0]), at[0], np.ascontiguousarray(turns[1]), at[1]
        low, _ = bounds_of(packed, a, b, *poses, np.inf, -np.inf, np.zeros(ROOM))
        quick, _ = bounds_of(packed, a, b, *poses, margin, margin, np.zeros(ROOM))
        assert (quick > margin) == (low > margin)
        assert quick <= low + EXACT
        near += low <= margin
    assert COUNT / 20 < near < COUNT


def test_boxes_that_face_each_other_are_parted_by_their_distance() -> None:
    boxes = [coal.Box(0.2, 0.4, 0.6), coal.Capsule(0.1, 0.2)]
    for one in boxes:
        one.computeLocalAABB()
    still, aside = np.zeros(3), np.array([0.5, 0.05, 0.0])
    assert parted(pack(boxes), 0, 0, np.eye(3), still, np.eye(3), aside) == pytest.approx(0.3)
    assert parted(pack(boxes), 0, 1, np.eye(3), still, np.eye(3), aside) == pytest.approx(0.3)


@pytest.mark.parametrize("share", [1.0, 0.5, 0.0])
def test_a_tree_has_all_triangles_however_crowded_they_are(share: float) -> None:
    mesh = coal.BVHModelOBBRSS()
    mesh.beginModel(400, 1200)
    corner = np.array([[0.0, 0.0, 0.0], [1e-3, 0.0, 0.0], [0.0, 1e-3, 0.0]])
    places = [share**k if share < 1 else k / 400 for k in range(400)]
    for place in places:
        mesh.addTriangle(*(corner + np.array([0.0, 0.0, place])))
    mesh.endModel()
    mesh.computeLocalAABB()
    packed = pack([mesh])
    leaves = np.flatnonzero(packed[0] == HULL)
    assert len(leaves) == len(places)
    middle = (max(places) + min(places)) / 2
    heights = np.sort([packed[5][packed[3][leaf], 2] for leaf in leaves]) + middle
    np.testing.assert_allclose(heights, np.sort(places), atol=1e-12)
