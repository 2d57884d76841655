"""Motion (τ, of a container) and BodyMotion (Γ, of a robot)."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import MotionError
from sdt_kg.iri import Iri

Array = NDArray[np.float64]

LARGEST = 1e10
"""[s, rad, m, per s] No number of a motion is larger: doubles then still tell times to 2 µs."""

SHORTEST = 1e-9
"""[s] Samples of a motion are no nearer to each other: splines between them then stay finite."""

ANOTHER = "another robot"
"""Robot of a motion that names none, and most of whose joints the robot that is asked about lacks."""

BASE_JOINTS = ("base_x", "base_y", "base_yaw")
"""Names of the coordinates of a base, x, y [m] and yaw [rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """τ: how a container moves, as articulation values *or* as poses of a frame.

    Attributes:
        of: IRI of the joint (values) or of the body whose frame is meant (poses).
        times: Shape (T,), increasing [s].
        values: Shape (T, 1) [rad or m], or shape (T, 7): x, y, z [m], quaternion xyzw, in the
            environment's root frame.
        timed: Whether the times are a requirement; else a proposal that a robot may slow down.
        velocities: Shape (T, 1), for values only: between samples τ is then the cubic Hermite
            spline of both. Without them it is the C² cubic spline which begins and ends at rest.
    """

    of: Iri
    times: Array
    values: Array
    timed: bool = True
    velocities: Array | None = None

    @property
    def is_poses(self) -> bool:
        """Whether this is a handle-pose path rather than articulation values."""
        return self.values.shape[1] == 7


@dataclass(frozen=True, slots=True, eq=False)
class BodyMotion:
    """Γ: how a robot moves, base first.

    Attributes:
        robot: IRI of the robot.
        gripper: Name of the gripper that acts; empty if not known, or if several do in turn.
        joints: Names of the n robot joints; the base is apart. Not listed: parked.
        times: Shape (T,), increasing [s].
        base: Shape (T, 3): x, y [m], yaw [rad] in the environment's root frame.
        q: Shape (T, n) [rad or m]. Between samples the motion is the cubic Hermite spline of
            q and v, and of base and base_v.
        v: Shape (T, n) [rad/s or m/s].
        base_v: Shape (T, 3).
        kitchen_joints: IRIs of the m kitchen joints whose motion comes with it; may be empty.
        kitchen_q: Shape (T, m).
        kitchen_v: Shape (T, m).
        phases: (name, first sample) of drive, approach, grasp, follow, in order, and where it is held anew of
            let go, leave, return, then drive 2 and so on; no name twice; may be empty.
    """

    robot: Iri
    gripper: str
    joints: tuple[str, ...]
    times: Array
    base: Array
    q: Array
    v: Array
    base_v: Array
    kitchen_joints: tuple[Iri, ...] = ()
    kitchen_q: Array = field(default_factory=lambda: np.zeros((0, 0)))
    kitchen_v: Array = field(default_factory=lambda: np.zeros((0, 0)))
    phases: tuple[tuple[str, int], ...] = ()


def check_times(times: Array) -> None:
    """Times are those of a motion: shape (T,), two or more, increasing, neither too near nor too large.

    Raises:
        MotionError: With the index of the first wrong sample.
    """
    if times.ndim != 1 or len(times) < 2:
        raise MotionError(f"a motion of {times.size} samples", allowed="two samples or more")
    check_numbers("times", times)
    near = np.flatnonzero(np.diff(times) < SHORTEST)
    if near.size:
        raise MotionError(
            f"times do not increase after sample {int(near[0])}",
            allowed=f"times in seconds, each {SHORTEST:g} s or more after the one before",
        )


def check_numbers(name: str, array: Array) -> None:
    """Every number is finite, and not larger than any that a motion has.

    Raises:
        MotionError: With the index of the first wrong sample.
    """
    within = np.abs(array) <= LARGEST  # what is not a number is not
    if not within.all():
        wrong = np.argwhere(~within)
        raise MotionError(
            f"'{name}' of sample {int(wrong[0][0])} is {array[tuple(wrong[0])]:g}",
            allowed=f"finite numbers up to {LARGEST:g}",
        )


def check_body_motion(motion: BodyMotion) -> None:
    """Times are a motion's, arrays have a row for each and a column for each joint, of finite numbers.

    Phases begin at samples that it has, one after the other.

    Raises:
        MotionError: What is wrong, with the index of the first wrong sample where it is one of these.
    """
    check_times(motion.times)
    count, n, m = len(motion.times), len(motion.joints), len(motion.kitchen_joints)
    shapes = {"base": (count, 3), "base_v": (count, 3), "q": (count, n), "v": (count, n)}
    if m:
        shapes |= {"kitchen_q": (count, m), "kitchen_v": (count, m)}
    for name, shape in shapes.items():
        array = getattr(motion, name)
        if array.shape != shape:
            raise MotionError(f"{name} of a body motion has shape {array.shape}", allowed=f"shape {shape}")
        check_numbers(name, array)
    starts = [first for _, first in motion.phases]
    if starts != sorted(starts) or any(first not in range(count) for first in starts):
        said = ", ".join(f"{first}" for first in starts)
        raise MotionError(f"phases start at [{said}]", allowed=f"increasing samples from 0 to {count - 1}")
