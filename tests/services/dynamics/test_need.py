"""Inverse dynamics by intervals: the bound holds for every value of the parameters; what is monotone."""

import math
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from sdt_kg.motion import Motion
from services.dynamics.forward.simulate import simulate
from services.dynamics.model import Load, Mechanics, Values
from services.dynamics.need import PARTS, need
from services.dynamics.resistance import latch
from services.dynamics.rest import at_rest
from services.embodiment.proof_check.geometry.interval import exact
from services.physics.spline import Hermite, at_rest_velocities
from tests.services.dynamics.mechanisms import NOTHING, UPPER, slide

JOINT = "https://example.org/id/test/joint/slide"
DOWNWARD = Load(False, 0.05, 0.0, -2.0, 0.0, (0.35, 0.4))


def quintic(begin: float, end: float, duration: float, samples: int = 17) -> Motion:
    u = np.linspace(0.0, 1.0, samples)
    values = begin + (end - begin) * u**3 * (10 + u * (6 * u - 15))
    return Motion(JOINT, u * duration, values[:, None])


def dense(motion: Motion, count: int = 4001) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Times, positions, speeds, accelerations of the spline, by scipy's own."""
    from scipy.interpolate import CubicSpline  # noqa: PLC0415 - independent of the code under test

    spline = CubicSpline(motion.times, motion.values[:, 0], bc_type="clamped")
    times = np.linspace(motion.times[0], motion.times[-1], count)
    return times, spline(times), spline(times, 1), spline(times, 2)


def exactly(mechanics: Mechanics, values: Values, motion: Motion) -> np.ndarray:
    """Force of the joint at each moment of sliding, from the equation, for one value of each parameter."""
    forces, load = mechanics.forces, mechanics.load
    _, q, v, a = dense(motion)
    moving = np.abs(v) > 1e-9
    q, v, a = q[moving], v[moving], a[moving]
    total = values.mass * (values.inertia * load.inertia * a + values.weight * load.weight(q))
    total += values.stiffness * (q - forces.rest) + values.viscous * v + values.coulomb * np.sign(v)
    if forces.latch_width > 0:
        total += values.latch * np.interp(q - mechanics.lower, [0, forces.latch_width], [1, 0])
    within = q - mechanics.lower < forces.closer_range
    return total + np.where(within, values.closer + values.closer_damping * np.minimum(v, 0), 0.0)


intervals = st.tuples(st.floats(0, 1), st.floats(0, 1)).map(sorted)


@st.composite
def mechanisms(draw: st.DrawFn) -> Mechanics:
    scale = (10.0, 0.0, 0.0, 6.0, 0.0, 10.0, 30.0, 20.0, 15.0, 60.0)
    ends = np.array([draw(intervals) for _ in scale]).T * scale
    low, high = ends + np.array([1.0, 0, 0, 0, 0, 0, 0, 0, 0, 0])
    low[[1, 2]], high[[1, 2]] = 0.8, 1.2
    low[4], high[4] = low[3] + 0.5, high[3] + 2.0
    lengths = draw(st.tuples(st.floats(-0.1, 0.3), st.floats(0, 0.05), st.floats(0, 0.1)))
    load = draw(st.sampled_from([Load(True, 1.0, 0.0, 0.0, 1.5, (1.0, 1.0)), DOWNWARD]))
    return slide(Values(*low.tolist()), Values(*high.tolist()), load=load, lengths=lengths, allowed=1e-3)


@pytest.mark.parametrize("width", [5e-324, 2.3e-309, 0.01])
def test_a_latch_of_any_width_holds_at_the_stop_and_not_beyond_it(width: float) -> None:
    strong = replace(NOTHING, latch=20.0)
    mechanics = slide(strong, strong, lengths=(0.0, width, 0.0))
    held = latch(mechanics, exact(np.array([0.0, 2 * max(width, 1e-300), UPPER])))
    assert held.lo == pytest.approx([20.0, 0.0, 0.0], abs=1e-9)
    assert held.hi == pytest.approx([20.0, 0.0, 0.0], abs=1e-9)


@settings(max_examples=20, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
@given(mechanisms(), st.booleans(), st.floats(0.6, 4.0), st.floats(0, 1))
def test_no_value_of_the_parameters_needs_more_than_the_bound_nor_less(
    mechanics: Mechanics, opens: bool, duration: float, share: float
) -> None:
    motion = quintic(0.0, UPPER, duration) if opens else quintic(UPPER, 0.0, duration)
    found = need(mechanics, motion)
    near, far = mechanics.load.lever
    low, high = mechanics.forces.lower.array(), mechanics.forces.upper.array()
    corners = (low, high, low + share * (high - low), np.where(np.arange(10) % 2, low, high))
    for values in (Values(*each.tolist()) for each in corners):
        size = np.abs(exactly(mechanics, values, motion))
        assert size.max() / near <= found.most
        assert size.max() / far >= found.least - 1e-9 or found.least == found.onset


@settings(max_examples=20, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
@given(mechanisms(), st.floats(2.0, 8.0), st.integers(0, 9), st.floats(0, 1))
def test_where_monotone_is_claimed_more_of_anything_never_needs_less(
    mechanics: Mechanics, duration: float, which: int, share: float
) -> None:
    motion = quintic(0.0, UPPER, duration)
    assume(need(mechanics, motion).monotone)
    low, high = mechanics.forces.lower.array(), mechanics.forces.upper.array()
    some = low + share * (high - low)
    more = some.copy()
    more[which] = high[which]
    before, after = (np.abs(exactly(mechanics, Values(*v.tolist()), motion)).max() for v in (some, more))
    assert after >= before - 1e-9


def test_monotone_is_claimed_against_friction_and_not_where_something_drives_or_brakes() -> None:
    rough = replace(NOTHING, coulomb=8.0, break_away=8.0)
    assert need(slide(rough, allowed=1e-3), quintic(0.0, UPPER, 3.0)).monotone
    assert not need(slide(NOTHING, allowed=1e-3), quintic(0.0, UPPER, 3.0)).monotone  # only braked
    sprung = replace(rough, stiffness=30.0)
    driven = slide(sprung, lengths=(UPPER, 0.0, 0.0), allowed=1e-3)
    assert not need(driven, quintic(0.0, UPPER, 3.0)).monotone
    hanging = slide(replace(rough, mass=5.0), load=DOWNWARD, allowed=1e-3)
    assert not need(hanging, quintic(0.0, UPPER, 3.0)).monotone


def test_the_force_of_a_plain_drawer_is_its_closed_form() -> None:
    values = replace(NOTHING, mass=8.0, coulomb=4.0, break_away=4.0)
    motion = quintic(0.0, UPPER, 2.0, samples=65)
    highest = 8.0 * (10 / math.sqrt(3)) * UPPER / 2.0**2 + 4.0
    found = need(slide(values, allowed=1e-3), motion)
    assert found.most == pytest.approx(highest, rel=2e-3)
    assert found.least == pytest.approx(highest, rel=5e-2)
    assert found.onset == pytest.approx(4.0)


def test_a_latch_has_to_be_broken_however_slowly() -> None:
    values = replace(NOTHING, latch=30.0, coulomb=2.0, break_away=5.0)
    mechanics = slide(values, lengths=(0.0, 0.02, 0.0), allowed=20.0)
    found = need(mechanics, quintic(0.0, UPPER, 60.0))
    assert found.onset == pytest.approx(35.0)
    assert found.least >= 35.0 - 1e-9


def test_what_stays_where_friction_bears_the_load_and_what_does_not() -> None:
    values = replace(NOTHING, mass=5.0, coulomb=3.0, break_away=4.0, stiffness=20.0)
    mechanics = slide(values)
    assert at_rest(mechanics, 0.19).stays
    beyond = at_rest(mechanics, 0.3)
    assert (beyond.shuts, beyond.opens, beyond.surely) == (True, False, True)
    wide = slide(values, replace(values, stiffness=40.0))
    unsure = at_rest(wide, 0.15)
    assert (unsure.stays, unsure.surely) == (False, False)


def test_a_stop_bears_what_presses_against_it() -> None:
    pulled = replace(NOTHING, latch=30.0)
    assert at_rest(slide(pulled, lengths=(0.0, 0.02, 0.0)), 0.0).stays
    hanging = slide(replace(NOTHING, mass=5.0), load=DOWNWARD)
    assert at_rest(hanging, UPPER).stays
    assert at_rest(hanging, 0.3).opens


@settings(max_examples=15, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
@given(st.floats(0, 20), st.floats(0, 8), st.floats(0, 10), st.floats(0.05, 0.45))
def test_what_is_said_to_stay_stays_in_simulation_and_what_surely_moves_moves(
    stiffness: float, friction: float, closer: float, q: float
) -> None:
    values = replace(NOTHING, stiffness=stiffness, coulomb=friction, break_away=friction, closer=closer)
    mechanics = slide(values, lengths=(0.2, 0.0, 0.25))
    rest, times = at_rest(mechanics, q), np.linspace(0.0, 1.0, 21)
    margin = abs(abs(stiffness * (q - 0.2) + (closer if q < 0.25 else 0)) - friction)
    if margin < 0.05:
        return
    moved = simulate(mechanics, values, times, np.zeros(21), start=q)
    assert rest.stays == (moved.q[-1] == q)
    assert rest.surely != rest.stays


def test_pinocchios_inverse_dynamics_with_terms_added_is_within_the_bounds() -> None:
    """rnea of a hinged box under gravity, with friction and damping added explicitly, along a dense τ."""
    model = pin.Model()
    joint = model.addJoint(0, pin.JointModelRY(), pin.SE3.Identity(), "hinge")
    model.appendBodyToJoint(
        joint, pin.Inertia.FromBox(6.0, 0.02, 0.5, 0.4), pin.SE3(np.eye(3), np.array([0, 0, 0.2]))
    )
    data = model.createData()
    per_kilogram = pin.Inertia.FromBox(1.0, 0.02, 0.5, 0.4)
    inertia = per_kilogram.inertia[1, 1] + 0.2**2
    load = Load(False, float(inertia), 0.0, -9.81 * 0.2, 0.0, (0.4, 0.4))
    values = replace(NOTHING, mass=6.0, coulomb=2.0, break_away=2.0, viscous=0.7)
    motion = quintic(0.0, UPPER, 1.5)
    _, q, v, a = dense(motion, 401)
    torques = np.array(
        [
            pin.rnea(model, data, np.array([q[i]]), np.array([v[i]]), np.array([a[i]]))[0]
            for i in range(len(q))
        ]
    )
    torques += 2.0 * np.sign(v) + 0.7 * v
    found = need(slide(values, load=load, allowed=1e-3), motion)
    moving = np.abs(v) > 1e-9
    assert np.abs(torques[moving]).max() / 0.4 == pytest.approx(found.most, rel=0.02)
    assert np.abs(torques[moving]).max() / 0.4 <= found.most


def test_finer_cells_only_tighten() -> None:
    assert PARTS == (4, 16, 64)
    values = replace(NOTHING, mass=8.0, coulomb=4.0, break_away=4.0)
    motion = quintic(0.0, UPPER, 2.0)
    coarse = need(slide(values, allowed=1e4), motion).most
    fine = need(slide(values, allowed=1e-3), motion).least
    assert fine <= need(slide(values, allowed=coarse - 1e-3), motion).most <= coarse
    spline = Hermite(motion.times, motion.values[:, 0], at_rest_velocities(motion.times, motion.values)[:, 0])
    assert np.abs(spline.acceleration()[1]).max() * 8.0 + 4.0 <= coarse
