"""Compiled distances of convex shapes, against coal."""

import coal
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from services.physics.geometry.convex import EXACT, bounds_many, pack, parted
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
    middle = np.array([(one.aabb_local.min_ + one.aabb_local.max_) / 2 for one in shapes])
    poses = [(turns[i], at[i] + (turns[i] @ middle[pairs[:, i]][:, :, None])[:, :, 0]) for i in (0, 1)]
    low, high, packed = np.empty(COUNT), np.empty(COUNT), pack(shapes)
    bounds_many(packed, pairs, *poses, low, high)
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


def test_boxes_that_face_each_other_are_parted_by_their_distance() -> None:
    boxes = [coal.Box(0.2, 0.4, 0.6), coal.Capsule(0.1, 0.2)]
    for one in boxes:
        one.computeLocalAABB()
    still, aside = np.zeros(3), np.array([0.5, 0.05, 0.0])
    assert parted(pack(boxes), 0, 0, np.eye(3), still, np.eye(3), aside) == pytest.approx(0.3)
    assert parted(pack(boxes), 0, 1, np.eye(3), still, np.eye(3), aside) == pytest.approx(0.3)
