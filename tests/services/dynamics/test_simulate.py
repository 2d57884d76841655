"""Forward dynamics: closed forms, rest and stops exactly, and what is monotone."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sdt_kg.errors import MotionError, OracleRejectedError
from services.dynamics.forward.simulate import simulate
from tests.services.dynamics.mechanisms import NOTHING, UPPER, slide

TIMES = np.linspace(0.0, 1.0, 51)


def constant(force: float) -> np.ndarray:
    return np.full(len(TIMES), force)


def test_a_constant_force_against_friction_is_a_parabola() -> None:
    values = replace(NOTHING, coulomb=3.0, break_away=4.0)
    moved = simulate(slide(values), values, TIMES, constant(5.0), start=0.0)
    assert moved.q == pytest.approx(0.5 * (5.0 - 3.0) / 5.0 * TIMES**2, abs=2e-4)
    assert moved.v[-1] == pytest.approx(0.4, abs=5e-4)


@pytest.mark.parametrize("force", [3.999, -3.999, 0.0])
def test_rest_bears_what_is_below_break_away_without_creeping(force: float) -> None:
    values = replace(NOTHING, coulomb=3.0, break_away=4.0)
    moved = simulate(slide(values), values, TIMES, constant(force), start=0.2)
    assert set(moved.q) == {0.2}


def test_a_force_above_break_away_moves_it() -> None:
    values = replace(NOTHING, coulomb=3.0, break_away=4.0)
    assert simulate(slide(values), values, TIMES, constant(4.001), start=0.2).q[-1] > 0.25


def test_it_rests_at_a_stop_and_never_beyond() -> None:
    moved = simulate(slide(NOTHING), NOTHING, TIMES, constant(20.0), start=0.0)
    assert moved.q.max() == UPPER
    assert moved.v[-1] == 0.0


def test_a_latch_lets_go_above_its_force_and_no_sooner() -> None:
    values, lengths = replace(NOTHING, latch=20.0), (0.0, 0.02, 0.0)
    held = simulate(slide(values, lengths=lengths), values, TIMES, constant(19.9), start=0.0)
    free = simulate(slide(values, lengths=lengths), values, TIMES, constant(20.1), start=0.0)
    assert held.q[-1] == 0.0
    assert free.q[-1] > 0.1


def test_a_slide_let_go_while_sliding_stops_where_work_is_spent() -> None:
    values = replace(NOTHING, coulomb=2.0, break_away=2.0)
    moved = simulate(slide(values), values, TIMES, constant(0.0), start=0.0, speed=0.3)
    assert moved.q[-1] == pytest.approx(5.0 * 0.3**2 / 2 / 2.0, abs=2e-4)
    assert moved.v[-1] == 0.0


@settings(max_examples=25, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
@given(st.floats(0, 6), st.floats(0, 3), st.floats(0, 20), st.floats(0, 10), st.floats(4, 14))
def test_more_friction_never_moves_it_further(
    coulomb: float, more: float, viscous: float, thicker: float, force: float
) -> None:
    """Claimed where friction alone resists and nothing drives: pulled one way, no spring, latch or weight."""
    little = replace(NOTHING, coulomb=coulomb, break_away=coulomb, viscous=viscous)
    much = replace(NOTHING, coulomb=coulomb + more, break_away=coulomb + more, viscous=viscous + thicker)
    profile = force * np.clip(TIMES / 0.2, 0, 1) * (TIMES < 0.7)
    ours, theirs = (simulate(slide(each), each, TIMES, profile, start=0.0) for each in (little, much))
    assert (theirs.q <= ours.q + ours.difference + theirs.difference + 1e-4).all()


def test_a_profile_that_is_none_is_refused() -> None:
    for times, force in (
        (TIMES, constant(1.0)[:-1]),
        (TIMES[::-1], constant(1.0)),
        (TIMES, constant(np.nan)),
    ):
        with pytest.raises(MotionError):
            simulate(slide(NOTHING), NOTHING, times, force, start=0.0)
    with pytest.raises(MotionError, match=r"between 0 and 0\.5"):
        simulate(slide(NOTHING), NOTHING, TIMES, constant(1.0), start=0.7)


def test_what_does_not_converge_is_refused() -> None:
    with pytest.raises(OracleRejectedError, match="did not converge"):
        simulate(slide(NOTHING), NOTHING, TIMES, constant(1.0), start=0.0, tolerance=-1.0)
