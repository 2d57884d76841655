r"""Two containers seen together: whether one joint follows the other, :math:`q_2 = m q_1 + b`.

Two explanations compete by the Bayesian information criterion: the second joint follows the first, or it
goes its own way, a broken line in time.
"""

import math
from dataclasses import dataclass

import numpy as np

from predicates.learn.articulation import Articulation, Learned
from predicates.learn.track import Array
from sdt_kg.errors import MotionError
from sdt_kg.mechanism import JointType

KNOTS = 12
"""[1] Corners of the broken line in time that a joint of its own would follow."""

LEAST_TOGETHER = 20
"""[1] Samples of the time in which both were seen, at least: more than the broken line has corners."""

LEAST_WAY = 0.02
"""[m] A joint that moves its point by less shows no coupling."""

ROUNDS = 10
"""[1] Rounds of reweighting."""

CUT = 3.0
"""[1] Standard deviations at which a deviation's weight begins to fall (Huber)."""


@dataclass(frozen=True, slots=True)
class Coupled:
    """How a second joint would follow a first.

    Attributes:
        holds: Whether following is the likelier explanation.
        multiplier: m of q2 = m · q1 + b, in the units of the two joints.
        multiplier_deviation: Its standard deviation.
        offset: b [rad or m].
        residual: Root mean square of q2 - m · q1 - b [rad or m].
        evidence: How much likelier following is than a way of its own, as a logarithm.
    """

    holds: bool
    multiplier: float
    multiplier_deviation: float
    offset: float
    residual: float
    evidence: float


def coupled(first: Learned, second: Learned) -> Coupled:
    """Whether the second track's joint follows the first's, both seen at the same times.

    Raises:
        MotionError: No times, too little time together, or one of them does not move.
    """
    for each in (first, second):
        _check(each)
    times, q1, q2 = _together(first, second)
    noise1, noise2 = _noise(first.best), _noise(second.best)
    basis: Array = np.stack([q1, np.ones_like(q1)], axis=1)
    multiplier, offset, weights = _line(basis, q2, noise1, noise2)
    noise = math.hypot(noise2, multiplier * noise1)
    gaps = q2 - multiplier * q1 - offset
    following = float(weights @ gaps**2) / (2 * noise**2)
    corners = _hats(times)
    own = q2 - corners @ np.linalg.lstsq(corners, q2)[0]
    alone = float(own @ own) / (2 * noise2**2)
    evidence = alone - following + (KNOTS - 2) / 2 * math.log(len(times))
    deviation = noise * math.sqrt(float(np.linalg.inv(basis.T @ basis)[0, 0]))
    return Coupled(evidence > 0, multiplier, deviation, offset, float(np.sqrt(np.mean(gaps**2))), evidence)


def _check(learned: Learned) -> None:
    joint, name = learned.best, learned.track.name
    if not learned.track.timed:
        raise MotionError(f"{name} has no times", allowed="a column t, the same clock in both tracks")
    way = (joint.limits[1] - joint.limits[0]) * (joint.radius or 1.0)
    if joint.joint_type is JointType.FIXED or way < LEAST_WAY:
        raise MotionError(f"{name} does not move", allowed=f"a way of {LEAST_WAY} m or more")


def _together(first: Learned, second: Learned) -> tuple[Array, Array, Array]:
    """Times of the second track within the first's, and both joints' positions then."""
    begin, end = first.track.times[[0, -1]]
    inside = (second.track.times >= begin) & (second.track.times <= end)
    times = second.track.times[inside]
    if len(times) < LEAST_TOGETHER:
        raise MotionError(
            f"{first.track.name} and {second.track.name} have {len(times)} samples at the same time",
            allowed=f"{LEAST_TOGETHER} or more",
        )
    q1: Array = np.interp(times, first.track.times, first.best.positions)
    return times, q1, second.best.positions[inside]


def _noise(joint: Articulation) -> float:
    """Standard deviation of a joint's positions [rad or m], as the deviations across its path are."""
    return joint.scale / (joint.radius or 1.0)


def _line(basis: Array, q2: Array, noise1: float, noise2: float) -> tuple[float, float, Array]:
    """Multiplier, offset and Huber's weights of the samples."""
    weights: Array = np.ones(len(q2))
    multiplier, offset = 0.0, 0.0
    for _ in range(ROUNDS):
        left: Array = (basis * weights[:, None]).T @ basis
        multiplier, offset = (float(each) for each in np.linalg.solve(left, basis.T @ (weights * q2)))
        gaps = np.abs(q2 - multiplier * basis[:, 0] - offset) / math.hypot(noise2, multiplier * noise1)
        weights = np.asarray(1 / np.maximum(gaps / CUT, 1.0), dtype=np.float64)
    return multiplier, offset, weights


def _hats(times: Array) -> Array:
    """Hat functions of a broken line with KNOTS corners, shape (T, KNOTS)."""
    corners: Array = np.linspace(float(times[0]), float(times[-1]), KNOTS)
    return np.stack([np.interp(times, corners, row) for row in np.eye(KNOTS)], axis=1)
