"""ROS 2 bags as rosbags reads them, but for chunks that unpack to more than they say.

A small file may fill all memory with one: zeros are packed to a thirty-thousandth.
"""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, Final

from sdt_kg.errors import InputError

MOST: Final = 2**29
"""[bytes] Of a chunk, unpacked: recorders write some MB."""


def bag_at(path: Path) -> Any:  # noqa: ANN401 - of a library that may not be there
    """The reader of a bag, a context; messages that it does not define are those of ROS 2 Humble.

    Raises:
        InputError: The library is not installed.
    """
    try:
        from lz4.frame import LZ4FrameDecompressor  # noqa: PLC0415 - of the same extra
        from rosbags.highlevel import AnyReader  # noqa: PLC0415 - an extra
        from rosbags.rosbag2 import storage_mcap  # noqa: PLC0415 - an extra
        from rosbags.typesys import Stores, get_typestore  # noqa: PLC0415 - an extra
    except ImportError:
        raise InputError(
            "a ROS 2 bag needs the library rosbags", remedy="pip install 'sdt-kg[ros]'"
        ) from None
    zstd = storage_mcap.zstd  # pyright: ignore[reportPrivateImportUsage]  # Python's own from 3.14 on
    made = {"zstd": zstd.ZstdDecompressor, "lz4": LZ4FrameDecompressor}
    storage_mcap.DECOMPRESSORS.update({name: partial(unpacked, make) for name, make in made.items()})
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
