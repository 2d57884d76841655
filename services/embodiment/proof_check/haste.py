r"""Whether a container's timed motion is too fast for any hand that holds its handle, whatever its posture.

Between two samples of τ every point of the handle goes at least a distance d, in a time t, though the
container may be off τ at each by as much as certification allows (`astray`). One that a finger
touches lies in the grasp box and, held, keeps its place in the tool to within the slip that certification
allows; so a point of the hand in that box makes this way but for the slip, and no joint may exceed its
velocity limit by more than `rate` (while the container moves from sample to sample, and is in one hold):

.. math:: d - slip \le t \sum_j \dot q_j^{max} (1 + rate) \, r_j,

where r_j is the largest distance that a point of the grasp box can have from the axis of joint j (1 for a
slide). If that is false for every gripper, no motion keeps these times.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Drive, Gripper
from sdt_kg.motion import BASE_JOINTS
from services.embodiment.proof_check.arm import ROUNDING, Arm
from services.embodiment.proof_check.geometry.interval import Interval, apply, exact
from services.embodiment.proof_check.geometry.mechanics import Placement
from services.embodiment.proof_check.proof.claim import Timing
from services.embodiment.proof_check.statement import Statement

Array = NDArray[np.float64]

MOST_SAMPLES = 100_000
STILL = 1e-6
"""[rad or m] Between samples that differ by less the container may rest, and be let go and held anew."""


def too_fast(statement: Statement, drive: Drive, timing: Timing, window: tuple[int, int]) -> Iterator[str]:
    """Why the window of τ does not show that no gripper can follow; nothing if it does."""
    first, last = window
    if len(timing.times) > MOST_SAMPLES or not (np.diff(timing.times) > 0).all():
        yield f"the motion's times do not increase, or are more than {MOST_SAMPLES}"
    elif not 0 <= first < last < len(timing.times):
        yield f"the motion has no samples {first} to {last}"
    elif rests(np.array(timing.values[first : last + 1])).any():
        yield f"the container may rest, and be let go, between samples {first} and {last}"
    else:
        way, slip = travelled(statement, timing.values[first], timing.values[last])
        time = timing.times[last] - timing.times[first]
        if not statement.grippers:
            yield "the robot has no gripper: nothing to refute"
        for gripper in statement.grippers:
            most = fastest(statement, drive, gripper)
            if not way - slip[gripper.name] > most * time + ROUNDING:
                yield f"{gripper.name} may move {most * time:.3g} m in {time:.3g} s, {way:.3g} m are asked"


def rests(values: Array) -> NDArray[np.bool_]:
    """Between which samples the container may rest, shape (T - 1,)."""
    return np.abs(np.diff(values)) < STILL


def travelled(statement: Statement, one: float, other: float) -> tuple[float, dict[str, float]]:
    """How far each point of the handle goes at least between two values [m], and of it what may be slip."""
    kept, off = statement.tolerances, statement.passing.astray
    before, after = (statement.target(value, off) for value in (one, other))
    if not before.boxes:
        return 0.0, {gripper.name: 0.0 for gripper in statement.grippers}
    way = min(_least_way(*each) for each in zip(before.boxes, after.boxes, before.half, strict=True))
    slips: dict[str, float] = {}
    for gripper in statement.grippers:
        arm = statement.arm(gripper)
        away = 0.0 if arm is None else float(np.linalg.norm(np.abs(arm.middle) + arm.half))
        slips[gripper.name] = 2 * (kept.tool_position + 2 * float(np.sin(kept.tool_angle / 2)) * away)
    return way - float((before.shift + after.shift).max()), slips


def _least_way(before: Placement, after: Placement, half: Array) -> float:
    """How far each point of a box goes at least from one placement to another [m]."""
    turned = (after.rotation - before.rotation).magnitude()
    parts = apply(Interval(np.zeros_like(turned.hi), turned.hi), exact(half))
    return float((after.translation - before.translation).norm().lo - parts.norm().hi)


def fastest(statement: Statement, drive: Drive, gripper: Gripper) -> float:
    """Speed that no point of the grasp box can exceed [m/s]; infinite if unknown."""
    arm = statement.arm(gripper)
    if arm is None:
        return np.inf
    arms, rate = arms_of(arm), 1 + statement.tolerances.rate
    speed = 0.0
    # By place: a joint of the robot may have a name of these.
    first = 0 if statement.level else len(BASE_JOINTS)
    for k, link in enumerate(arm.chain.links[first:], first):
        most = joint_velocity(statement, link.name) * rate
        speed += most * (arms[k] if link.turns else 1.0)
    if drive is not Drive.FIXED:
        base = statement.twin.robot(statement.robot).base_limits
        inmost = arm.chain.links[first]
        out = float(arm.reach[first]) + float(inmost.before.translation.norm().hi)
        if not inmost.turns:
            out += max(abs(inmost.lower), abs(inmost.upper))
        sideways = statement.tolerances.sideways
        speed += base.linear_velocity * rate + sideways + base.angular_velocity * rate * out
    return speed * (1 + 1e-9)


def joint_velocity(statement: Statement, name: str) -> float:
    """Velocity limit of a joint of the robot [rad/s or m/s]; infinite where it has none."""
    return statement.twin.mechanism(statement.robot).joint(name).limits.velocity


def arms_of(arm: Arm) -> list[float]:
    """How far a point of the grasp box can be from each joint's axis, or origin where it slides [m].

    From the last joint inwards the box lies in a ball, as the joint's frame sees it after its motion, and
    behind the joint in one that holds it wherever the joint is.
    """
    end, links = arm.chain.end, arm.chain.links
    middle = apply(end.rotation, exact(arm.middle)) + end.translation
    radius, arms = float(np.linalg.norm(arm.half)) * (1 + 1e-12), [0.0] * len(links)
    for k in range(len(links) - 1, -1, -1):
        link = links[k]
        along, across = _parted(middle, link.axis)
        far = float((across if link.turns else middle).norm().hi) + radius
        arms[k] = min(far, float(arm.reach[k])) + ROUNDING
        if link.turns:
            middle, radius = along, radius + float(across.norm().hi)
        else:
            half, place = (link.upper - link.lower) / 2, (link.upper + link.lower) / 2
            middle = middle + exact(link.axis) * exact(place)
            radius += abs(half) * float(exact(link.axis).norm().hi) + ROUNDING
        middle = apply(link.before.rotation, middle) + link.before.translation
    return arms


def _parted(vector: Interval, axis: Array) -> tuple[Interval, Interval]:
    """Parts of a vector along a unit axis and across it."""
    along = exact(axis) * (exact(axis) * vector).total()
    return along, vector - along
