"""Trajectory: how a kitchen's joints went, sample by sample; kept as arrays beside the graph."""

import hashlib
import io
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import MotionError, StateError
from sdt_kg.iri import Iri, local_name, trajectory_iri
from sdt_kg.mechanism import Joint
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.twin import Twin

Array = NDArray[np.float64]

START_TOLERANCE: Final = 0.002
"""[rad or m] How far from the twin's state it may begin: the tolerance of the tool on the handle."""

POSITION_SLACK: Final = 1e-4
"""[rad or m] How far beyond a limit a sample may lie, by rounding; it then counts as at the limit."""

HELD_FROM: Final = "follow"
"""Phase of a BodyMotion from whose first sample on the handle is held; in `follow 2` it is held anew."""


@dataclass(frozen=True, slots=True)
class Grasp:
    """A robot holds the handle of what it moves, from a sample on."""

    robot: Iri
    sample: int


def held_from(motion: BodyMotion) -> tuple[int, ...]:
    """First samples of the phases in which the handle is held, in order."""
    told = ((*name.partition(" "), sample) for name, sample in motion.phases)
    return tuple(
        sample
        for name, apart, number, sample in told
        if name == HELD_FROM and (not apart or number.isdecimal())
    )


@dataclass(frozen=True, slots=True, eq=False)
class Trajectory:
    """Articulation values over time.

    Attributes:
        joints: IRIs of m kitchen joints; what mimics them follows.
        times: Shape (T,), increasing [s].
        positions: Shape (T, m) [rad or m].
        grasp: Who held the handle, and from when; None where no robot is known.
        again: Samples at which that robot took it anew, having let go.
    """

    joints: tuple[Iri, ...]
    times: Array
    positions: Array
    grasp: Grasp | None = None
    again: tuple[int, ...] = ()

    @staticmethod
    def of(motion: Motion | BodyMotion) -> "Trajectory":
        """The trajectory of a container's motion, or of the kitchen joints that a body motion moves.

        Raises:
            MotionError: Poses of a frame (Φ turns them into articulation values), no joint, or samples
                that are no motion.
        """
        if isinstance(motion, BodyMotion):
            held = held_from(motion)
            grasp = Grasp(motion.robot, held[0]) if held else None
            made = Trajectory(motion.kitchen_joints, motion.times, motion.kitchen_q, grasp, held[1:])
        elif motion.is_poses:
            raise MotionError(
                "a path of poses has no articulation values",
                allowed="shape (T, 1)",
                remedy="replay it: Causes answers with the articulation values",
            )
        else:
            made = Trajectory((motion.of,), motion.times, motion.values)
        return made._checked()

    def _checked(self) -> "Trajectory":
        samples, joints = len(self.times), len(self.joints)
        if not joints or samples < 2 or self.positions.shape != (samples, joints):
            raise MotionError(
                f"{samples} times and positions of shape {self.positions.shape} for {joints} kitchen joints",
                allowed="at least one joint, two samples, positions of shape (T, m)",
            )
        finite = np.isfinite(self.times).all() and np.isfinite(self.positions).all()
        if not finite or (np.diff(self.times) <= 0).any():
            raise MotionError("times or positions are no motion", allowed="finite numbers, increasing times")
        return self

    @property
    def duration(self) -> float:
        """Time from the first to the last sample [s]."""
        return float(self.times[-1] - self.times[0])

    @property
    def iri(self) -> Iri:
        """The hash of the samples."""
        return trajectory_iri(hashlib.sha256(self._content()).hexdigest())

    def _content(self) -> bytes:
        """What is hashed: an archive's bytes would depend on the library's version."""
        again = (repr(self.again),) if self.again else ()
        head = "\n".join((*self.joints, repr(self.grasp), *again, repr(self.positions.shape)))
        arrays = (self.times.astype("<f8").tobytes(), self.positions.astype("<f8").tobytes())
        return b"\n".join((head.encode(), *arrays))

    def at(self, twin: Twin, sample: int) -> Twin:
        """G_k: the twin at a sample, counted from 0; negative ones from the end.

        Raises:
            MotionError: No such sample.
            StateError: Outside the twin's limits, or joints that contradict each other.
        """
        count = len(self.times)
        if not -count <= sample < count:
            raise MotionError(f"no sample {sample}", allowed=f"0 to {count - 1}")
        coupling = twin.entities.coupling
        changes: dict[Iri, float] = {}
        for joint, value in zip(self.joints, self.positions[sample].tolist(), strict=True):
            follower = coupling.followers.get(joint)
            if follower is None or follower.active not in self.joints:
                changes[joint] = _rounded(coupling.joints.get(joint), value)
        return twin.at(changes)

    def check_start(self, twin: Twin) -> None:
        """That the trajectory begins in the twin's state; StateError says where it does not."""
        for joint, value in zip(self.joints, self.positions[0].tolist(), strict=True):
            at = twin.state.get(joint, value)
            if abs(at - value) > START_TOLERANCE:
                raise StateError(
                    f"the trajectory begins with '{local_name(joint)}' at {value:g}",
                    allowed=f"{at:g}, where it is, within {START_TOLERANCE:g}",
                )

    def to_bytes(self) -> bytes:
        """As an npz archive."""
        out = io.BytesIO()
        robot, sample = ("", -1) if self.grasp is None else (self.grasp.robot, self.grasp.sample)
        np.savez_compressed(
            out,
            joints=np.array(self.joints, dtype=np.str_),
            times=self.times,
            positions=self.positions,
            robot=np.array(robot, dtype=np.str_),
            held_from=np.array(sample, dtype=np.int64),
            held_again=np.array(self.again, dtype=np.int64),
        )
        return out.getvalue()

    @staticmethod
    def from_bytes(content: bytes) -> "Trajectory":
        """The trajectory of an npz archive that `to_bytes` wrote.

        Raises:
            MotionError: It is no such archive.
        """
        try:
            with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
                joints: Sequence[str] = arrays["joints"].tolist()
                robot, held = str(arrays["robot"]), int(arrays["held_from"])
                again = tuple(map(int, arrays["held_again"])) if "held_again" in arrays else ()
                times, positions = (np.asarray(arrays[name], np.float64) for name in ("times", "positions"))
        except (ValueError, KeyError, OSError, EOFError, TypeError, zipfile.BadZipFile) as error:
            raise MotionError(f"no archive of a trajectory: {error}") from None
        grasp = Grasp(robot, held) if robot else None
        return Trajectory(tuple(joints), times, positions, grasp, again)._checked()


def _rounded(joint: Joint | None, value: float) -> float:
    """The value, or the limit if it is beyond that by rounding."""
    if joint is None:
        return value
    nearest = min(max(value, joint.limits.lower), joint.limits.upper)
    return nearest if abs(nearest - value) <= POSITION_SLACK else value
