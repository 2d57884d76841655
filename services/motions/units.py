"""Values that a motion file probably got wrong: degrees, millimetres, milliseconds, jumps.

A value outside its limits is a matter for the verdict. Here only those are refused that would be
plausible in another unit and are absurd in the stated one, and leaps from one sample to the next that no
motion makes.
"""

import math

import numpy as np

from sdt_kg.annotation import BaseLimits
from sdt_kg.errors import InputError, MotionError
from sdt_kg.mechanism import Joint, JointType, Mechanism
from sdt_kg.motion import Array
from services.motions.given import Given

FULL_TURN = 2 * math.pi
"""[rad] A joint with limits that is asked to go further than this is probably given in degrees."""

MANY_TURNS = 10 * FULL_TURN
"""[rad] The same for angles without limits: yaw of the base, continuous joints."""

ROOM = 100.0
"""[m] A base or handle farther from the kitchen's origin is probably given in millimetres."""

_BASE = (
    ("x", ROOM, "m", "millimetres"),
    ("y", ROOM, "m", "millimetres"),
    ("yaw", MANY_TURNS, "rad", "degrees"),
)

SLOW_SPACING = 1.0
"""[s] Samples farther apart than this, in a motion that nearly stands still, look like milliseconds."""

FAST = 2.0
"""[1] Times its velocity limit: a motion that is faster in milliseconds is not given in these."""

AGREES = 2.0
"""[1] Velocities that add up to a joint's way within this factor are in the unit of the times."""

MANY_SAMPLES = 5  # [1] a few samples may well be waypoints far apart

PARTS = (("nanoseconds", 1e9), ("microseconds", 1e6), ("milliseconds", 1e3))
"""Units that times may be in, with how many are a second."""

MILLI = PARTS[-1][1]

FINEST = 1e-4
"""[s] Samples are no nearer to each other: ten times as many as a robot's controller makes."""

WRONG_WAY = 0.01
"""[rad or m] What a joint is beyond 0 by no more is a matter for the verdict."""

LEAP = 20.0
"""[1] Times its velocity limit: a joint that goes so fast from one sample to the next has jumped."""

STILL = 1e-3  # [1] times its velocity limit: a coordinate that is slower counts as standing still
LEAST_LEAP = 0.1
"""[rad or m] Less is a matter for the verdict, however fast."""


def check_joints(
    names: tuple[str, ...], values: Array, mechanism: Mechanism, array: str, given: Given
) -> None:
    """Positions are not in degrees or millimetres, and count as the joint's do here.

    Raises:
        MotionError: With the first sample and the joint.
    """
    joints = [mechanism.joint(name) for name in names]
    columns = [column for column, joint in enumerate(joints) if _first_beyond(joint, values[:, column]) >= 0]
    if columns:
        slides = {column: joints[column].type is JointType.PRISMATIC for column in columns}
        raise _of_unit(joints, values, min(columns, key=slides.__getitem__), array, given)
    for column, joint in enumerate(joints):
        _check_sign(joint, values[:, column], array, given)


def _first_beyond(joint: Joint, positions: Array) -> int:
    """The first sample whose position is absurd; -1 if none is."""
    beyond = np.flatnonzero(np.abs(positions) > _absurd(joint)[0])
    return int(beyond[0]) if beyond.size else -1


def _of_unit(joints: list[Joint], values: Array, column: int, array: str, given: Given) -> MotionError:
    """That a joint is in another unit: one that turns if any does so, since it tells which.

    Sliding joints that are as far beyond as the factor from rad to degrees makes them, in an array that has
    turning ones too, were probably converted with these.
    """
    joint = joints[column]
    bound, unit, other = _absurd(joint)
    k = _first_beyond(joint, values[:, column])
    told, remedy = f"probably in {other}", f"convert to {unit}"
    converted = [
        each.name
        for at, each in enumerate(joints)
        if each.type is JointType.PRISMATIC and _first_beyond(each, values[:, at]) >= 0
        if np.abs(np.deg2rad(values[:, at])).max() <= _largest(each)
    ]
    turning = any(each.type is not JointType.PRISMATIC for each in joints)
    if converted and joint.type is not JointType.PRISMATIC:
        told += f", and so is {converted[0]}, which slides: all of '{array}' was converted"
        remedy = f"divide all of '{array}' by 180/π"
    elif joint.name in converted and turning:
        told += f", or in degrees, if all of '{array}' was converted"
        remedy = f"convert to m, or divide all of '{array}' by 180/π"
    return MotionError(
        f"'{array}' of {joint.name} at {given.at(k)} is {values[k, column]:.6g} {unit}, {told}",
        allowed=f"{unit}, up to {bound:.4g}",
        remedy=remedy,
    )


def _largest(joint: Joint) -> float:
    """[rad or m] How far from 0 its limits let a joint be."""
    return max(abs(joint.limits.lower), abs(joint.limits.upper))


def _check_sign(joint: Joint, values: Array, array: str, given: Given) -> None:
    """Positions of a joint whose axis was turned on import are not those of its file.

    Raises:
        MotionError: With the farthest sample.
    """
    if joint.turned and -values.min() > max(float(values.max()), WRONG_WAY):
        k = int(values.argmin())
        where = f"'{array}' of {joint.name} at {given.at(k)}"
        raise MotionError(
            f"{where} is {values[k]:.6g}, as its file counts: {joint.turned}",
            allowed=f"{joint.limits.lower:g} to {joint.limits.upper:g}",
            remedy="give its positions and velocities the other sign",
        )


def _absurd(joint: Joint) -> tuple[float, str, str]:
    """Beyond which value, in which unit, a joint's position is absurd, and what it probably is in."""
    largest = _largest(joint)
    if joint.type is JointType.PRISMATIC:
        return (ROOM if math.isinf(largest) else 1.0 + 10 * largest), "m", "millimetres"
    return (MANY_TURNS if math.isinf(largest) else max(FULL_TURN, 1.5 * largest)), "rad", "degrees"


def check_start(base: tuple[float, float, float]) -> None:
    """A start pose of the base is on the floor, and its yaw within a turn.

    Raises:
        InputError: With the coordinate.
    """
    from services.physics.geometry.floor import SIDE  # noqa: PLC0415 - loads shapes, and a start is seldom given

    bounds = SIDE / 2, SIDE / 2, FULL_TURN
    for (name, _, unit, _), bound, value in zip(_BASE, bounds, base, strict=True):
        if not abs(value) <= bound:
            said = f"the base starts at {name} = {value:.6g} {unit}"
            ends = ", where the kitchen's floor ends" if unit == "m" else ""
            raise InputError(said, allowed=f"{unit}, from {-bound:.4g} to {bound:.4g}{ends}")


def check_base(poses: Array, array: str, given: Given) -> None:
    """x, y and, where there is one, yaw are not in millimetres or degrees.

    A yaw may wind up, but begins within a turn.

    Raises:
        MotionError: With the first sample and the coordinate.
    """
    for column, (name, bound, unit, other) in enumerate(_BASE[: poses.shape[1]]):
        beyond = np.flatnonzero(np.abs(poses[:, column]) > bound)
        if beyond.size:
            k = int(beyond[0])
            raise MotionError(
                f"{name} of '{array}' at {given.at(k)} is {poses[k, column]:.6g} {unit}, probably in {other}",
                allowed=f"{unit}, up to {bound:.4g}",
                remedy=f"convert to {unit}",
            )
    if poses.shape[1] == len(_BASE) and abs(poses[0, 2]) > FULL_TURN:
        raise MotionError(
            f"yaw of '{array}' at {given.at(0)} is {poses[0, 2]:.6g} rad, probably in degrees",
            allowed=f"rad, at first up to {FULL_TURN:.4g}",
            remedy="convert to rad, or take whole turns off",
        )


def check_times(
    times: Array, names: tuple[str, ...], positions: Array, velocities: Array | None, mechanism: Mechanism
) -> None:
    """Times are not in parts of a second: samples are far apart, and read so the joints keep to their speeds.

    Velocities that the file gives, and that add up to the ways, show that they are in seconds.

    Raises:
        MotionError: With the spacing, and the joint that moves fastest.
    """
    limits = {joint.name: joint.limits.velocity for joint in mechanism.joints}
    fastest, share = _fastest(times, positions, [limits[name] for name in names])
    if fastest is None or (velocities is not None and _add_up(times, positions, velocities)):
        return
    spacing = float(np.median(np.diff(times)))
    unit, parts = _unit(spacing, share)
    raise MotionError(
        f"'times' are {spacing:.4g} s apart and {names[fastest]}, the fastest joint, uses"
        f" {share:.2%} of its speed: probably {unit}",
        allowed="seconds; times so far apart with velocities in rad/s or m/s that add up to the motion",
        remedy=f"divide times by {parts:.0f}",
    )


def _unit(spacing: float, share: float) -> tuple[str, float]:
    """The smallest unit in which the samples are no nearer, and the joints no faster, than they may be."""
    fit = (each for each in PARTS if spacing / each[1] >= FINEST and share * each[1] < FAST)
    return next(fit, PARTS[-1])


def drives(times: Array, poses: Array, limits: BaseLimits) -> bool:
    """Whether the base moves as fast as times in seconds let it, so that joints may well hardly move."""
    fastest = [limits.linear_velocity, limits.linear_velocity, limits.angular_velocity]
    return bool((poses != poses[0]).any()) and _fastest(times, poses, fastest)[0] is None


def _fastest(times: Array, positions: Array, limits: list[float]) -> tuple[int | None, float]:
    """Which column uses the largest share of its speed, and which; None if times may well be in seconds."""
    if len(times) < MANY_SAMPLES or np.median(np.diff(times)) < SLOW_SPACING or not limits:
        return None, 0.0
    bounds = np.array(limits)
    rates = np.abs(np.diff(positions, axis=0)) / np.diff(times)[:, None]
    shares = rates.max(axis=0) / np.where(np.isfinite(bounds) & (bounds > 0), bounds, 1.0)
    fastest = int(np.argmax(shares))
    share = float(shares[fastest])
    return (fastest, share) if 0 < share < FAST / MILLI else (None, share)


def _add_up(times: Array, positions: Array, velocities: Array) -> bool:
    speeds = np.abs(velocities)
    ways = float(np.abs(np.diff(positions, axis=0)).sum())
    told = float(((speeds[1:] + speeds[:-1]) / 2 * np.diff(times)[:, None]).sum())
    return ways / AGREES < told < ways * AGREES


def check_leaps(
    names: tuple[str, ...], times: Array, values: Array, mechanism: Mechanism, given: Given
) -> None:
    """No joint jumps from one sample to the next.

    Raises:
        MotionError: With both samples and the joint.
    """
    limits = {joint.name: joint.limits.velocity for joint in mechanism.joints}
    _check_leaps(names, [limits[name] for name in names], times, values, given)


def check_base_leaps(times: Array, poses: Array, limits: BaseLimits, given: Given) -> None:
    """The base does not jump from one sample to the next.

    Raises:
        MotionError: With both samples and the coordinate.
    """
    fastest = [limits.linear_velocity, limits.linear_velocity, limits.angular_velocity]
    _check_leaps(("x of the base", "y of the base", "yaw of the base"), fastest, times, poses, given)


def _check_leaps(
    names: tuple[str, ...], fastest: list[float], times: Array, values: Array, given: Given
) -> None:
    if not names:
        return
    steps, spacing = np.abs(np.diff(values, axis=0)), np.diff(times)
    bounds = np.array(fastest)
    _check_hurry(steps / spacing[:, None] / np.where(bounds > 0, bounds, np.inf), names, spacing)
    leaps = (steps > LEAST_LEAP) & (steps / (LEAP * spacing[:, None]) > bounds)
    if leaps.any():
        k, column = (int(each) for each in np.argwhere(leaps)[0])
        raise MotionError(
            f"{names[column]} jumps by {steps[k, column]:.4g} from {given.at(k)} to {given.at(k + 1)},"
            f" in {spacing[k]:.4g} s",
            allowed="a motion without jumps",
            remedy="unwrap angles, and sample more finely where joints move fast",
        )


def _check_hurry(shares: Array, names: tuple[str, ...], spacing: Array) -> None:
    """Most steps are not so fast, as shares of velocity limits, shape (T - 1, n), that times are too short.

    Raises:
        MotionError: With the coordinate that is fastest then.
    """
    moving = shares[shares.max(axis=1) > STILL] if len(shares) else shares
    if len(moving) < MANY_SAMPLES:
        return
    usual = np.median(moving, axis=0)
    column = int(np.argmax(usual))
    if (share := float(usual[column])) > LEAP:
        parts = next((each for _, each in reversed(PARTS) if share / each < FAST), PARTS[0][1])
        raise MotionError(
            f"'times' are {float(np.median(spacing)):.4g} s apart and {names[column]} moves at"
            f" {share:.4g} times its speed in most of them: probably {parts:.0f} times too short",
            allowed="seconds",
            remedy=f"multiply times by {parts:.0f}",
        )
