"""τ for a goal: the actuated joint moves, from rest to rest, as smoothly and as fast as it may."""

import math

import numpy as np

from sdt_kg.errors import OracleRejectedError
from sdt_kg.iri import Iri, local_name
from sdt_kg.mechanism import JointType
from sdt_kg.motion import LARGEST, Motion
from sdt_kg.state import Interval
from sdt_kg.twin import Twin
from services.physics.chain import follower
from services.physics.replay import Bounds, effective_bounds
from services.physics.spline import Hermite, at_rest_velocities
from services.physics.tree import Model

SAMPLES = 33
"""[1] Samples of a generated motion; the spline through them is within 1e-5 of the quintic."""

HINGE_DEPTH = 0.005
"""[rad] How deep into the goal a motion goes, at least: the tool may slip by 2 mm on the handle, which at
0.4 m from a hinge is as much. What is beyond that the robot would have to reach for nothing."""

SLIDE_DEPTH = 0.003
"""[m] The same of a slide: more than the tool may slip."""

NARROW = 0.015
"""[rad or m] A goal of no more is gone through to its end: a container is closed to its lower limit."""

LIMIT_SHARE = 0.99
"""[1] Share of the velocity and acceleration limits that a generated motion uses."""


def generate(model: Model, twin: Twin, joint: Iri, goal: Interval) -> Motion | None:
    """Motion of a joint into an interval: a quintic in time, at rest at both ends; None if it hardly can.

    Not timed: whoever follows it may be slower.

    Args:
        model: Built from the twin's environment.
        twin: The kitchen in the state in which the motion begins, outside the goal.
        joint: The joint that moves: a container's own.
        goal: Where it is to end [rad or m].

    Raises:
        OracleRejectedError: The goal lies outside the joint's limits, or the joint has neither a
            velocity nor an acceleration limit.
    """
    followed = follower(model, joint)
    bounds = effective_bounds(model, twin, followed)
    if is_stuck(bounds):
        return None
    begin = followed.multiplier * twin.state.get(followed.active, 0.0) + followed.offset
    slides = twin.mechanism(twin.environment).joint(local_name(joint)).type is JointType.PRISMATIC
    depth, name = SLIDE_DEPTH if slides else HINGE_DEPTH, local_name(joint)
    target = _target(begin, max(goal.lower, bounds.lower), min(goal.upper, bounds.upper), depth, name)
    u = np.linspace(0, 1, SAMPLES)
    values = (begin + (target - begin) * u**3 * (10 + u * (6 * u - 15)))[:, None]
    spline = Hermite(u, values[:, 0], at_rest_velocities(u, values)[:, 0])
    speed, acceleration = (
        float(np.abs(each).max()) for _, each in (spline.velocity(), spline.acceleration())
    )
    duration = max(
        speed / (LIMIT_SHARE * bounds.velocity), math.sqrt(acceleration / (LIMIT_SHARE * bounds.acceleration))
    )
    if duration == 0:
        raise OracleRejectedError(f"{name} has no limit of velocity or acceleration")
    if duration > LARGEST:
        return None
    return Motion(joint, u * duration, values, timed=False)


def is_stuck(bounds: Bounds) -> bool:
    """Whether a joint, or one that it moves with, has no speed or acceleration to move with."""
    return min(bounds.velocity, bounds.acceleration) <= 0


def _target(begin: float, lower: float, upper: float, depth: float, name: str) -> float:
    """A point inside [lower, upper], so deep from the edge at which the motion enters; or at the other."""
    if lower > upper:
        raise OracleRejectedError(f"no position of {name} within its limits lies in the goal")
    deep = depth if upper - lower > NARROW else upper - lower
    return lower + deep if begin < lower else upper - deep
