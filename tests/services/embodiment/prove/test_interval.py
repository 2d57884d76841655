"""Interval arithmetic: what comes out contains the exact result, of numbers of any size."""

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from services.embodiment.proof_check.geometry.interval import Interval, exact

LARGEST, LEAST = 1.7976931348623157e308, 5e-324

numbers = st.floats(allow_nan=False, allow_infinity=False)

OPERATIONS: dict[str, Callable[[Interval, Interval], Interval]] = {
    "+": lambda one, other: one + other,
    "-": lambda one, other: one - other,
    "*": lambda one, other: one * other,
}
EXACTLY: dict[str, Callable[[Fraction, Fraction], Fraction]] = {
    "+": lambda one, other: one + other,
    "-": lambda one, other: one - other,
    "*": lambda one, other: one * other,
}


def contains(found: Interval, value: Fraction) -> bool:
    low, high = float(found.lo), float(found.hi)
    return (low == -np.inf or Fraction(low) <= value) and (high == np.inf or value <= Fraction(high))


@pytest.mark.parametrize("operation", OPERATIONS)
@given(one=numbers, other=numbers)
@example(one=LARGEST, other=LARGEST)
@example(one=LARGEST, other=-LARGEST)
@example(one=-LARGEST, other=LARGEST)
@example(one=LEAST, other=LEAST)
@example(one=1e-200, other=-1e-200)
@example(one=1.0, other=LEAST)
@example(one=0.1, other=0.2)
def test_results_contain_what_is_exact(operation: str, one: float, other: float) -> None:
    with np.errstate(over="ignore"):
        found = OPERATIONS[operation](exact(one), exact(other))
    assert contains(found, EXACTLY[operation](Fraction(one), Fraction(other)))


@given(numbers)
@example(LEAST)
@example(1e-170)
@example(LARGEST)
def test_a_norm_contains_what_is_exact(value: float) -> None:
    with np.errstate(over="ignore"):
        found = exact([value, value]).norm()
    low, high = float(found.lo), float(found.hi)
    assert low >= 0
    assert Fraction(low) ** 2 <= 2 * Fraction(value) ** 2
    assert high == np.inf or 2 * Fraction(value) ** 2 <= Fraction(high) ** 2


def test_ends_are_hardly_wider_than_rounding() -> None:
    found = exact([1.0, -3.0, 1e10]) + exact([2.0, 1e-3, 1.0])
    assert np.all(found.hi - found.lo <= 4 * np.spacing(np.abs(found.lo)))


def test_what_is_infinite_stays_an_interval() -> None:
    with np.errstate(over="ignore"):
        found = Interval(np.array([-np.inf, 0.0]), np.array([0.0, np.inf])) + exact([1.0, 1.0])
    assert found.lo[0] == -np.inf
    assert found.hi[1] == np.inf
    assert not np.isnan([found.lo, found.hi]).any()
