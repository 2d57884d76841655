r"""What pushes back, as intervals over boxes of q and v: weight, spring, latch, closer, damping, friction.

Each occurs once and is linear in its parameters, so that at one position and speed interval arithmetic gives
exactly the range over all values.
"""

import math

import numpy as np

from services.dynamics.model import LOAD_ERROR, Array, Mechanics, Other, Wave
from services.embodiment.proof_check.geometry.interval import TRIG, Interval, exact

AT_STOP = 1e-6
"""[rad or m] So near a stop counts as at it."""

STILL = 1e-9
"""[rad/s or m/s] Speed that is rounding."""


def span(low: float, high: float) -> Interval:
    """Every value between two."""
    return Interval(np.asarray(low, dtype=np.float64), np.asarray(high, dtype=np.float64))


def weight(mechanics: Mechanics, q: Interval) -> Interval:
    """The joint force w γ(q) that holds one kilogram against gravity."""
    load, low, high = mechanics.load, mechanics.forces.lower, mechanics.forces.upper
    size, phase = math.hypot(load.cosine, load.sine), math.atan2(load.sine, load.cosine)
    cosine = _cosine(Interval(q.lo - phase, q.hi - phase))
    found = cosine * _about(size) + _about(load.constant)
    return found * span(low.weight, high.weight)


def wave(one: Wave, q: Interval) -> Interval:
    """Values of a wave."""
    total = exact(np.zeros_like(q.lo))
    for size, rate, phase in zip(one.size, one.rate, one.phase, strict=True):
        total = total + _about(float(size)) * _cosine(q * _about(float(rate)) + _about(float(phase)))
    return total


def held(each: Other, q: Interval) -> Interval:
    """What of the container's own force bears the weight of what one of the joints moves."""
    one = each.mechanics
    if one.fold is None:
        return exact(each.ratio) * mass(one) * weight(one, at(each, q))
    low, high = one.forces.lower, one.forces.upper
    own = wave(one.fold.weight_own, q) * span(low.weight, high.weight)
    return mass(one) * (wave(one.fold.weight_carried, q) + own)


def heavy(each: Other, q: Interval, v: Interval, a: Interval) -> Interval:
    """What of the container's own force bears weight and inertia of what one of the joints moves.

    For an inertia M(q) that is M a + M' v² / 2; each parameter occurs once.
    """
    one, fold = each.mechanics, each.mechanics.fold
    if fold is None:
        own = inertial(one, exact(each.ratio) * a) + weight(one, at(each, q))
        return exact(each.ratio) * (mass(one) * own)
    low, high, half = one.forces.lower, one.forces.upper, exact(0.5) * _square(v)
    carried = wave(fold.carried, q) * a + wave(fold.carried.slope(), q) * half
    mixed = wave(fold.mixed, q) * a + wave(fold.mixed.slope(), q) * half
    own = span(low.weight, high.weight) * (mixed + wave(fold.weight_own, q))
    turned = span(low.inertia, high.inertia) * _about(fold.turned) * a
    return mass(one) * (carried + wave(fold.weight_carried, q) + own + turned)


def lever(mechanics: Mechanics, q: Interval) -> Interval:
    """Way of the handle for each rad (or m) of the container's joint, wherever on the handle it is held."""
    reach = mechanics.reach
    if reach is None:
        return span(*mechanics.load.lever)
    square = wave(reach.lever, q)
    low, high = (np.sqrt(np.maximum(each, 0.0)) for each in (square.lo, square.hi))
    return Interval(np.maximum(low - reach.spread, 0.0), np.nextafter(high + reach.spread, np.inf))


def inertial(mechanics: Mechanics, a: Interval) -> Interval:
    """The joint force u κ a that accelerates one kilogram."""
    low, high = mechanics.forces.lower, mechanics.forces.upper
    return span(low.inertia, high.inertia) * _about(mechanics.load.inertia) * a


def mass(mechanics: Mechanics) -> Interval:
    """All that moves [kg]."""
    return span(mechanics.forces.lower.mass, mechanics.forces.upper.mass)


def spring(mechanics: Mechanics, q: Interval) -> Interval:
    """Of the spring: k (q - q0)."""
    forces = mechanics.forces
    return span(forces.lower.stiffness, forces.upper.stiffness) * (q - exact(forces.rest))


def latch(mechanics: Mechanics, q: Interval) -> Interval:
    """L(q): in full at the lower stop, nothing from the latch's width on."""
    forces, width = mechanics.forces, mechanics.forces.latch_width
    if width <= 0:
        return exact(np.zeros_like(q.lo))
    # Cut off before the division: a width of almost nothing would make its result too large for a float.
    lowest, highest = (np.clip(each - mechanics.lower, 0, width) / width for each in (q.lo, q.hi))
    share = Interval(
        np.clip(1 - np.nextafter(highest, np.inf), 0, 1),
        np.clip(1 - np.nextafter(lowest, -np.inf), 0, 1),
    )
    return share * span(forces.lower.latch, forces.upper.latch)


def closer(mechanics: Mechanics, q: Interval, v: Interval | None = None) -> Interval:
    """S(q), and with a speed d(q, v) v: within its range the soft closer pulls shut and damps closing."""
    forces = mechanics.forces
    limit = mechanics.lower + forces.closer_range
    share = Interval((q.hi < limit).astype(float), (q.lo < limit).astype(float))
    if v is None:
        return share * span(forces.lower.closer, forces.upper.closer)
    closing = Interval(np.minimum(v.lo, 0.0), np.minimum(v.hi, 0.0))
    return share * span(forces.lower.closer_damping, forces.upper.closer_damping) * closing


def at(other: Other, q: Interval) -> Interval:
    """Where a joint is that moves with the one at q."""
    return exact(other.ratio) * q + exact(other.offset) if other.ratio != 1 or other.offset else q


def resisting(mechanics: Mechanics, q: Interval) -> Interval:
    """All that depends on the position alone: what the joints are pulled shut with, felt at the first."""
    total = exact(np.zeros_like(q.lo))
    for each in mechanics.moving:
        one, own = each.mechanics, at(each, q)
        still = spring(one, own) + latch(one, own) + closer(one, own)
        total = total + held(each, q) + exact(each.ratio) * still
    return total


def break_away(mechanics: Mechanics) -> tuple[float, float]:
    """Least and largest friction that all joints together can bear at rest, felt at the first."""
    found = [(each.ratio, each.mechanics.forces) for each in mechanics.moving]
    least = sum(ratio * forces.lower.break_away for ratio, forces in found)
    return least, sum(ratio * forces.upper.break_away for ratio, forces in found)


def damping(mechanics: Mechanics, q: Interval, v: Interval) -> Interval:
    """(b + d) v."""
    forces = mechanics.forces
    return span(forces.lower.viscous, forces.upper.viscous) * v + closer(mechanics, q, v)


def friction(mechanics: Mechanics, v: Interval) -> Interval:
    """λ: Coulomb where it surely slides, up to break-away where it may be about to.

    Where a speed of one sign touches 0, rest needs no more than sliding does, so that what sliding needs
    bounds the most, and is needed at the moments at which it slides.
    """
    low, high = mechanics.forces.lower, mechanics.forces.upper
    opens, closes = (v.lo >= -STILL) & (v.hi > 0), (v.hi <= STILL) & (v.lo < 0)
    either = opens == closes
    least = np.where(opens, low.coulomb, np.where(v.hi < -STILL, -high.coulomb, -high.break_away))
    most = np.where(closes, -low.coulomb, np.where(v.lo > STILL, high.coulomb, high.break_away))
    return Interval(np.where(either, -high.break_away, least), np.where(either, high.break_away, most))


def unborne(mechanics: Mechanics, pulled: Interval, q: Interval) -> Interval:
    """What friction and hand have to bear at rest: a stop bears what presses against it."""
    low, high = pulled.lo, pulled.hi
    at_lower, at_upper = q.hi <= mechanics.lower + AT_STOP, q.lo >= mechanics.upper - AT_STOP
    low, high = np.where(at_lower, np.minimum(low, 0.0), low), np.where(at_lower, np.minimum(high, 0.0), high)
    return Interval(
        np.where(at_upper, np.maximum(low, 0.0), low), np.where(at_upper, np.maximum(high, 0.0), high)
    )


def _about(value: float) -> Interval:
    return span(value - LOAD_ERROR * abs(value), value + LOAD_ERROR * abs(value))


def _square(v: Interval) -> Interval:
    size = v.magnitude()
    return size * size


def _cosine(angle: Interval) -> Interval:
    """Cosines of intervals of angles [rad]."""
    low, high = np.cos(angle.lo), np.cos(angle.hi)
    full, half = _has_turn(angle, 0.0), _has_turn(angle, math.pi)
    return Interval(
        np.where(half, -1.0, np.minimum(low, high) - TRIG), np.where(full, 1.0, np.maximum(low, high) + TRIG)
    )


def _has_turn(angle: Interval, at: float) -> "np.ndarray[tuple[int], np.dtype[np.bool_]]":
    """Whether at + 2 π k lies in the interval, or within rounding of it, for some whole k."""
    play = 1e-9  # [rad] more than reducing an angle by turns errs
    turns: Array = np.floor((angle.hi + play - at) / (2 * math.pi))
    return turns * 2 * math.pi + at >= angle.lo - play
