"""Named arrays as a file gives them, checked where they are first looked at."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from sdt_kg.errors import MotionError
from sdt_kg.motion import Array

ALLOWED = (
    "times, base, robot_joint_names, robot_positions (a robot's motion); "
    "joint, times, values or frame, times, poses (a container's)"
)

Arrays = Mapping[str, np.ndarray]


def by_index(sample: int) -> str:
    """Where a sample is, in a file of arrays."""
    return f"index {sample}"


@dataclass(frozen=True, slots=True, eq=False)
class Given:
    """Arrays of a motion, not believed yet.

    Attributes:
        arrays: By name; see README.md.
        at: Where a sample is in the file, in words: its index, or a line.
    """

    arrays: Arrays
    at: Callable[[int], str] = by_index

    def __contains__(self, name: str) -> bool:
        return name in self.arrays

    def text(self, name: str) -> str | None:
        """A single text, None where the file has none."""
        return str(self.arrays[name]) if name in self.arrays else None

    def numbers(self, name: str, shape: tuple[int | None, ...], columns: tuple[str, ...] = ()) -> Array:
        """An array of finite numbers of that shape; None stands for any length.

        Args:
            name: Of the array.
            shape: What it must have.
            columns: Names of its columns, for what is said of a wrong value.

        Raises:
            MotionError: It is missing, of another shape, or holds what is no number.
        """
        if name not in self.arrays:
            raise MotionError(f"the file has no '{name}'", allowed=ALLOWED)
        try:
            array = np.asarray(self.arrays[name], dtype=np.float64)
        except (TypeError, ValueError):
            raise MotionError(f"'{name}' holds {self.arrays[name].dtype}", allowed="numbers") from None
        fits = array.ndim == len(shape) and all(
            b in (None, a) for a, b in zip(array.shape, shape, strict=True)
        )
        if not fits:
            wanted = ", ".join("T" if each is None else str(each) for each in shape)
            raise MotionError(f"'{name}' has the shape {array.shape}", allowed=f"({wanted})")
        wrong = np.argwhere(~np.isfinite(array))
        if wrong.size:
            sample, *column = wrong[0].tolist()
            of = f" of {columns[column[0]]}" if columns and column else ""
            raise MotionError(f"'{name}'{of} is not a number at {self.at(sample)}", allowed="finite numbers")
        return array

    def column(self, name: str, samples: int) -> Array:
        """Shape (T, 1), from (T,) or (T, 1)."""
        if name in self.arrays and self.arrays[name].ndim == 2:
            return self.numbers(name, (samples, 1))
        return self.numbers(name, (samples,))[:, None]

    def names(self, name: str) -> tuple[str, ...]:
        """A list of names, each once.

        Raises:
            MotionError: It holds something else, or a name twice.
        """
        array = self.arrays[name]
        if not array.size:
            return ()
        if array.ndim > 1 or array.dtype.kind not in "US":
            raise MotionError(
                f"'{name}' holds {array.dtype} of shape {array.shape}", allowed="a list of names"
            )
        names = tuple(str(each) for each in array.astype(str).ravel())
        repeated = sorted({each for each in names if names.count(each) > 1})
        if repeated:
            raise MotionError(f"'{name}' names {repeated[0]} twice", allowed="every name once")
        return names

    def times(self) -> Array:
        """Increasing times of two samples or more [s].

        Raises:
            MotionError: There are fewer, or they do not increase.
        """
        times = self.numbers("times", (None,))
        if len(times) < 2:
            raise MotionError(f"the motion has {len(times)} samples", allowed="two or more")
        falling = np.flatnonzero(np.diff(times) <= 0)
        if falling.size:
            k = int(falling[0])
            one, other = f"{self.at(k)} is {times[k]:.6g} s", f"{self.at(k + 1)} is {times[k + 1]:.6g} s"
            raise MotionError(f"times do not increase: {one}, {other}", allowed="strictly increasing times")
        return times
