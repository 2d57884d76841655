"""Files that hold what was made once: whole as this user wrote them, or made anew.

A file is named by the hash of all that its content follows from, the code that makes it included, and begins
with the hash of the rest of itself: what is not there byte for byte is made anew, and so is what another user
wrote. Only what follows from robots is kept, no scene, path or verdict.
"""

import hashlib
import os
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

_DIGEST = hashlib.sha256().digest_size
_ROOT = 0


def folder(kind: str) -> Path:
    """Where they are kept: `sdt/KIND` in the folder for caches (`XDG_CACHE_HOME`, `~/.cache`)."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "sdt" / kind


def place(kind: str, follows_from: Sequence[object]) -> Path:
    """The file of what follows from that; its text is the key."""
    return folder(kind) / hashlib.sha256(repr(follows_from).encode()).hexdigest()


def read(path: Path) -> bytes | None:
    """What a file holds that is as this user wrote it, or root for all; else None."""
    try:
        with path.open("rb") as file:
            content = file.read() if os.fstat(file.fileno()).st_uid in {os.geteuid(), _ROOT} else b""
    except OSError:
        return None
    digest, kept = content[:_DIGEST], content[_DIGEST:]
    return kept if hashlib.sha256(kept).digest() == digest else None


def write(path: Path, content: bytes) -> None:
    """The file is there whole or not at all; where none can be written, nothing is kept."""
    own = path.with_suffix(f".{os.getpid()}")  # two processes may keep the same
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        own.write_bytes(hashlib.sha256(content).digest() + content)
        own.replace(path)
    except OSError:
        with suppress(OSError):
            own.unlink(missing_ok=True)
