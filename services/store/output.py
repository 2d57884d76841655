"""Files that a command writes: whole, or not at all."""

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

from sdt_kg.errors import InputError


@contextlib.contextmanager
def writing(path: Path) -> Iterator[None]:
    """What the system refuses meanwhile is told as what cannot be written to the file.

    Raises:
        InputError: It cannot be written.
    """
    try:
        yield
    except OSError as error:
        what = (error.strerror or str(error)).lower()
        raise InputError(
            f"cannot write {path}: {what}", remedy="make room, or write to another place"
        ) from None


def place_of(path: Path) -> Path:
    """Where a file lies that is written under this name: where the links end.

    Raises:
        InputError: They end nowhere.
    """
    with writing(path), contextlib.suppress(FileNotFoundError):
        path.stat()  # tells of links that lead in a circle, in every version of Python
    return path.resolve()


def check_file(path: Path) -> None:
    """A file can be put there, and what is there stays: looked at before what is to be written is made.

    Raises:
        InputError: It cannot be written.
    """
    place = place_of(path)
    if _is_replaced(place):
        with writing(path):
            _probe(_partial(place))


def check_folder(folder: Path) -> None:
    """Files can be put into the folder, or into the nearest above it that is there; nothing is made.

    Raises:
        InputError: They cannot be written.
    """
    with writing(folder):
        there = next(each for each in (folder, *folder.parents) if each.exists())
        _probe(_partial(there.resolve() / "folder"))


def write_file(path: Path, content: str | bytes) -> None:
    """The file holds the content, a text as UTF-8; where there is no room for it, it is as it was.

    Raises:
        InputError: It cannot be written.
    """
    raw = content.encode() if isinstance(content, str) else content
    place = place_of(path)
    partial = _partial(place)
    whole = partial if _is_replaced(place) else place
    try:
        with writing(path):
            with os.fdopen(_opened(whole), "wb") as file:
                file.write(raw)
            if whole is partial:
                partial.replace(place)
    finally:
        with contextlib.suppress(OSError):
            partial.unlink(missing_ok=True)


def _partial(place: Path) -> Path:
    """What lies beside a file until it is whole."""
    return place.with_name(f".{place.name}.{os.getpid()}.partial")


def _is_replaced(place: Path) -> bool:
    """Whether another file takes its place; a pipe or a terminal stays one."""
    return place.is_file() or not place.exists()


def _probe(partial: Path) -> None:
    os.close(_opened(partial))
    partial.unlink()


def _opened(path: Path) -> int:
    """A descriptor to write to; one would wait for ever for somebody to read from a pipe."""
    flags = os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_CLOEXEC | os.O_NONBLOCK
    opened = os.open(path, flags, 0o666)
    os.set_blocking(opened, True)
    return opened
