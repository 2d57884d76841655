"""Two containers seen together: one follows the other, or goes its own way."""

from dataclasses import replace

import numpy as np
import pytest

from predicates.learn import Learned, learn
from predicates.learn.coupled import coupled
from sdt_kg.errors import MotionError
from tests.predicates.learn.observed import Array, door, drawer, seen, stopping


def together(second: Array, seed: int = 0) -> tuple[Learned, Learned]:
    """A door that opens by 1.2 rad, and a second one beside it with these positions."""
    first = learn(seen(door(stopping(1.2)), seed))
    return first, learn(seen(door(second, 0.3) + np.array([0.8, 0.0, 0.0]), seed + 50))


@pytest.mark.parametrize("multiplier", [-1.0, 0.5, 2.0])
def test_a_panel_that_follows_has_its_multiplier(multiplier: float) -> None:
    found = coupled(*together(multiplier * stopping(1.2)))
    # both joints count from 0 in the direction in which they open
    assert found.holds
    assert found.multiplier == pytest.approx(abs(multiplier), abs=max(0.02, 3 * found.multiplier_deviation))
    assert found.offset == pytest.approx(0.0, abs=0.02)


def test_a_drawer_that_a_door_pulls_out_follows_in_metres_for_each_radian() -> None:
    first = learn(seen(door(stopping(1.2))))
    second = learn(seen(drawer(0.3 * stopping(1.2)), 7))
    found = coupled(first, second)
    assert found.holds
    assert found.multiplier == pytest.approx(0.3, abs=0.01)


def test_twenty_pairs_are_told_apart() -> None:
    later = np.concatenate([np.zeros(90), np.linspace(0, 1.0, 100), np.full(60, 1.0)])
    wrong = [
        seed
        for seed in range(10)
        if not coupled(*together(0.7 * stopping(1.2), seed)).holds or coupled(*together(later, seed)).holds
    ]
    assert wrong == []


def test_what_was_not_seen_together_says_nothing() -> None:
    first, second = together(stopping(1.2))
    elsewhen = replace(second.track, times=second.track.times + 100)
    with pytest.raises(MotionError, match="have 0 samples at the same time"):
        coupled(first, learn(elsewhen))
    with pytest.raises(MotionError, match="has no times"):
        coupled(first, learn(replace(second.track, timed=False)))
