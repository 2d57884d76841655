"""Files that a command writes: whole, or not at all."""

import contextlib
import os
from pathlib import Path

from sdt_kg.errors import InputError


def write_file(path: Path, content: str | bytes) -> None:
    """The file holds the content, a text as UTF-8; where there is no room for it, it is as it was.

    Raises:
        InputError: It cannot be written.
    """
    raw = content.encode() if isinstance(content, str) else content
    place = path.resolve()
    partial = place.with_name(f".{place.name}.{os.getpid()}.partial")
    whole = partial if place.is_file() or not place.exists() else place  # a pipe or a terminal stays one
    try:
        whole.write_bytes(raw)
        if whole is partial:
            partial.replace(place)
    except OSError as error:
        with contextlib.suppress(OSError):
            partial.unlink(missing_ok=True)
        what = (error.strerror or str(error)).lower()
        raise InputError(
            f"cannot write {path}: {what}", remedy="make room, or write to another place"
        ) from None
