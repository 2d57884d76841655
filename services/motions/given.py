"""Named arrays as a file gives them, checked where they are first looked at."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from sdt_kg.errors import MotionError, meant
from sdt_kg.motion import LARGEST, SHORTEST, Array

ALLOWED = (
    "times, base, robot_joint_names, robot_positions (a robot's motion); "
    "joint, times, values or frame, times, poses (a container's)"
)

KNOWN = (
    *("times", "base", "robot_joint_names", "robot_positions", "kitchen_joint_names", "kitchen_positions"),
    *("robot_velocities", "base_velocities", "kitchen_velocities", "robot", "gripper", "base_frame"),
    *("phase_names", "phase_starts", "joint", "values", "velocities", "frame", "poses", "timed"),
)
"""Names of arrays that mean something; a file may have others, of its own."""

Arrays = Mapping[str, np.ndarray]

NO_REALS = "bcmM"
"""Kinds of arrays that numpy would turn into numbers though they are none, or lose a part or a unit: truth
values, complex, durations, dates."""


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

    def check_names(self) -> None:
        """No array that is optional is left out because its name is misspelled, or abbreviated.

        Raises:
            MotionError: One may be.
        """
        missing = [name for name in KNOWN if name not in self.arrays]
        for name in self.arrays:
            near = None if name in KNOWN else meant(name, missing) or _abbreviated(name, missing)
            if near:
                raise MotionError(
                    f"there is an array '{name}', which means nothing",
                    allowed=f"did you mean '{near}'?",
                    remedy="rename it, or leave it out",
                )

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
        return str(_texts(name, array).item())

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
        array = self._reals(name, columns)
        fits = array.ndim == len(shape) and all(
            b in (None, a) for a, b in zip(array.shape, shape, strict=True)
        )
        if not fits:
            wanted = ", ".join("T" if each is None else str(each) for each in shape)
            raise MotionError(f"'{name}' has the shape {array.shape}", allowed=f"({wanted})")
        wrong = np.argwhere(~(np.abs(array) <= LARGEST))  # also what is not a number
        if wrong.size:
            at = tuple(wrong[0].tolist())
            value = array[at]
            found = f"is {value:g}" if np.isfinite(value) else "is not a number"
            of, where = self._place(at, columns)
            raise MotionError(f"'{name}'{of} {found}{where}", allowed=f"finite numbers up to {LARGEST:g}")
        return array

    def _reals(self, name: str, columns: tuple[str, ...]) -> Array:
        array = self.arrays[name]
        if array.dtype.kind in NO_REALS:
            raise MotionError(f"'{name}' holds {array.dtype}", allowed="real numbers")
        try:
            return np.asarray(array, dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            at, cell = next((at, cell) for at, cell in np.ndenumerate(array) if not _is_real(cell))
        of, where = self._place(at, columns)
        raise MotionError(f"'{name}'{of} is '{str(cell)[:40]}'{where}", allowed="real numbers")

    def _place(self, at: tuple[int, ...], columns: tuple[str, ...]) -> tuple[str, str]:
        """Whose value is there, and in which sample, in words."""
        of = f" of {columns[at[1]]}" if len(at) > 1 and at[1] < len(columns) else ""
        return of, (f" at {self.at(at[0])}" if at else "")

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
        names = tuple(str(each) for each in _texts(name, array).ravel())
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


def _abbreviated(name: str, known: Iterable[str]) -> str | None:
    """The known name whose words this one begins, if there is one: robot_vel; a letter alone is none."""
    words = name.lower().split("_")
    for each in known:
        whole = each.split("_")
        alike = len(whole) == len(words) and all(map(str.startswith, whole, words))
        if alike and all(words) and len(name) > 2:
            return each
    return None


def _texts(name: str, array: np.ndarray) -> np.ndarray:
    """Texts that can be read, which numpy keeps as bytes too."""
    try:
        texts = np.char.decode(array, "utf-8") if array.dtype.kind == "S" else array
    except UnicodeDecodeError:
        raise MotionError(f"'{name}' holds bytes that are no text", allowed="UTF-8") from None
    unseen = next((each for each in texts.ravel().tolist() if not each.isprintable()), None)
    if unseen is not None:  # it would be told as it is, and a line break may forge a verdict
        raise MotionError(f"'{name}' holds {unseen[:80]!r}", allowed="names without control characters")
    return texts


def _is_real(cell: object) -> bool:
    try:
        np.asarray(cell, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        return False
    return True
