"""Named arrays as a file gives them, checked where they are first looked at."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from sdt_kg.errors import MotionError
from sdt_kg.motion import LARGEST, SHORTEST, Array

ALLOWED = (
    "times, base, robot_joint_names, robot_positions (a robot's motion); "
    "joint, times, values or frame, times, poses (a container's)"
)

Arrays = Mapping[str, np.ndarray]

NO_REALS = "cmM"
"""Kinds of arrays that numpy would turn into numbers, losing a part or a unit: complex, durations, dates."""


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
        """A single text, None where the file has none.

        Raises:
            MotionError: It holds something else, or several.
        """
        if name not in self.arrays:
            return None
        array = self.arrays[name]
        if array.size != 1 or array.dtype.kind not in "US":
            raise MotionError(f"'{name}' holds {array.dtype} of shape {array.shape}", allowed="one name")
        return str(array.astype(str).item())

    def flag(self, name: str, default: bool) -> bool:
        """A single truth value; the default where the file has none.

        Raises:
            MotionError: It holds something else, or several.
        """
        if name not in self.arrays:
            return default
        array = self.arrays[name]
        if array.size != 1 or array.dtype.kind != "b":
            raise MotionError(f"'{name}' holds {array.dtype} of shape {array.shape}", allowed="true or false")
        return bool(array.item())

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
        array = _reals(name, self.arrays[name])
        fits = array.ndim == len(shape) and all(
            b in (None, a) for a, b in zip(array.shape, shape, strict=True)
        )
        if not fits:
            wanted = ", ".join("T" if each is None else str(each) for each in shape)
            raise MotionError(f"'{name}' has the shape {array.shape}", allowed=f"({wanted})")
        wrong = np.argwhere(~(np.abs(array) <= LARGEST))  # also what is not a number
        if wrong.size:
            sample, *column = wrong[0].tolist()
            of = f" of {columns[column[0]]}" if columns and column else ""
            value = array[tuple(wrong[0])]
            found = f"is {value:g}" if np.isfinite(value) else "is not a number"
            raise MotionError(
                f"'{name}'{of} {found} at {self.at(sample)}", allowed=f"finite numbers up to {LARGEST:g}"
            )
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
        falling = np.flatnonzero(np.diff(times) < SHORTEST)
        if falling.size:
            k = int(falling[0])
            one, other = f"{self.at(k)} is {times[k]:.6g} s", f"{self.at(k + 1)} is {times[k + 1]:.6g} s"
            raise MotionError(
                f"times do not increase: {one}, {other}",
                allowed=f"times in seconds, each {SHORTEST:g} s or more after the one before",
            )
        return times


def _reals(name: str, array: np.ndarray) -> Array:
    wrong = MotionError(f"'{name}' holds {array.dtype}", allowed="real numbers")
    if array.dtype.kind in NO_REALS:
        raise wrong
    try:
        return np.asarray(array, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise wrong from None
