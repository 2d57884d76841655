"""The track in a file, by its kind."""

from pathlib import Path

from predicates.learn.track import Track
from sdt_kg.endless import check_ends
from sdt_kg.errors import InputError
from services.bags import check_folder_of_bag
from services.tracks.arrays import read_arrays
from services.tracks.text import read_text

BAGS = {".mcap", ".db3"}
TEXTS = {".log", ".txt", ".csv", ".tsv", ".dat"}
ALLOWED = ".log, .txt, .csv, .tsv, .dat (columns), .npz, .mcap or a ROS 2 bag's folder"


def read_track(path: Path, *, topic: str | None = None, frame: str | None = None) -> Track:
    """The track in a file.

    Args:
        path: Columns of text, `.npz`, `.mcap`, `.db3` or the folder of a ROS 2 bag.
        topic: Bags: the topic that has the poses, where there are several.
        frame: Bags: the TF frame that is meant, in the root frame of its tree.

    Raises:
        InputError: No such file, or of no kind that is read.
        MotionError: What is wrong in it, with the line or index.
    """
    if not path.exists():
        raise InputError(f"no file at {path}")
    check_ends(path)
    check_folder_of_bag(path, ALLOWED)
    if path.is_dir() or path.suffix in BAGS:
        from services.tracks.bags import read_bag  # noqa: PLC0415 - an extra, and slow to import

        return read_bag(path, topic, frame)
    if topic is not None or frame is not None:
        raise InputError(f"{path.name} is no ROS bag", allowed="--topic and --frame for .mcap and .db3 only")
    if path.suffix == ".npz":
        return read_arrays(path)
    if path.suffix in TEXTS:
        return read_text(path)
    raise InputError(f"no kind of track ends in '{path.suffix}'", allowed=ALLOWED)
