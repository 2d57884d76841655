"""Inputs that are no files: reading a pipe may never begin, and reading a device never end."""

import os
import stat
from pathlib import Path

from sdt_kg.errors import InputError

OPENED = ("/dev/stdin", "/dev/fd/", "/proc/self/fd/")
"""How the names of pipes begin that are open already."""


def check_ends(path: Path) -> None:
    """Reading it ends: it is a file, a folder, what nothing is read from (`/dev/null`), or not there.

    A pipe that the shell has opened (`/dev/stdin`, `<(…)`) has somebody who writes.

    Raises:
        InputError: It is a pipe, a socket or a device.
    """
    try:
        found = path.stat()
    except (OSError, ValueError):  # who reads it tells why
        return
    kind = found.st_mode
    if stat.S_ISREG(kind) or stat.S_ISDIR(kind) or os.path.samestat(found, os.stat(os.devnull)):  # noqa: PTH116
        return
    if stat.S_ISFIFO(kind) and str(path).startswith(OPENED):
        return
    raise InputError(
        f"{path} is a pipe or a device, which may never end",
        allowed="a file",
        remedy="write what comes from it to a file first",
    )
