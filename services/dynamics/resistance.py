r"""What pushes back, as intervals over boxes of q and v: weight, spring, latch, closer, damping, friction.

Each occurs once and is linear in its parameters, so that at one position and speed interval arithmetic gives
exactly the range over all values.
"""

import math

import numpy as np

from services.dynamics.model import Array, Mechanics, Other
from services.embodiment.proof_check.interval import TRIG, Interval, exact

AT_STOP = 1e-6
"""[rad or m] So near a stop counts as at it."""

STILL = 1e-9
"""[rad/s or m/s] Speed that is rounding."""

LOAD_ERROR = 1e-9
"""[1] Share by which inertia and weight from the twin's shapes are widened: more than Pinocchio errs."""


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
        held = mass(one) * weight(one, own) + spring(one, own) + latch(one, own) + closer(one, own)
        total = total + exact(each.ratio) * held
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
