"""Inverse: the force at the handle that τ needs, for every value of the parameters."""

from dataclasses import dataclass

import numpy as np

from sdt_kg.motion import Motion
from services.dynamics.cells import Cells, cells
from services.dynamics.model import Mechanics
from services.dynamics.resistance import (
    STILL,
    at,
    break_away,
    closer,
    damping,
    friction,
    heavy,
    inertial,
    latch,
    lever,
    mass,
    resisting,
    spring,
    unborne,
    weight,
)
from services.embodiment.proof_check.geometry.interval import Interval, exact

PARTS = (4, 16, 64)
"""[1] Into how many cells each piece of τ is cut, until they decide."""

NO_FORCE = 1e-9
"""[N or N m] Force that is rounding."""


@dataclass(frozen=True, slots=True)
class Need:
    """Force at the handle that a motion needs.

    Attributes:
        least: Every value of the parameters needs so much at some moment [N].
        least_time: When [s].
        most: No value needs more at any moment [N].
        most_time: When that bound is reached [s].
        onset: Every value needs so much to leave rest, however slowly [N].
        monotone: Whether friction, mass and load only resist where most is needed, and nothing brakes:
            then the largest value of each parameter needs most.
    """

    least: float
    least_time: float
    most: float
    most_time: float
    onset: float
    monotone: bool


def need(mechanics: Mechanics, motion: Motion, off: float = 0.0) -> Need:
    """Bounds of the force at the handle along τ, cut finer until they decide against what is allowed.

    Args:
        mechanics: Of the container whose joint moves.
        motion: Articulation values of that joint.
        off: How far from where the motion begins the joint is then [rad or m].
    """
    allowed = mechanics.forces.allowed
    for parts in PARTS:
        found = _need(mechanics, motion, parts, off)
        if found.most <= allowed or found.least > allowed:
            break
    return found


def _need(mechanics: Mechanics, motion: Motion, parts: int, off: float) -> Need:
    spans = cells(motion, parts, off)
    force = joint_force(mechanics, spans)
    size = at_handle(force.magnitude(), lever(mechanics, spans.q))
    onset, begin = _onset(mechanics, motion, spans, off)
    low, high = int(np.argmax(size.lo)), int(np.argmax(size.hi))
    least, at = max((float(size.lo[low]), float(spans.begin[low])), (onset, begin))
    middle = float((spans.begin[high] + spans.end[high]) / 2)
    return Need(least, at, float(size.hi[high]), middle, onset, _monotone(mechanics, spans, size))


def at_handle(size: Interval, way: Interval) -> Interval:
    """Force at the handle for a force of the joint [N]; the way is that of the handle for each rad or m."""
    with np.errstate(divide="ignore", invalid="ignore"):
        high = np.where(size.hi > 0, size.hi / way.lo, 0.0)
    return Interval(np.maximum(np.nextafter(size.lo / way.hi, -np.inf), 0.0), np.nextafter(high, np.inf))


def joint_force(mechanics: Mechanics, spans: Cells) -> Interval:
    """Force of the joint that the handle has to give, N or N m; at rest the least that holds it there."""
    moving = exact(np.zeros_like(spans.begin))
    for each in mechanics.moving:
        one, ratio = each.mechanics, exact(each.ratio)
        q, v = at(each, spans.q), ratio * spans.v
        still = spring(one, q) + latch(one, q) + closer(one, q)
        moving = moving + heavy(each, spans.q, spans.v, spans.a)
        moving = moving + ratio * (still + damping(one, q, v) + friction(one, v))
    held = unborne(mechanics, resisting(mechanics, spans.q), spans.q)
    grip, _ = break_away(mechanics)
    return Interval(
        np.where(spans.rests, np.minimum(held.lo + grip, 0.0), moving.lo),
        np.where(spans.rests, np.maximum(held.hi - grip, 0.0), moving.hi),
    )


def _onset(mechanics: Mechanics, motion: Motion, spans: Cells, off: float) -> tuple[float, float]:
    """Least force that leaves rest for the first time, and when; 0 where it does not begin at rest."""
    moves = np.flatnonzero(~spans.rests)
    if not moves.size:
        return 0.0, float(spans.begin[0])
    first = int(moves[0])
    piece, begin = int(spans.piece[first]), float(spans.begin[first])
    speed = 0.0 if motion.velocities is None else float(motion.velocities[piece, 0])
    if abs(speed) > STILL:
        return 0.0, begin
    start = motion.values[piece : piece + 1, 0]
    start = Interval(start + min(off, 0.0), start + max(off, 0.0))
    pulled = resisting(mechanics, start)
    opens = bool(spans.v.hi[first] > -spans.v.lo[first])
    along = float(pulled.lo[0] if opens else -pulled.hi[0]) + break_away(mechanics)[0]
    size = Interval(np.array([max(along, 0.0)]), np.array([max(along, 0.0)]))
    return float(at_handle(size, lever(mechanics, start)).lo[0]), begin


def _monotone(mechanics: Mechanics, spans: Cells, size: Interval) -> bool:
    """Whether the largest value of every parameter needs most: see `Need.monotone`."""
    moving = ~spans.rests
    opens, closes = bool((spans.v.lo[moving] >= -STILL).all()), bool((spans.v.hi[moving] <= STILL).all())
    if opens == closes or any(each.mechanics.fold for each in mechanics.moving):
        return False
    q, v, a = (each[moving] for each in (spans.q, spans.v, spans.a))
    slow = Interval(np.maximum(v.lo, 0.0), np.maximum(v.hi, 0.0))
    if closes:
        slow = Interval(np.minimum(v.lo, 0.0), np.minimum(v.hi, 0.0))
    driven = exact(np.zeros_like(q.lo))
    for each in mechanics.moving:
        one, ratio, own = each.mechanics, exact(each.ratio), at(each, q)
        terms = [weight(one, own), spring(one, own), latch(one, own), closer(one, own)]
        if any(_least(ratio * term, opens) < -NO_FORCE for term in terms):
            return False
        loaded = mass(one) * (inertial(one, ratio * a) + terms[0])
        slowed = damping(one, own, ratio * slow)
        driven = driven + ratio * (loaded + terms[1] + terms[2] + terms[3] + slowed)
        driven = driven + exact((1.0 if opens else -1.0) * each.ratio * one.forces.lower.coulomb)
    if _least(driven, opens) < -NO_FORCE:
        return False
    speeding = (a.lo if opens else -a.hi) >= 0
    needs = size.hi[moving]
    return bool(speeding.any()) and float(needs[speeding].max()) >= float(needs.max())


def _least(force: Interval, opens: bool) -> float:
    """The least of it against the motion."""
    return float(force.lo.min() if opens else -force.hi.max())
