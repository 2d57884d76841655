"""Convex pieces of meshes, kept on disk: a mesh of 100,000 triangles takes seconds to cut up.

A file is named by the hash of all that the pieces follow from, this code included, and begins with the
hash of the rest of itself: what is not there byte for byte is made anew, and so is what another user
wrote. Only models of robots are kept, no scene, path or verdict.
"""

import hashlib
import io
import os
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64] | NDArray[np.int64]

_DIGEST = hashlib.sha256().digest_size
_ROOT = 0


def folder() -> Path:
    """Where they are kept: `sdt/pieces` in the folder for caches (`XDG_CACHE_HOME`, `~/.cache`)."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "sdt" / "pieces"


def kept(follows_from: Sequence[object], make: Callable[[], list[Array]]) -> list[Array]:
    """Arrays of two axes, as they were made: read, or made and kept for the next time.

    Args:
        follows_from: All that decides them; its text is the key.
        make: The arrays, where none are kept. A folder that cannot be written keeps nothing.
    """
    path = folder() / hashlib.sha256(repr(follows_from).encode()).hexdigest()
    arrays = _read(path)
    if arrays is None:
        arrays = make()
        _write(path, arrays)
    return arrays


def _read(path: Path) -> list[Array] | None:
    """The arrays of a file that is as this user wrote it, or root for all; else None."""
    try:
        with path.open("rb") as file:
            content = file.read() if os.fstat(file.fileno()).st_uid in {os.geteuid(), _ROOT} else b""
    except OSError:
        return None
    digest, packed = content[:_DIGEST], content[_DIGEST:]
    return _unpacked(packed) if hashlib.sha256(packed).digest() == digest else None


def _write(path: Path, arrays: list[Array]) -> None:
    """The file is there whole or not at all."""
    packed = _packed(arrays)
    own = path.with_suffix(f".{os.getpid()}")  # two processes may keep the same pieces
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        own.write_bytes(hashlib.sha256(packed).digest() + packed)
        own.replace(path)
    except OSError:
        return


def _packed(arrays: list[Array]) -> bytes:
    """One array of integers: how many there are, of each whether it is of numbers, rows, columns; then all."""
    heads = [(each.dtype == np.float64, *each.shape) for each in arrays]
    parts = [np.ascontiguousarray(each).view(np.int64).ravel() for each in arrays]
    packed = io.BytesIO()
    np.save(packed, np.concatenate([[len(arrays)], np.ravel(heads), *parts]).astype(np.int64))
    return packed.getvalue()


def _unpacked(packed: bytes) -> list[Array]:
    numbers: NDArray[np.int64] = np.load(io.BytesIO(packed), allow_pickle=False)
    at, arrays = 1 + 3 * int(numbers[0]), list[Array]()
    for real, rows, columns in numbers[1:at].reshape(-1, 3).tolist():
        part = numbers[at : at + rows * columns].reshape(rows, columns)
        arrays.append(part.view(np.float64) if real else part)
        at += rows * columns
    return arrays
