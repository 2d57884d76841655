"""What was written to a store directory and is not yet in its tables: a file that is only added to."""

import struct
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from io import FileIO
from pathlib import Path
from typing import Final

import pyoxigraph as ox

from sdt_kg.errors import StoreRejectedError

MARK: Final = b"sdt1"
"""Begins each entry, and says how it is written."""

_HEAD: Final = struct.Struct(">4sII")
"""Mark, length of what follows [bytes], its CRC-32."""


@dataclass(frozen=True, slots=True)
class Entry:
    """One change of a store: done whole, or not at all.

    Attributes:
        emptied: Named graph that loses what it has first; None for no graph.
        quads: Added then.
    """

    emptied: ox.NamedNode | None
    quads: Sequence[ox.Quad]


class Journal:
    """The file. What was added to it is there when `add` returns, also if this process is killed then.

    Attributes:
        path: There while it holds something; the caller sees to it that one process at a time has it.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._file: FileIO | None = None

    def add(self, entry: Entry) -> None:
        """The entry is at the end of the file.

        Raises:
            StoreRejectedError: It cannot be written; the file is as it was.
        """
        body = _text(entry)
        if self._file is None:
            self._file = self._begun()
        end = self._file.tell()
        try:
            left = memoryview(_HEAD.pack(MARK, len(body), zlib.crc32(body)) + body)
            while left:
                left = left[self._file.write(left) :]
        except OSError as error:
            self._file.truncate(end)
            self._file.seek(end)
            raise self._unwritable(error) from None

    def entries(self) -> Iterator[Entry]:
        """What is there, in the order in which it was added.

        An end that is too short was being written when its process was killed: it was not acknowledged.

        Raises:
            StoreRejectedError: The file is damaged.
        """
        held, at = self.path.read_bytes() if self.path.exists() else b"", 0
        while len(held) - at >= _HEAD.size:
            mark, length, checksum = _HEAD.unpack_from(held, at)
            body = held[at + _HEAD.size : at + _HEAD.size + length]
            whole = len(body) == length
            if mark != MARK or (whole and zlib.crc32(body) != checksum):
                raise StoreRejectedError(
                    str(self.path),
                    f"is damaged at byte {at}",
                    remedy="take a backup; or delete this file, which loses what was written last",
                )
            if not whole:
                return
            yield _entry(body)
            at += _HEAD.size + length

    def clear(self) -> None:
        """Nothing is there any more."""
        self.close()
        self.path.unlink(missing_ok=True)

    def _begun(self) -> FileIO:
        try:
            return FileIO(self.path, "a")
        except OSError as error:
            raise self._unwritable(error) from None

    def _unwritable(self, error: OSError) -> StoreRejectedError:
        return StoreRejectedError(
            str(self.path),
            f"cannot be written: {error.strerror}",
            remedy="make room for it, and let its directory be there",
        )

    def close(self) -> None:
        """The file is let go; what it holds stays."""
        if self._file is not None:
            self._file.close()
            self._file = None


def _text(entry: Entry) -> bytes:
    """A line with the emptied graph, or without, and N-Quads."""
    quads = ox.serialize(entry.quads, format=ox.RdfFormat.N_QUADS)
    assert quads is not None, "no output was given"
    return f"{entry.emptied or ''}\n".encode() + quads


def _entry(body: bytes) -> Entry:
    name, _, quads = body.partition(b"\n")
    emptied = ox.NamedNode(name.decode()[1:-1]) if name else None
    return Entry(emptied, list(ox.parse(quads, format=ox.RdfFormat.N_QUADS)))
