r"""Whether a container's timed motion is too fast for any hand that holds its handle, whatever its posture.

Between two samples of τ a point of the handle goes from one place to another, a distance d apart in a
time t. Held, it keeps its place in the tool to within the slip that certification allows; so a point of
the hand makes that way but for the slip, and no joint may exceed its velocity limit by more than `rate`:

.. math:: d - slip \le t \sum_j \dot q_j^{max} (1 + rate) \, r_j,

where r_j is the largest distance that the point can have from the axis of joint j (1 for a slide), for
lengths add up. If that is false for every gripper, no motion keeps these times.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Drive, Gripper
from services.embodiment.proof_check.arm import ROUNDING, Arm
from services.embodiment.proof_check.content import Timing
from services.embodiment.proof_check.statement import BASE, Statement

Array = NDArray[np.float64]

MOST_SAMPLES = 100_000


def too_fast(statement: Statement, drive: Drive, timing: Timing, window: tuple[int, int]) -> Iterator[str]:
    """Why the window of τ does not show that no gripper can follow; nothing if it does."""
    first, last = window
    if len(timing.times) > MOST_SAMPLES or not (np.diff(timing.times) > 0).all():
        yield f"the motion's times do not increase, or are more than {MOST_SAMPLES}"
    elif not 0 <= first < last < len(timing.times):
        yield f"the motion has no samples {first} to {last}"
    else:
        way, slip = travelled(statement, timing.values[first], timing.values[last])
        time = timing.times[last] - timing.times[first]
        if not statement.grippers:
            yield "the robot has no gripper: nothing to refute"
        for gripper in statement.grippers:
            most = fastest(statement, drive, gripper)
            if not way - slip[gripper.name] > most * time + ROUNDING:
                yield f"{gripper.name} may move {most * time:.3g} m in {time:.3g} s, {way:.3g} m are asked"


def travelled(statement: Statement, one: float, other: float) -> tuple[float, dict[str, float]]:
    """How far a point of the handle goes at least between two values [m], and of it what may be slip."""
    before, after = (statement.target(value) for value in (one, other))
    if not before.boxes:
        return 0.0, {gripper.name: 0.0 for gripper in statement.grippers}
    way = (after.boxes[0].translation - before.boxes[0].translation).norm().lo
    kept = statement.tolerances
    slips: dict[str, float] = {}
    for gripper in statement.grippers:
        arm = statement.arm(gripper)
        turned = 2 * np.sin(kept.tool_angle / 2) * (0.0 if arm is None else _radius(statement, arm))
        slips[gripper.name] = 2 * (kept.tool_position + float(turned))
    return float(way) - float(before.shift[0] + after.shift[0]), slips


def fastest(statement: Statement, drive: Drive, gripper: Gripper) -> float:
    """Speed that no point of the handle can exceed while the gripper holds it [m/s]; infinite if unknown."""
    arm = statement.arm(gripper)
    if arm is None:
        return np.inf
    handle = _diameter(statement) + 2 * statement.tolerances.tool_position
    rate = 1 + statement.tolerances.rate
    speed = 0.0
    own = [k for k, link in enumerate(arm.chain.links) if link.name not in BASE]
    for k in own:
        link = arm.chain.links[k]
        most = statement.joint_velocity(link.name) * rate
        speed += most * (float(arm.reach[k]) + handle if link.turns else 1.0)
    if drive is not Drive.FIXED:
        base = statement.base_limits
        first = arm.chain.links[own[0]]
        out = float(arm.reach[own[0]]) + handle + float(first.before.translation.norm().hi)
        if not first.turns:
            out += max(abs(first.lower), abs(first.upper))
        sideways = statement.tolerances.sideways
        speed += base.linear_velocity * rate + sideways + base.angular_velocity * rate * out
    return speed * (1 + 1e-9)


def _diameter(statement: Statement) -> float:
    """Of the handle, so that any point of it is so near to any other [m]; at the state's own value."""
    target = statement.target(statement.twin.state[statement.container.joint])
    middles = np.array([(box.translation.lo + box.translation.hi) / 2 for box in target.boxes])
    spread = np.linalg.norm(middles[:, None] - middles[None], axis=2).max(initial=0.0)
    return float(spread + 2 * np.linalg.norm(target.half, axis=1).max(initial=0.0))


def _radius(statement: Statement, arm: Arm) -> float:
    """How far the handle's point can be from the tool's origin [m]."""
    return float(np.linalg.norm(np.abs(arm.middle) + arm.half)) + _diameter(statement)
