"""Files of motions: which format by the suffix, the same arrays in all of them."""

import io
import json
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from sdt_kg.endless import check_ends
from sdt_kg.errors import InputError, MotionError
from sdt_kg.iri import Iri
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.twin import Twin
from services.bags import check_folder_of_bag
from services.motions.archive import arrays_in
from services.motions.body import body_arrays, body_motion
from services.motions.columns import read_csv, write_csv
from services.motions.container import container_arrays, frame_motion, joint_motion
from services.motions.given import ALLOWED, Arrays, Given, check_name, twice
from services.motions.lists import array_of
from services.motions.whose import parted
from services.store.output import write_file

BAG = ".mcap"
PLAIN = (
    "JSON has neither comments nor text around it, no comma before a closing bracket, "
    "and names in double quotes"
)
SUFFIXES = (".npz", ".json", ".csv", BAG)
FILES = f"{', '.join(SUFFIXES)} or the folder of a ROS 2 bag"


def read_motion(path: str | Path, twin: Twin, robot: str | Iri | None = None) -> Motion | BodyMotion:
    """The motion in a file, checked against the twin.

    Args:
        path: A .npz, .json, .csv or .mcap file, or a ROS 2 bag directory; README.md has the schemas.
        twin: The kitchen and its robots, whose joints the file names.
        robot: Whose body motion is asked about, by name or IRI; a file that names its robot may leave it
            out. A motion of another robot is given back as such: to refuse it is for CanPerform.

    Raises:
        InputError: No such file, or of no known format.
        MotionError: No readable file of its format, wrong or missing arrays, times that do not increase,
            values that jump, are not numbers or are probably in another unit; with the line or
            sample and the joint.
        UnknownEntityError: A joint or frame which the models lack; the nearest names are told.
    """
    path = Path(path)
    reader = _reader(path)
    try:
        return _motion(reader(path), twin, robot)
    except InputError as error:
        error.be_from(path.name or str(path))
        raise


def read_arrays(path: str | Path) -> Arrays:
    """The arrays in a file, to be sent to who has the models; only their names are checked.

    Raises:
        InputError: No such file, of no known format, or a bag without the library for bags.
        MotionError: No readable file of its format, or an array whose name is nearly one of a motion.
    """
    path = Path(path)
    reader = _reader(path)
    try:
        given = reader(path)
        given.check_names()
    except InputError as error:
        error.be_from(path.name)
        raise
    return given.arrays


def _reader(path: Path) -> Callable[[Path], Given]:
    """Who reads the format of a file.

    Raises:
        InputError: There is none, or of no known format.
    """
    if not path.exists():
        raise InputError(f"no file at {path}")
    check_ends(path)
    check_folder_of_bag(path, FILES)
    if path.is_dir() or path.suffix == BAG:
        from services.motions.ros import read_bag  # noqa: PLC0415 - its library is an extra

        return read_bag
    if path.suffix not in _READERS:
        raise InputError(f"a motion in '{path.name}'", allowed=FILES)
    return _READERS[path.suffix]


def motion_of(
    arrays: Mapping[str, object], twin: Twin, robot: str | Iri | None = None
) -> Motion | BodyMotion:
    """The motion that these arrays are, as in a file, lists for arrays as JSON has them; the same errors."""
    given = {
        name: value if isinstance(value, np.ndarray) else array_of(name, value)
        for name, value in arrays.items()
    }
    return _motion(Given(given), twin, robot)


def _motion(given: Given, twin: Twin, robot: str | Iri | None) -> Motion | BodyMotion:
    robot = next((each for each in twin.robots if twin.name(each) == robot), robot)
    given.check_names()
    given = parted(given, twin, robot)
    whose = [name for name in ("joint", "frame") if name in given]
    if "robot_positions" in given or "base" in given:
        whose.append("base")
    if len(whose) > 1:
        raise MotionError(
            f"the file has '{whose[0]}' and '{whose[1]}': motions of two kinds",
            allowed=ALLOWED,
            remedy="one motion in a file",
        )
    if "base" in whose:
        return body_motion(given, twin, robot)
    if "joint" in given:
        return joint_motion(given, twin)
    if "frame" in given:
        return frame_motion(given, twin)
    raise MotionError(f"the motion has {', '.join(given.arrays) or 'nothing'}", allowed=ALLOWED)


def write_motion(path: str | Path, motion: Motion | BodyMotion) -> None:
    """The motion is in the file, and `read_motion` gives it back: exactly, but of a bag to the nanosecond.

    Raises:
        InputError: The suffix is none of .npz, .json and .csv, nor, of a robot's motion, .mcap; or the
            library for bags is not installed.
    """
    _write(Path(path), arrays_of(motion))


def write_arrays(path: str | Path, arrays: Mapping[str, object]) -> None:
    """The arrays of a motion are in the file; lists will do for arrays.

    Raises:
        InputError: As `write_motion`.
    """
    _write(Path(path), {name: array_of(name, value) for name, value in arrays.items()})


def _write(path: Path, arrays: dict[str, np.ndarray]) -> None:
    writers = dict(_WRITERS)
    if "robot_positions" in arrays:
        from services.motions.ros_out import write_bag  # noqa: PLC0415 - its library is an extra

        writers[BAG] = write_bag
    if path.suffix not in writers:
        raise InputError(f"a motion in '{path.name}'", allowed=", ".join(writers))
    writers[path.suffix](path, arrays)


def check_format(path: Path) -> None:
    """What writes such a file is installed: asked before what is to be written is made.

    Raises:
        InputError: It is not.
    """
    if path.suffix == BAG:
        from services.motions.ros_out import check_library  # noqa: PLC0415 - its library is an extra

        check_library()


def arrays_of(motion: Motion | BodyMotion) -> dict[str, np.ndarray]:
    """The motion as the arrays of a file: `motion_of` gives it back exactly."""
    return body_arrays(motion) if isinstance(motion, BodyMotion) else container_arrays(motion)


def _read_npz(path: Path) -> Given:
    if not zipfile.is_zipfile(path):
        raise MotionError("it is no .npz: its bytes are no zip archive", allowed=ALLOWED)
    try:
        return Given(arrays_in(path))
    except ValueError as error:
        raise MotionError(str(error), allowed=ALLOWED) from None


def _write_npz(path: Path, arrays: dict[str, np.ndarray]) -> None:
    out = io.BytesIO()
    np.savez_compressed(out, **arrays)  # pyright: ignore[reportArgumentType]  # numpy's stub takes **kwds for allow_pickle
    write_file(path, out.getvalue())


def _read_json(path: Path) -> Given:
    try:
        said = json.loads(path.read_text(encoding="utf-8-sig"), object_pairs_hook=_once_each)
    except (UnicodeDecodeError, ValueError, RecursionError) as error:
        raise MotionError(f"it is no JSON: {error}", allowed=ALLOWED, remedy=PLAIN) from None
    if not isinstance(said, dict):
        raise MotionError(f"it holds a {type(said).__name__}", allowed=f"an object with {ALLOWED}")
    return Given({str(name): array_of(str(name), value) for name, value in said.items()})


def _once_each(pairs: list[tuple[str, object]]) -> dict[str, object]:
    said = dict(pairs)
    for name in said:
        check_name(name)
    repeated = twice(name for name, _ in pairs)
    if repeated is not None:
        raise MotionError(f"it has '{repeated}' twice", allowed="every name once")
    return said


def _write_json(path: Path, arrays: dict[str, np.ndarray]) -> None:
    write_file(path, json.dumps({name: array.tolist() for name, array in arrays.items()}))


_READERS: dict[str, Callable[[Path], Given]] = {".npz": _read_npz, ".json": _read_json, ".csv": read_csv}
_WRITERS: dict[str, Callable[[Path, dict[str, np.ndarray]], None]] = {
    ".npz": _write_npz,
    ".json": _write_json,
    ".csv": write_csv,
}
