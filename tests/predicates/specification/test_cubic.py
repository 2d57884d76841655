"""Between samples: extrema of cubic Hermite splines, and qualities that are integrals of them."""

import numpy as np
import pytest

from predicates.case import Answer, Case
from predicates.specification.cubic import Cubic
from predicates.specification.model import Quality
from predicates.specification.quality import better, measured, total
from sdt_kg.motion import BodyMotion
from tests.small import small_twin


def test_a_bump_between_two_samples_is_found() -> None:
    """q = 4 s (1 - s) on [0, 1] begins and ends at 0 with velocities 4 and -4, and is 1 at a half."""
    spline = Cubic(np.array([0.0, 1.0]), np.zeros((2, 1)), np.array([[4.0], [-4.0]]))
    assert spline.refined().tolist() == [0.0, 0.5, 1.0]
    assert spline.at(spline.refined())[:, 0].tolist() == [0.0, 1.0, 0.0]


def test_no_value_of_random_splines_exceeds_those_at_its_turns() -> None:
    draw = np.random.default_rng(1)
    for _ in range(50):
        times = np.cumsum(draw.uniform(0.05, 1, 6))
        spline = Cubic(times, draw.normal(size=(6, 3)), draw.normal(size=(6, 3)) * 5)
        dense = spline.at(np.linspace(times[0], times[-1], 2001))
        found = spline.at(spline.refined())
        assert (dense.max(axis=0) <= found.max(axis=0) + 1e-12).all()
        assert (dense.min(axis=0) >= found.min(axis=0) - 1e-12).all()


def body(q: list[list[float]], v: list[list[float]], base: list[list[float]]) -> BodyMotion:
    times, still = np.array([0.0, 1.0]), np.zeros((2, 3))
    return BodyMotion("r", "", ("lift",), times, np.array(base), np.array(q), np.array(v), still)


@pytest.mark.parametrize(
    ("quality", "value"),
    [
        (Quality.TIME, 1.0),
        (Quality.PATH_LENGTH, 2.0),  # up by 1 and down again, though both samples are at 0
        (Quality.ENERGY, 64.0 + 9 * 12),  # (-8)²; a base that goes 3 m from rest to rest: 12 d² / h³
        (Quality.BASE_TRAVEL, 3.0),
        (Quality.CLEARANCE, None),
    ],
)
def test_qualities_of_a_motion_that_can_be_computed_by_hand(quality: Quality, value: float | None) -> None:
    motion = body([[0.0], [0.0]], [[4.0], [-4.0]], [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0]])
    found = measured(quality, motion, Answer(Case(small_twin()), holds=True))
    assert found == (None if value is None else pytest.approx(value, abs=1e-12))


def test_less_is_better_but_of_clearance_more_and_the_worst_step_counts() -> None:
    assert better(Quality.TIME, 1, 2)
    assert better(Quality.CLEARANCE, 2, 1)
    assert total(Quality.ENERGY, [1, 2]) == 3
    assert total(Quality.CLEARANCE, [1, 2]) == 1
