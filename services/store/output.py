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


def write_file(path: Path, content: str | bytes) -> None:
    """The file holds the content, a text as UTF-8; where there is no room for it, it is as it was.

    Raises:
        InputError: It cannot be written.
    """
    raw = content.encode() if isinstance(content, str) else content
    place = place_of(path)
    partial = place.with_name(f".{place.name}.{os.getpid()}.partial")
    whole = partial if place.is_file() or not place.exists() else place  # a pipe or a terminal stays one
    try:
        with writing(path):
            with os.fdopen(_opened(whole), "wb") as file:
                file.write(raw)
            if whole is partial:
                partial.replace(place)
    finally:
        with contextlib.suppress(OSError):
            partial.unlink(missing_ok=True)


def _opened(path: Path) -> int:
    """A descriptor to write to; one would wait for ever for somebody to read from a pipe."""
    flags = os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_CLOEXEC | os.O_NONBLOCK
    opened = os.open(path, flags, 0o666)
    os.set_blocking(opened, True)
    return opened
