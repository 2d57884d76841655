"""ROS 2 bags as rosbags reads them, but for what unpacks to more than it says, or than fits into memory.

A small file may fill all memory with one: zeros are packed to a thirty-thousandth.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import IO, Any, Final

from sdt_kg.endless import check_ends
from sdt_kg.errors import InputError

METADATA: Final = "metadata.yaml"
"""What ROS 2 writes into the folder of every bag."""

MOST: Final = 2**29
"""[bytes] Of a chunk, of a message, of all files of a folder, unpacked: of chunks recorders write some MB."""


def no_library() -> InputError:
    """That the library for bags is not installed."""
    return InputError("a ROS 2 bag needs the library rosbags", remedy="pip install 'sdt-kg[ros]'")


def check_folder_of_bag(path: Path, allowed: str) -> None:
    """A folder is that of a ROS 2 bag: it has what says so.

    Args:
        path: A folder, or anything else.
        allowed: What could have been given.

    Raises:
        InputError: It is another folder; where recordings lie in it, one of them is named.
    """
    if not path.is_dir():
        return
    try:
        names = sorted(each.name for each in path.iterdir())
    except OSError as error:
        raise InputError(f"the folder {path} cannot be read: {error.strerror}", allowed=allowed) from None
    if METADATA in names:
        return
    inside = next((name for name in names if name.endswith(".mcap")), "")
    raise InputError(
        f"the folder {path} is no ROS 2 bag: it has no {METADATA}",
        allowed=allowed,
        remedy=f"give the file {path / inside}" if inside else "give the file, or the folder of a bag",
    )


def bag_at(path: Path) -> Any:  # noqa: ANN401 - of a library that may not be there
    """The reader of a bag, a context; messages that it does not define are those of ROS 2 Humble.

    Raises:
        InputError: The library is not installed, or a file of the bag is a pipe or a device.
    """
    try:
        from lz4.frame import LZ4FrameDecompressor  # noqa: PLC0415 - of the same extra
        from rosbags.highlevel import AnyReader  # noqa: PLC0415 - an extra
        from rosbags.rosbag2 import reader, storage_mcap  # noqa: PLC0415 - an extra
        from rosbags.typesys import Stores, get_typestore  # noqa: PLC0415 - an extra
    except ImportError:
        raise no_library() from None
    for each in path.iterdir() if path.is_dir() else (path,):
        check_ends(each)
    zstd = storage_mcap.zstd  # pyright: ignore[reportPrivateImportUsage]  # Python's own from 3.14 on
    made = {"zstd": zstd.ZstdDecompressor, "lz4": LZ4FrameDecompressor}
    storage_mcap.DECOMPRESSORS.update({name: partial(unpacked, make) for name, make in made.items()})
    reader.zstd = Bounded(zstd)  # pyright: ignore[reportAttributeAccessIssue, reportPrivateImportUsage]  # as rosbags takes it
    return AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE))


def unpacked(make: Callable[[], Any], data: bytes, size: int) -> bytes:
    """What a chunk unpacks to, and one byte more than it says at most; that it is as many rosbags checks.

    Args:
        make: Makes what unpacks one frame, of which there may be several.
        data: As it was packed.
        size: How many bytes it says it has.

    Raises:
        ValueError: It says that it has too many.
    """
    if size > MOST:
        raise ValueError(f"a chunk would have {size} bytes, and {MOST} at most are read")
    found = b""
    while data and len(found) <= size:
        frame = make()
        found += frame.decompress(data, size + 1 - len(found))
        data = frame.unused_data if frame.eof else b""
    return found


class Bounded:
    """What rosbags unpacks the files and messages of one folder with, as the module that it takes for it."""

    def __init__(self, zstd: Any) -> None:  # noqa: ANN401 - a module, whose name depends on Python's version
        self._zstd, self._held = zstd, 0

    def decompress(self, data: bytes) -> bytes:
        """The message.

        Raises:
            ValueError: It has too many bytes.
        """
        found = unpacked(self._zstd.ZstdDecompressor, data, MOST)
        if len(found) > MOST:
            raise ValueError(f"a message would have more than {MOST} bytes, and no more are read")
        return found

    @contextmanager
    def open(self, file: IO[bytes], mode: str) -> Iterator[SimpleNamespace]:
        """What reads the file."""
        with self._zstd.open(file, mode) as packed:
            yield SimpleNamespace(read=partial(self._read, packed))

    def _read(self, packed: IO[bytes], size: int) -> bytes:
        """The next bytes; raises as `decompress`."""
        part = packed.read(size)
        self._held += len(part)
        if self._held > MOST:
            raise ValueError(
                f"its files would have more than {MOST} bytes, and no more are unpacked; unpack them before"
            )
        return part
