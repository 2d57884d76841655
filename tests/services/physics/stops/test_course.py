"""How far a joint may take corners towards others, along the direction that parts them."""

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from services.physics.geometry.shapes import hull_of_solid
from services.physics.stops.course import Course
from services.physics.stops.passing import Array, Way

ALLOWED = 0.01  # [m]
FINE, MOST = 1e-6, 4.0  # [rad or m]
DIRECTION = np.array([0.6, 0.0, 0.8])


def moved(way: Way, points: Array, gone: float) -> Array:
    """The points when the actuated joint has gone so far."""
    if way.slides:
        return points + way.rate * gone * way.axis
    turn = Rotation.from_rotvec(way.rate * gone * way.axis).as_matrix()
    return (points - way.origin) @ turn.T + way.origin


def parted(points: Array, others: Array) -> tuple[float, Array]:
    """Gap of the points' hulls, as coal has it, and its direction."""
    result, still = coal.DistanceResult(), coal.Transform3s()
    hulls = hull_of_solid(points), hull_of_solid(others)
    gap = coal.distance(hulls[0], still, hulls[1], still, coal.DistanceRequest(), result)
    return float(gap), result.normal


@pytest.mark.parametrize("slides", [True, False])
@pytest.mark.parametrize("seed", range(40))
def test_no_corner_is_deeper_on_the_way_that_is_free_and_one_is_behind_it(slides: bool, seed: int) -> None:
    rng = np.random.default_rng(seed)
    axis = rng.normal(size=3)
    way = Way(axis / np.linalg.norm(axis), rng.uniform(-0.3, 0.3, 3), slides, float(rng.choice([-1.7, 0.4])))
    points, others = (
        rng.uniform(-0.2, 0.2, (9, 3)),
        rng.uniform(-0.2, 0.2, (7, 3)) + rng.uniform(-0.3, 0.3, 3),
    )
    gone, allowed = float(rng.uniform(0, 1)), 0.3
    gap, toward = parted(moved(way, points, gone), others)
    free = Course(way, points, others).free(gone, toward, allowed)

    def room(at: float) -> float:
        return float((others @ toward).min() - (moved(way, points, at) @ toward).max()) + allowed

    assert room(gone) == pytest.approx(gap + allowed, abs=1e-5)
    assert free > 0
    for share in np.linspace(0, 1, 25):
        there = gone + share * min(free, MOST)
        assert room(there) >= -1e-12
        assert parted(moved(way, points, there), others)[0] >= -allowed - 1e-6
    if free < MOST:
        assert room(gone + free + FINE) < 0


def test_nothing_is_free_where_there_is_no_direction_or_a_corner_is_too_deep() -> None:
    points, others = np.eye(3), np.eye(3) + DIRECTION
    for slides in (True, False):
        course = Course(Way(np.array([0.0, 0.0, 1.0]), np.zeros(3), slides, 1.0), points, others)
        assert course.free(0.0, DIRECTION, ALLOWED) > 0
        assert course.free(0.0, np.zeros(3), ALLOWED) == 0
        assert course.free(0.0, np.full(3, np.nan), ALLOWED) == 0
        assert course.free(0.0, -DIRECTION, ALLOWED) == 0
