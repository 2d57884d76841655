"""Points of convex pieces, kept on disk: a mesh of 100,000 triangles takes seconds to cut up.

A file is named by the hash of all that its points follow from, this code included, and begins with the
hash of the rest of itself: what is not there byte for byte is made anew. Only models of robots are kept,
no scene, path or verdict.
"""

import hashlib
import io
import os
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_DIGEST = hashlib.sha256().digest_size


def folder() -> Path:
    """Where they are kept: `sdt/pieces` in the folder for caches (`XDG_CACHE_HOME`, `~/.cache`)."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "sdt" / "pieces"


def kept(follows_from: Sequence[object], make: Callable[[], list[Array]]) -> list[Array]:
    """Points of each piece, shape (K, 3): read, or made and kept for the next time.

    Args:
        follows_from: All that decides them; its text is the key.
        make: The pieces, where none are kept. A folder that cannot be written keeps nothing.
    """
    path = folder() / hashlib.sha256(repr(follows_from).encode()).hexdigest()
    pieces = _read(path)
    if pieces is None:
        pieces = make()
        _write(path, pieces)
    return pieces


def _read(path: Path) -> list[Array] | None:
    """The pieces of a file that is as it was written; else None."""
    try:
        content = path.read_bytes()
    except OSError:
        return None
    digest, packed = content[:_DIGEST], content[_DIGEST:]
    if hashlib.sha256(packed).digest() != digest:
        return None
    rows = np.load(io.BytesIO(packed), allow_pickle=False)
    return [rows[rows[:, 0] == k, 1:] for k in range(int(rows[-1, 0]) + 1)]


def _write(path: Path, pieces: list[Array]) -> None:
    """A file with number of the piece, x, y, z of each point; it is there whole or not at all."""
    rows = np.concatenate([np.column_stack((np.full(len(each), k), each)) for k, each in enumerate(pieces)])
    packed = io.BytesIO()
    np.save(packed, rows)
    content = packed.getvalue()
    own = path.with_suffix(f".{os.getpid()}")  # two processes may keep the same pieces
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        own.write_bytes(hashlib.sha256(content).digest() + content)
        own.replace(path)
    except OSError:
        return
