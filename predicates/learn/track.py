"""Track: an observed motion of one point, or pose, of a mechanism."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import MotionError

Array = NDArray[np.float64]

LEAST_SAMPLES = 8
"""[1] Fewer positions than an arc has parameters (six) and a residual needs say nothing."""


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """What was observed, in one fixed frame, in the order of time.

    Attributes:
        positions: Shape (T, 3) [m]; finite.
        times: Shape (T,), increasing [s]; the sample's number where the source has no times.
        timed: Whether `times` are seconds.
        orientations: Shape (T, 4), unit quaternions xyzw, or None.
        forces: Shape (T, 3) [N] on the handle, in the same frame, or None.
        missing: Samples that the source had no position for; they are left out.
        name: Where it comes from, for messages.
    """

    positions: Array
    times: Array
    timed: bool
    orientations: Array | None = None
    forces: Array | None = None
    missing: int = 0
    name: str = "track"

    def part(self, begin: int, end: int) -> "Track":
        """Samples begin to end - 1."""
        cut = slice(begin, end)
        return Track(
            self.positions[cut],
            self.times[cut],
            self.timed,
            None if self.orientations is None else self.orientations[cut],
            None if self.forces is None else self.forces[cut],
            0,
            self.name,
        )


def checked(track: Track) -> Track:
    """The track, if something can be learned from it.

    Raises:
        MotionError: Too few samples, or arrays that do not fit together.
    """
    samples = len(track.positions)
    if samples < LEAST_SAMPLES:
        lost = f" ({track.missing} more are missing)" if track.missing else ""
        raise MotionError(
            f"{track.name} has {samples} samples{lost}", allowed=f"{LEAST_SAMPLES} positions or more"
        )
    for what, array, width in (
        ("positions", track.positions, 3),
        ("orientations", track.orientations, 4),
        ("forces", track.forces, 3),
    ):
        if array is not None and (array.shape != (samples, width) or not np.isfinite(array).all()):
            raise MotionError(
                f"{what} of {track.name} have the shape {array.shape}, or are not numbers",
                allowed=f"finite numbers of shape ({samples}, {width})",
            )
    falling = np.flatnonzero(np.diff(track.times) <= 0)
    if len(track.times) != samples or falling.size:
        raise MotionError(f"times of {track.name} do not increase", allowed="increasing times")
    return track
