"""Between samples: extrema of cubic splines are exact, so no limit is passed unseen."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.interpolate import CubicHermiteSpline, CubicSpline

from services.physics.spline import Cubic, Hermite, at_rest_velocities, excesses, free_velocities

FINITE = st.floats(-3, 3, allow_subnormal=False)


def dense(times: np.ndarray, values: np.ndarray, velocities: np.ndarray, order: int) -> np.ndarray:
    fine = np.concatenate([np.linspace(a, b, 200, endpoint=False) for a, b in pairwise(times)])
    return CubicHermiteSpline(times, values, velocities)(fine, order)


@given(arrays(float, (3, 6), elements=FINITE), arrays(float, 5, elements=st.floats(0.05, 2)))
def test_no_sampled_value_lies_beyond_the_extrema(rows: np.ndarray, steps: np.ndarray) -> None:
    times = np.concatenate([[0.0], np.cumsum(steps)])
    spline = Hermite(times, rows[0], rows[1])
    for order, (_, values) in enumerate((spline.position(), spline.velocity(), spline.acceleration())):
        seen = dense(times, rows[0], rows[1], order)
        slack = 1e-9 * max(1.0, float(np.abs(values).max()))
        assert values.min() - slack <= seen.min()
        assert seen.max() <= values.max() + slack


@given(arrays(float, 6, elements=FINITE), arrays(float, 5, elements=st.floats(0.05, 2)))
def test_every_extremum_is_a_value_of_the_spline(values: np.ndarray, steps: np.ndarray) -> None:
    times = np.concatenate([[0.0], np.cumsum(steps)])
    velocities = at_rest_velocities(times, values[:, None])[:, 0]
    at, found = Hermite(times, values, velocities).position()
    np.testing.assert_allclose(CubicHermiteSpline(times, values, velocities)(at), found, atol=1e-9)


def test_a_parabola_peaks_between_its_samples() -> None:
    spline = Hermite(np.array([0.0, 2.0]), np.array([0.0, 0.0]), np.array([1.0, -1.0]))
    times, values = spline.position()
    assert (times[np.argmax(values)], values.max()) == (1.0, 0.5)


def test_the_spline_through_samples_begins_and_ends_at_rest() -> None:
    velocities = at_rest_velocities(np.array([0.0, 1.0, 2.0]), np.array([[0.0], [1.0], [0.0]]))
    assert velocities[:, 0] == pytest.approx([0.0, 0.0, 0.0], abs=1e-15)


@given(arrays(float, (7, 2), elements=FINITE), arrays(float, 6, elements=st.floats(0.05, 2)))
def test_velocities_at_samples_are_those_of_the_clamped_spline(values: np.ndarray, steps: np.ndarray) -> None:
    times = np.concatenate([[0.0], np.cumsum(steps)])
    expected = CubicSpline(times, values, bc_type="clamped")(times, 1)
    np.testing.assert_allclose(at_rest_velocities(times, values), expected, atol=1e-9)


@pytest.mark.parametrize("count", [2, 3, 4, 7])
@given(rows=arrays(float, (7, 2), elements=FINITE), steps=arrays(float, 6, elements=st.floats(0.05, 2)))
def test_a_free_spline_is_the_usual_one_where_its_pieces_are_not_told_apart(
    count: int, rows: np.ndarray, steps: np.ndarray
) -> None:
    times, values = np.concatenate([[0.0], np.cumsum(steps)])[:count], rows[:count]
    at = np.union1d(times, np.linspace(-0.1, times[-1] + 0.1, 50))
    expected = CubicSpline(times, values)
    found = Cubic(times, values, free_velocities(times, values)).at(at)
    scale = max(1.0, float(np.abs(expected(at, 1)).max()))
    np.testing.assert_allclose(found[0], expected(at), atol=1e-9 * scale)
    np.testing.assert_allclose(found[1], expected(at, 1), atol=1e-9 * scale)


def test_first_and_worst_excess_are_told_apart() -> None:
    times, values = np.arange(5.0), np.array([0.0, 1.2, 0.5, 1.9, 1.1])
    first, worst = excesses(times, values, 0.0, 1.0, 0.0)
    assert (first.value, first.time, first.first) == (1.2, 1.0, True)
    assert (worst.value, worst.time, worst.first) == (1.9, 3.0, False)


def test_one_excess_is_told_once() -> None:
    (only,) = excesses(np.arange(3.0), np.array([0.0, -2.0, 0.0]), -1.0, 1.0, 0.0)
    assert (only.value, only.bound) == (-2.0, -1.0)
