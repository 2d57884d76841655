"""Time laws: when the motion is where, at rest at both ends, within the limits of speed and acceleration.

All samples are knots of cubic Hermite splines, as BodyMotion defines them. On straight segments the
law is a trapezoid with knots at its switches, where the spline is exact.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sdt_kg.motion import Motion
from sdt_kg.twin import Container
from services.embodiment.ways.bound import Bound, Timed
from services.physics.replay import spline_of, velocities_of
from services.physics.spline import Cubic, free_velocities

Array = NDArray[np.float64]

SLACK = 0.98  # [1] of every limit is used
BASE_LINEAR = slice(0, 2)
TURNS = (
    2e-3  # [rad or m] back and forth by less, τ counts as going straight to its end: twice what it may be off
)


def joined(parts: list[Timed]) -> Timed:
    """The parts one after the other, each beginning where the last ended, at rest."""
    times, xs, vs, clock = [np.zeros(1)], [parts[0].x[:1]], [parts[0].v[:1]], 0.0
    for part in parts:
        times.append(clock + part.times[1:])
        xs.append(part.x[1:])
        vs.append(part.v[1:])
        clock += float(part.times[-1])
    return Timed(np.concatenate(times), np.concatenate(xs), np.concatenate(vs))


def _slowest(rate: Array, limit: Array) -> float:
    """Largest factor on rates (…, n) that keeps them within the limits, the first two by their norm."""
    norm = np.linalg.norm(rate[..., BASE_LINEAR], axis=-1, keepdims=True)
    single = np.abs(rate[..., 2:])
    used = np.concatenate([norm / limit[0], single / limit[2:]], axis=-1)
    return float(1.0 / max(used.max(initial=0.0), 1e-12))


def straight(start: Array, end: Array, bound: Bound, spacing: float) -> Timed | None:
    """Rest-to-rest trapezoid from start to end; None where they are equal.

    At most the share `spacing` of the way lies between two samples [1].
    """
    way = end - start
    if not np.any(np.abs(way) > 1e-12):
        return None
    speed = SLACK * _slowest(way, bound.velocity)
    ramp = SLACK * _slowest(way, bound.acceleration)
    speed = min(speed, np.sqrt(ramp))
    t_ramp, t_flat = speed / ramp, max(1.0 / speed - speed / ramp, 0.0)
    switches = np.array([0.0, t_ramp, t_ramp + t_flat, 2 * t_ramp + t_flat])
    times = _refined(switches, max(2, int(np.ceil(1.0 / spacing))))
    share, rate = _trapezoid(times, switches, speed, ramp)
    timed = Timed(times, start + share[:, None] * way, rate[:, None] * way)
    return timed.slower(bound.haste(timed))


def _refined(switches: Array, count: int) -> Array:
    total = switches[-1]
    extra = np.linspace(0.0, total, count + 1)
    merged = np.sort(np.concatenate([switches, extra]))
    keep = np.append(True, np.diff(merged) > 1e-6 * total)
    times = merged[keep]
    # A switch that fell within the tolerance of an even sample must be the one that stays.
    for switch in switches:
        times[np.argmin(np.abs(times - switch))] = switch
    return times


def _trapezoid(times: Array, switches: Array, speed: float, ramp: float) -> tuple[Array, Array]:
    _, up, down, end = switches
    rising, falling = np.minimum(times, up), np.maximum(times - down, 0.0)
    flat = np.clip(times - up, 0.0, down - up)
    share = ramp * rising**2 / 2 + speed * flat + speed * falling - ramp * falling**2 / 2
    rate = np.where(times <= up, ramp * times, np.where(times <= down, speed, ramp * (end - times)))
    rate[0] = rate[-1] = 0.0
    share[-1] = 1.0
    return share, rate


def along(corners: Array, bound: Bound, reach: Array, spacing: float) -> Timed:
    """Rest-to-rest motion along straight segments through the corners (K, n).

    `reach` says what a unit of each variable moves [m], shape (n,); at most `spacing` [m] lies between
    two samples.
    """
    parts = []
    for start, end in pairwise(corners):
        length = max(float(np.abs(end - start) @ reach), 1e-9)
        part = straight(start, end, bound, min(spacing / length, 0.5))
        if part is not None:
            parts.append(part)
    still = Timed(np.zeros(1), corners[:1], np.zeros_like(corners[:1]))
    return joined(parts) if parts else still


def smooth(u: Array) -> Array:
    """Way, speed and acceleration of a law from 0 to 1 in unit time at u (T,), shape (3, T).

    Speed rises as a smoothstep over the first 30 %, is constant, and falls likewise: acceleration is
    continuous, so that a spline through samples stays near the law.
    """
    ramp = 0.3
    top = 1.0 / (1.0 - ramp)

    def rise(s: Array) -> tuple[Array, Array, Array]:
        return top * ramp * (s**3 - s**4 / 2), top * (3 * s**2 - 2 * s**3), top / ramp * (6 * s - 6 * s**2)

    up, down = rise(np.clip(u / ramp, 0, 1)), rise(np.clip((1 - u) / ramp, 0, 1))
    early, late = u < ramp, u > 1 - ramp
    way = np.where(early, up[0], np.where(late, 1 - down[0], top * ramp / 2 + top * (u - ramp)))
    speed = np.where(early, up[1], np.where(late, down[1], top))
    acceleration = np.where(early, up[2], np.where(late, -down[2], 0.0))
    return np.stack([way, speed, acceleration])


@dataclass(frozen=True, slots=True, eq=False)
class Followed:
    """A robot path over a container's value: x(p), C² in p.

    Attributes:
        values: Values of the container's joint at the waypoints, monotone, shape (K,).
        spline: x over the share of the way from the first to the last value.
    """

    values: Array
    spline: Cubic

    @staticmethod
    def through(values: Array, x: Array) -> "Followed":
        share = (values - values[0]) / (values[-1] - values[0])
        return Followed(values, Cubic(share, x, free_velocities(share, x)))

    def at(self, share: Array, rate: Array) -> tuple[Array, Array]:
        """Positions and velocities of the robot at shares of the way with rates [1/s], shape (T, n)."""
        x, slope = self.spline.at(share)
        return x, slope * rate[:, None]


def slowed(
    path: Followed, bound: Bound, container: tuple[float, float], samples: int
) -> tuple[Timed, Array, Array]:
    """The path as fast as all limits allow with the law `smooth`, and the container's values and rates.

    `container` holds the velocity and acceleration limit of the container's joint.
    """
    u = np.linspace(0.0, 1.0, samples)
    law = smooth(u)
    span = float(path.values[-1] - path.values[0])
    x, v = path.at(law[0], law[1])
    first, second = _hermite_accelerations(u, x, v)
    accelerations = np.concatenate([first, second])
    # Hermite pieces can be faster inside than at their ends; the middle is the extreme if there is one.
    middles = 1.5 * np.diff(x, axis=0) / np.diff(u)[:, None] - (v[1:] + v[:-1]) / 4
    speeds = np.concatenate([v, middles])
    factor = max(
        1.0 / _slowest(speeds, bound.velocity),
        1.0 / np.sqrt(_slowest(accelerations, bound.acceleration)),
        abs(span) * law[1].max() / container[0],
        np.sqrt(abs(span) * np.abs(law[2]).max() / container[1]),
    )
    duration = factor / SLACK
    timed = Timed(u * duration, x, v / duration)
    slower = bound.haste(timed)
    return timed.slower(slower), path.values[0] + span * law[0], span * law[1] / (duration * slower)


def _hermite_accelerations(u: Array, x: Array, v: Array) -> tuple[Array, Array]:
    """Accelerations at both ends of each cubic Hermite piece: the extremes, shape (T − 1, n) each."""
    h = np.diff(u)[:, None]
    slope = np.diff(x, axis=0) / h
    return (6 * slope - 4 * v[:-1] - 2 * v[1:]) / h, (-6 * slope + 2 * v[:-1] + 4 * v[1:]) / h


def excess(timed: Timed, bound: Bound) -> tuple[float, float]:
    """Largest ratio of velocity and of acceleration to its limit, between samples too."""
    first, second = _hermite_accelerations(timed.times, timed.x, timed.v)
    h = np.diff(timed.times)[:, None]
    middles = 1.5 * np.diff(timed.x, axis=0) / h - (timed.v[1:] + timed.v[:-1]) / 4
    speeds, accelerations = np.concatenate([timed.v, middles]), np.concatenate([first, second])
    speed, haste = 1.0 / _slowest(speeds, bound.velocity), bound.haste(timed)
    return max(speed, haste) if haste > 1 else speed, 1.0 / _slowest(accelerations, bound.acceleration)


def as_timed(motion: Motion, samples: int) -> tuple[Array, Array, Array]:
    """(times, values, rates) of a motion given as values, on at least `samples` samples, from time 0.

    Its knots are among these, so that between two of them it is one cubic: that of their values and rates.
    """
    knots = motion.times - motion.times[0]
    times = np.union1d(knots, np.linspace(0.0, knots[-1], samples))
    times = times[np.append(True, np.diff(times) > 1e-9)]
    x, v = Cubic(knots, motion.values, velocities_of(motion)).at(times)
    return times, x[:, 0], v[:, 0]


def turns_back(motion: Motion) -> bool:
    """Whether the motion goes another way than straight from its first value to its last."""
    _, values = spline_of(motion).position()
    return float(np.abs(np.diff(values)).sum()) > abs(float(values[-1] - values[0])) + TURNS


def farthest(motion: Motion, start: float, container: Container) -> float:
    """The value to which a robot has to bring the container, if it begins at `start`: a stop is the end."""
    if not motion.timed and not turns_back(motion):
        return min(max(float(motion.values[-1, 0]), container.lower), container.upper)
    _, values = spline_of(motion).position()
    return float(values[np.argmax(np.abs(values - start))])


def stretched(
    timed: Timed, bound: Bound, alone: tuple[Array, Array], container: tuple[float, float]
) -> tuple[Timed, Array, Array]:
    """Robot and container, its values and rates `alone`, at all times slower by what their limits ask for.

    `container` holds the velocity and acceleration limit of the container's joint.
    """
    values, rates = (np.stack([each, np.zeros_like(each)], axis=1) for each in alone)
    far = np.full(2, np.inf)
    own = Bound(np.array(container[:1]), np.array(container[1:]), -far, far, far)
    ratios = excess(timed, bound), excess(Timed(timed.times, values, rates), own)
    factor = max(max(speed, np.sqrt(acceleration)) for speed, acceleration in ratios) / SLACK
    timed = timed.slower(factor)
    slower = bound.haste(timed)
    return timed.slower(slower), alone[0], alone[1] / (factor * slower)


def at_values(path: Followed, times: Array, values: Array, rates: Array) -> Timed:
    """The robot where the container is at given values and rates."""
    span = float(path.values[-1] - path.values[0])
    x, v = path.at((values - path.values[0]) / span, rates / span)
    return Timed(times, x, v)


def outside(timed: Timed, lower: Array, upper: Array) -> float:
    """How far positions leave the limits (n,), between samples too, to a tenth of a piece [rad or m]."""
    h = np.diff(timed.times)[:, None]
    worst, third = 0.0, h / 3  # [s]
    inner = timed.x[:-1] + third * timed.v[:-1], timed.x[1:] - third * timed.v[1:]
    # A piece lies within the hull of its ends and these two points of Bézier's.
    if all((lower <= x).all() and (x <= upper).all() for x in (timed.x, *inner)):
        return worst
    for u in np.linspace(0.0, 1.0, 11):
        x = (
            (1 + 2 * u) * (1 - u) ** 2 * timed.x[:-1]
            + u**2 * (3 - 2 * u) * timed.x[1:]
            + h * (u * (1 - u) ** 2 * timed.v[:-1] - u**2 * (1 - u) * timed.v[1:])
        )
        worst = max(worst, float(np.maximum(lower - x, x - upper).max()))
    return worst
