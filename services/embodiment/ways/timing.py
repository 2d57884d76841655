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
from services.embodiment.ways.bound import LAG, Bound, Timed
from services.physics.replay import spline_of, velocities_of
from services.physics.spline import Cubic, free_velocities

Array = NDArray[np.float64]

SLACK = 0.98  # [1] of every limit is used
BENT = 0.5  # [1] of an acceleration limit that what turns on its way may take
BRIEFEST = 1e-5  # [1] of the way's time at full speed that speeding up takes at least
UNBOUNDED = 1e6  # [1/s2] of the share of a way that nothing bounds
LEAST = 1e-12  # [1/s2] the square of a speed along a way, where rounding leaves none
USED = 1e-12, 1e12  # [1] of a limit that a way at full speed may be said to use: no product overflows
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
    with np.errstate(over="ignore"):
        used = np.concatenate([norm / limit[0], single / limit[2:]], axis=-1)
    least, most = USED
    return 1.0 / min(max(float(used.max(initial=0.0)), least), most)


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
    ramp = min(ramp, speed**2 / BRIEFEST)
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


def fastest(
    path: Followed, bound: Bound, container: tuple[float, float], samples: int
) -> tuple[Timed, Array, Array]:
    """The path about as fast as all limits allow at each of its points, and the container's values and rates.

    Let b be the square of the speed along the way. The least acceleration that is left at two samples says by
    how much b differs from one to the other; b is the largest that keeps to that and to its bounds, and is 0
    at both ends (Bobrow, Dubowsky and Gibson 1985). What is left is taken for the fastest that may be there,
    so one pass each way finds b; then `stretched` uses up the limits.

    Args:
        path: What is followed.
        bound: Of the robot.
        container: Velocity and acceleration limit of the container's joint.
        samples: How many, in even steps of the way.
    """
    share = np.linspace(0.0, 1.0, samples)
    span = float(path.values[-1] - path.values[0])
    x, slope = path.at(share, np.ones(samples))
    turns = np.abs(np.diff(slope, axis=0)) / share[1]
    bend = np.maximum(np.vstack((turns[:1], turns)), np.vstack((turns, turns[-1:])))
    still = np.zeros(samples)
    rates, bends = _each(slope, still + abs(span)), _each(bend, still)
    velocity, acceleration = (
        np.hstack((most[0], most[2:], own))
        for most, own in zip((bound.velocity, bound.acceleration), container, strict=True)
    )
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        square = np.fmin.reduce((velocity / rates) ** 2, axis=1, initial=UNBOUNDED)
        square = np.fmin(square, np.fmin.reduce(BENT * acceleration / bends, axis=1, initial=UNBOUNDED))
        room = np.where(slope > 0, bound.upper - x, x - bound.lower) + LAG
        slowed = np.fmin.reduce((bound.gain * room / np.abs(slope)) ** 2, axis=1, initial=UNBOUNDED)
        left = (acceleration - bends * square[:, None]) / rates
    square = np.fmin(square, slowed)
    square[[0, -1]] = 0.0
    gain = np.fmin.reduce(left, axis=1, initial=UNBOUNDED)
    climb = np.append(0.0, np.cumsum(2 * share[1] * np.minimum(gain[1:], gain[:-1])))
    square = climb + np.minimum.accumulate(square - climb)
    square = np.minimum.accumulate((square + climb)[::-1])[::-1] - climb
    rate = np.sqrt(np.append(np.append(0.0, np.maximum(square[1:-1], LEAST)), 0.0))
    times = np.append(0.0, np.cumsum(2 * share[1] / (rate[1:] + rate[:-1])))
    timed = Timed(times, x, slope * rate[:, None])
    return stretched(timed, bound, (path.values[0] + span * share, span * rate), container)


def _each(robot: Array, container: Array) -> Array:
    """What has limits of its own, shape (T, n): the base in its plane, the other variables, the container."""
    plane = np.linalg.norm(robot[:, BASE_LINEAR], axis=1, keepdims=True)
    return np.hstack((plane, np.abs(robot[:, 2:]), container[:, None]))


def _hermite_accelerations(u: Array, x: Array, v: Array) -> tuple[Array, Array]:
    """Accelerations at both ends of each cubic Hermite piece: the extremes, shape (T − 1, n) each."""
    h = np.diff(u)[:, None]
    slope = np.diff(x, axis=0) / h
    return (6 * slope - 4 * v[:-1] - 2 * v[1:]) / h, (-6 * slope + 2 * v[:-1] + 4 * v[1:]) / h


def excess(timed: Timed, bound: Bound) -> tuple[float, float]:
    """Largest ratio of velocity and of acceleration to its limit, between samples too."""
    first, second = _hermite_accelerations(timed.times, timed.x, timed.v)
    h = np.diff(timed.times)[:, None]
    part = np.divide(first, first - second, out=np.zeros_like(first), where=first * second < 0)
    turning = timed.v[:-1] + h * part * first / 2  # of each variable where it is fastest
    middle = (timed.v[1:] + timed.v[:-1]) / 2 + h * (first - second) / 8  # the base may be, of both together
    speeds, accelerations = np.concatenate([timed.v, turning, middle]), np.concatenate([first, second])
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
    own = Bound.alone(np.array(container[:1]), np.array(container[1:]))
    ratios = excess(timed, bound), excess(Timed(timed.times, values, rates), own)
    factor = max(max(speed / SLACK, np.sqrt(acceleration / SLACK)) for speed, acceleration in ratios)
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
