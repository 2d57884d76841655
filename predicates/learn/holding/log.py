"""A log with force: way along the learned path, force along it, and their noise."""

import math
from dataclasses import dataclass

import numpy as np

from predicates.learn.articulation import Articulation
from predicates.learn.fitting.vectors import cross
from predicates.learn.track import Array, Track
from sdt_kg.errors import MotionError
from sdt_kg.mechanism import JointType

SMOOTHING = 0.02
"""[1] Share of the samples in a moving mean, at least LEAST_WINDOW: 0.1 s of a log of 5 s."""

LEAST_WINDOW = 5
"""[1] Samples in the shortest moving mean."""

LEFT = 0.012
"""[m] A container that is farther than this from its place has left it: six times usual noise."""


@dataclass(frozen=True, slots=True, eq=False)
class Log:
    """Way [m], force along it [N] and times of each sample, with their noise and the moving mean's length."""

    way: Array
    force: Array
    times: Array
    way_noise: float
    force_noise: float
    window: int

    def smooth(self, values: Array) -> Array:
        """Centred moving mean, shorter at the ends, shape (T,)."""
        ones = np.ones(self.window)
        return np.convolve(values, ones, "same") / np.convolve(np.ones(len(values)), ones, "same")


def along(track: Track, joint: Articulation) -> tuple[Array, Array]:
    """Way along the joint's path [m], and the force along it [N], shape (T,) each.

    Raises:
        MotionError: The track has no forces, or the joint does not move.
    """
    if track.forces is None:
        raise MotionError(f"{track.name} has no forces", allowed="columns fx fy fz [N]")
    if joint.joint_type is JointType.FIXED:
        raise MotionError(f"{track.name} does not move", allowed="a prismatic or revolute joint")
    if joint.joint_type is JointType.PRISMATIC:
        return joint.positions, track.forces @ joint.axis
    arms = joint.point(joint.positions) - joint.origin
    tangents = cross(joint.axis, arms) / joint.radius
    return joint.positions * joint.radius, np.einsum("ti,ti->t", tangents, track.forces)


def log_of(track: Track, joint: Articulation) -> Log:
    way, force = along(track, joint)
    window = max(LEAST_WINDOW, int(SMOOTHING * len(way)) | 1)
    rest = way[: max(window, left(way, window))]
    zero = float(np.median(rest[: max(window, len(rest) // 4)]))
    return Log(way - zero, force, track.times, _noise(way), _noise(force), window)


def _noise(values: Array) -> float:
    """Standard deviation of white noise on smooth values, from their second differences."""
    second = np.diff(values, 2)
    return float(np.median(np.abs(second))) / 0.6745 / math.sqrt(6) + 1e-9


def left(way: Array, window: int) -> int:
    """First sample at which the container has left its place for good."""
    mean = np.convolve(way, np.ones(window) / window, "same")
    beyond = mean > LEFT
    return int(np.argmax(beyond)) if beyond.any() else len(way)
