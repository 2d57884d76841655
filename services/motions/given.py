"""Named arrays as a file gives them, checked where they are first looked at."""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from sdt_kg.errors import MotionError, meant
from sdt_kg.motion import LARGEST, SHORTEST, Array
from sdt_kg.naming import few

ALLOWED = (
    "times, base, robot_joint_names, robot_positions (a robot's motion); "
    "joint, times, values or frame, times, poses (a container's)"
)

KNOWN = (
    *("times", "base", "robot_joint_names", "robot_positions", "kitchen_joint_names", "kitchen_positions"),
    *("robot_velocities", "base_velocities", "kitchen_velocities", "robot", "gripper", "base_frame"),
    *("joint_names", "joint_positions", "moving_joint_names", "joint_velocities", "base_joint"),
    *("phase_names", "phase_starts", "joint", "values", "velocities", "frame", "poses", "timed"),
)
"""Names of arrays that mean something; a file may have others, of its own."""

Arrays = Mapping[str, np.ndarray]

NO_REALS = "bcmMV"
"""Kinds of arrays that numpy would turn into numbers though they are none, or lose a part or a unit: truth
values, complex, durations, dates, records."""

LONGEST: Final = 200
"""[characters] Of a name: of arrays, joints, robots, phases."""

SHOWN: Final = 3
"""[names] Of columns that an array has to have."""

MOST_ARRAYS: Final = 1000
"""[1] In one motion: those with names of their own mean nothing here."""

MOST_NAMES: Final = 10_000
"""[1] In one array: a hundred times as many as a robot has joints."""


def by_sample(sample: int) -> str:
    """Where a sample is, in a file of arrays and in a bag."""
    return f"sample {sample}"


def place_in(name: str, row: int, at: Callable[[int], str] = by_sample) -> str:
    """Where a row of an array is: in which sample, if it has one for each; else its index."""
    sampled = name in {"times", "base", "values", "poses"} or name.endswith(("positions", "velocities"))
    return at(row) if sampled else f"index {row}"


@dataclass(frozen=True, slots=True, eq=False)
class Given:
    """Arrays of a motion, not believed yet.

    Attributes:
        arrays: By name; see README.md.
        at: Where a sample is in the file, in words: which sample, or a line.
    """

    arrays: Arrays
    at: Callable[[int], str] = by_sample

    def __contains__(self, name: str) -> bool:
        return name in self.arrays

    def check_names(self) -> None:
        """No array that is optional is left out because its name is misspelled, or abbreviated.

        Raises:
            MotionError: One may be, or there are too many to look for that.
        """
        if len(self.arrays) > MOST_ARRAYS:
            raise MotionError(f"there are {len(self.arrays)} arrays", allowed=f"up to {MOST_ARRAYS}")
        missing = [name for name in KNOWN if name not in self.arrays]
        for name in self.arrays:
            check_name(name)
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
            raise MotionError(f"'{name}' {_held(array)}", allowed="one name")
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
            raise MotionError(f"'{name}' {_held(array)}", allowed="true or false")
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
            raise MotionError(f"there is no '{name}'", allowed=ALLOWED)
        array = self._reals(name, columns)
        fits = array.ndim == len(shape) and all(
            b in (None, a) for a, b in zip(array.shape, shape, strict=True)
        )
        if not fits:
            wanted = ", ".join("T" if each is None else str(each) for each in shape)
            whose = f": {few(columns, SHOWN)}" if columns else ""
            raise MotionError(f"'{name}' has the shape {array.shape}", allowed=f"({wanted}){whose}")
        wrong = np.argwhere(~(np.abs(array) <= LARGEST))  # also what is not a number
        if wrong.size:
            at = tuple(wrong[0].tolist())
            value = array[at]
            found = f"is {value:g}" if np.isfinite(value) else "is not a number"
            of, where = self._place(name, at, columns)
            raise MotionError(f"'{name}'{of} {found}{where}", allowed=f"finite numbers up to {LARGEST:g}")
        return array

    def _reals(self, name: str, columns: tuple[str, ...]) -> Array:
        array = self.arrays[name]
        if array.dtype.kind in NO_REALS:
            raise MotionError(f"'{name}' holds {str(array.dtype)[:40]}", allowed="real numbers")
        cells = np.ndenumerate(array) if array.dtype.kind in "USO" else ()
        for at, cell in cells:
            if not _is_real(cell):
                of, where = self._place(name, at, columns)
                remedy = "write numbers without quotes" if isinstance(cell, str | bytes) else ""
                said = f"'{name}'{of} is {str(cell)[:40]!r}{where}"
                raise MotionError(said, allowed="real numbers", remedy=remedy)
        with np.errstate(over="ignore", invalid="ignore"):  # what is infinite then is told by its place
            return np.asarray(array, dtype=np.float64)

    def _place(self, name: str, at: tuple[int, ...], columns: tuple[str, ...]) -> tuple[str, str]:
        """Whose value is there, and in which sample, in words."""
        of = f" of {columns[at[1]]}" if len(at) > 1 and at[1] < len(columns) else ""
        return of, (f" at {place_in(name, at[0], self.at)}" if at else "")

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
            raise MotionError(f"'{name}' {_held(array)}", allowed="a list of names")
        if array.size > MOST_NAMES:
            raise MotionError(f"'{name}' has {array.size} names", allowed=f"up to {MOST_NAMES}")
        names = tuple(str(each) for each in _texts(name, array).ravel())
        repeated = twice(names)
        if repeated is not None:
            raise MotionError(f"'{name}' names {repeated} twice", allowed="every name once")
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
                remedy="leave one of the two samples out" if times[k] == times[k + 1] else "",
            )
        return times


def _held(array: np.ndarray) -> str:
    """What an array is that should be something else: its value, where it is one, else its shape."""
    if array.size == 1:
        return f"is {array.ravel().tolist()[0]!r:.40}"
    return f"holds {str(array.dtype)[:40]} of shape {array.shape}"


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
    for each in texts.ravel().tolist():
        check_name(each, f"'{name}' holds")
    return texts


def check_name(name: str, where: str = "there is the name") -> None:
    """The name can be told as it is: a line break in it may forge a verdict.

    Raises:
        MotionError: It has control characters, or is too long.
    """
    if not name.isprintable():
        raise MotionError(f"{where} {name[:80]!r}", allowed="names without control characters")
    if len(name) > LONGEST:
        said = f"{where} '{name[:40]}…', of {len(name)} characters"
        raise MotionError(said, allowed=f"names of up to {LONGEST}")


def twice(names: Iterable[str]) -> str | None:
    """The first of the names that is there again, if there is one."""
    return next((name for name, times in Counter(names).items() if times > 1), None)


def _is_real(cell: object) -> bool:
    """Whether it is written as a number that is not too large; a text or a truth value is none."""
    if not isinstance(cell, int | float) or isinstance(cell, bool):
        return False
    try:
        float(cell)
    except OverflowError:
        return False
    return True
