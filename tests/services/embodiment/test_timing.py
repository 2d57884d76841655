"""Time laws: as fast as limits allow, and no faster."""

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from services.embodiment.ways import timing
from services.embodiment.ways.bound import Bound, Timed
from services.embodiment.ways.timing import Followed

FREE = np.inf, np.inf


def test_a_straight_segment_uses_its_limits_and_keeps_them() -> None:
    bound = Bound.alone(np.array([0.2, 0.2, 0.5]), np.array([0.4, 0.4, 1.0]))
    timed = timing.straight(np.zeros(3), np.array([3.0, 4.0, 0.1]), bound, 0.05)
    assert timed is not None
    speed, acceleration = timing.excess(timed, bound)
    assert speed == pytest.approx(timing.SLACK)
    assert acceleration == pytest.approx(timing.SLACK)
    # 5 m at 0.196 m/s, and half a second each to speed up and slow down at 0.392 m/s².
    assert timed.times[-1] == pytest.approx(5 / 0.196 + 0.196 / 0.392)
    np.testing.assert_allclose(timed.x[-1], [3.0, 4.0, 0.1], atol=1e-12)
    assert not timed.v[[0, -1]].any()


@pytest.mark.parametrize("limit", [5e-324, 1e-300, 1e300])
def test_limits_beyond_what_doubles_square_end_in_no_error(limit: float) -> None:
    for bound in (
        Bound.alone(np.array([1.0, 1.0, limit]), np.ones(3)),
        Bound.alone(np.ones(3), np.array([1.0, 1.0, limit])),
    ):
        timed = timing.straight(np.zeros(3), np.ones(3), bound, 0.5)
        assert timed is not None
        assert np.isfinite(timed.times).all()
        way = Followed.through(np.linspace(0, 1, 5), np.linspace(np.zeros(3), np.ones(3), 5))
        assert np.isfinite(timing.fastest(way, bound, FREE, 21)[0].times).all()


def random_path(rng: np.random.Generator) -> Followed:
    """Of a base, an arm of five joints that bend now and then, and a container."""
    count = int(rng.integers(3, 9))
    steps = rng.normal(size=(count, 8)) * rng.choice([0.02, 0.3], (count, 8))
    return Followed.through(np.linspace(0.0, rng.uniform(0.2, 1.5), count), np.cumsum(steps, axis=0))


def test_random_paths_keep_all_limits_between_samples_too_and_use_one_up() -> None:
    for seed in range(40):
        rng = np.random.default_rng(seed)
        path, bound = random_path(rng), Bound.alone(rng.uniform(0.1, 2, 8), rng.uniform(0.3, 5, 8))
        most = float(rng.uniform(0.1, 1)), float(rng.uniform(0.2, 2))
        timed, values, rates = timing.fastest(path, bound, most, 121)
        own = np.stack([values, np.zeros(121)], axis=1), np.stack([rates, np.zeros(121)], axis=1)
        alone = Bound.alone(*(np.array([limit]) for limit in most))
        ratios = *timing.excess(timed, bound), *timing.excess(timing.Timed(timed.times, *own), alone)
        assert max(ratios) == pytest.approx(timing.SLACK, rel=0.02)
        assert not timed.v[[0, -1]].any()
        assert (rates[[0, -1]] == 0).all()
        share = (values - values[0]) / (values[-1] - values[0])
        np.testing.assert_allclose(timed.x, path.spline.at(share)[0], atol=1e-12)
        np.testing.assert_allclose(
            timed.v * (values[-1] - values[0]), path.spline.at(share)[1] * rates[:, None]
        )


def test_one_steep_place_slows_the_motion_there_alone() -> None:
    # One joint turns by 1 rad within a twentieth of the way, where the others move evenly.
    share = np.linspace(0, 1, 101)
    x = np.zeros((101, 4))
    x[:, 2], x[:, 3] = share, np.clip((share - 0.5) / 0.05, 0, 1)
    path = Followed.through(share, x)
    limits = Bound.alone(np.full(4, 1.0), np.full(4, 100.0))
    timed, _, _ = timing.fastest(path, limits, FREE, 401)
    # No motion is quicker than 0.95 s for the even part and 1 s for the steep one.
    assert 1.95 < timed.times[-1] < 2.5


def test_a_way_along_one_joint_takes_as_long_as_a_trapezoid() -> None:
    for velocity, acceleration in ((0.5, 1.0), (10.0, 1.0)):
        bound = Bound.alone(np.array([1.0, 1.0, velocity]), np.array([1.0, 1.0, acceleration]))
        ends = np.zeros((2, 3))
        ends[1, 2] = 0.8
        best = timing.straight(ends[0], ends[1], bound, 0.01)
        timed, _, _ = timing.fastest(Followed.through(np.linspace(0, 1, 2), ends), bound, FREE, 121)
        assert best is not None
        assert timed.times[-1] == pytest.approx(best.times[-1], rel=0.02)


@pytest.mark.parametrize("seed", [18, 427, 442])
def test_speeds_are_largest_anywhere_between_two_samples_not_only_halfway(seed: int) -> None:
    rng = np.random.default_rng(seed)
    path = random_path(rng)
    bound = Bound.alone(rng.uniform(0.1, 2, 8), rng.uniform(0.3, 5, 8) * 10 ** rng.uniform(-1, 2))
    timed, _, _ = timing.fastest(path, bound, FREE, 121 if seed % 2 else 25)
    looks = timed.times[:-1] + np.linspace(0, 1, 33)[:, None] * np.diff(timed.times)
    speeds = CubicHermiteSpline(timed.times, timed.x, timed.v).derivative()(looks)
    assert np.linalg.norm(speeds[..., :2], axis=-1).max() <= bound.velocity[0]
    assert (np.abs(speeds[..., 2:]).max(axis=(0, 1)) <= bound.velocity[2:]).all()


@pytest.mark.parametrize(("velocity", "acceleration"), [(0.2, 1e6), (0.2, 1e12), (1e-5, 1.0)])
def test_full_speed_that_is_reached_at_once_is_no_more_than_the_limit(
    velocity: float, acceleration: float
) -> None:
    bound = Bound.alone(np.full(3, velocity), np.full(3, acceleration))
    timed = timing.straight(np.zeros(3), np.ones(3), bound, 0.5)
    assert timed is not None
    assert timed.times[0] == 0
    assert max(timing.excess(timed, bound)) == pytest.approx(timing.SLACK)


@pytest.mark.parametrize("velocity", [1e-9, 1e-3, 1e6])
def test_a_limit_however_small_or_large_is_kept(velocity: float) -> None:
    path = random_path(np.random.default_rng(3))
    bound = Bound.alone(np.full(8, velocity), np.full(8, 1e3))
    timed, values, rates = timing.fastest(path, bound, (1.0, 1e3), 121)
    assert (np.diff(timed.times) > 0).all()
    assert max(timing.excess(timed, bound)) <= 1
    assert abs(rates).max() <= 1
    assert np.isfinite(values).all()


def test_what_stands_beyond_a_limit_that_slows_it_is_not_too_fast() -> None:
    one = np.ones(1)
    bound = Bound(one, one, -one, -0.5 * one, one)
    stands = Timed(np.array([0.0, 1.0]), np.full((2, 1), -0.1), np.zeros((2, 1)))
    assert bound.haste(stands) == 1.0
