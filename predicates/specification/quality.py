"""J: qualities of a certified body motion."""

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np

from predicates.case import Answer
from predicates.margins import CLEARANCES
from predicates.specification.cubic import Array, Cubic
from predicates.specification.model import Quality
from sdt_kg.mechanism import Mechanism
from sdt_kg.motion import BodyMotion

UNITS: Final = {
    Quality.TIME: "s",
    Quality.ENERGY: "1/s3",
    Quality.WORK: "J",
    Quality.PATH_LENGTH: "rad and m",
    Quality.BASE_TRAVEL: "m",
    Quality.CLEARANCE: "m",
}
"""Unit of each quality; of ENERGY (rad2 or m2)/s3, of joints that turn and that slide added up."""

NODES: Final = 8
"""[1] Of the Gauss rule for the way of the base on each piece; exact for straight pieces."""

Work = Callable[[BodyMotion], float | None]
"""Mechanical work of a body motion [J]; None where masses are not known."""


def measured(
    quality: Quality, motion: BodyMotion, performed: Answer, work: Work = lambda motion: None
) -> float | None:
    """J of a certified body motion, in the unit of `UNITS`; None where its oracle does not measure it.

    TIME from the first sample to the last; ENERGY the integral of squared acceleration over joints and
    base, exact on the splines; PATH_LENGTH the way of all robot joints, from extremum to extremum, base
    apart; BASE_TRAVEL the way of the base's origin over the floor, by quadrature; CLEARANCE the
    certified smallest distance to the kitchen or itself, allowed contact apart, `LOOKED_UP_TO` where nothing
    is nearer; WORK what `work` says.
    """
    if quality is Quality.WORK:
        return work(motion)
    if quality is Quality.CLEARANCE:
        figures = [performed.figures[name][0] for name in CLEARANCES if name in performed.figures]
        return min(figures) if figures else None
    if quality is Quality.TIME:
        return float(motion.times[-1] - motion.times[0])
    joints = Cubic(motion.times, motion.q, motion.v)
    base = Cubic(motion.times, motion.base, motion.base_v)
    if quality is Quality.ENERGY:
        return _squared_acceleration(joints) + _squared_acceleration(base)
    if quality is Quality.PATH_LENGTH:
        return float(np.abs(np.diff(joints.at(joints.refined()), axis=0)).sum())
    return _way(motion.times, base)


def unweighed(robot: Mechanism) -> tuple[str, ...]:
    """Bodies that have a shape and no mass in the robot's model: WORK knows nothing of what they weigh."""
    bodies = (each for each in robot.bodies if each.collision)
    return tuple(sorted(each.name for each in bodies if each.inertia is None or each.inertia.mass <= 0))


def total(quality: Quality, values: Sequence[float | None]) -> float | None:
    """J of a sequence: the sum, for CLEARANCE the smallest; None of no steps, or where one's is not known."""
    known = [each for each in values if each is not None]
    if not known or len(known) < len(values):
        return None
    return min(known) if quality is Quality.CLEARANCE else sum(known)


def better(quality: Quality, one: float, other: float) -> bool:
    """Whether one value of J is better than another: less, for CLEARANCE more."""
    return one > other if quality is Quality.CLEARANCE else one < other


def _squared_acceleration(spline: Cubic) -> float:
    """Integral of the squared second derivative, which is linear on each piece."""
    begin, end = spline.accelerations()
    return float((spline.duration / 3 * (begin**2 + begin * end + end**2)).sum())


def _way(times: Array, base: Cubic) -> float:
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    at = times[:-1, None] + (nodes + 1) / 2 * base.duration
    speed = np.linalg.norm(base.velocity(at.ravel())[:, :2], axis=1).reshape(at.shape)
    return float((speed * weights * base.duration / 2).sum())
