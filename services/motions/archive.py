"""What a .npz holds: plain arrays, each once, and no more of them than fit into memory."""

import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np

MOST: Final = 2**29
"""[bytes] Of all arrays, unpacked: 200,000 samples of 100 joints with velocities are 320 MB."""


def arrays_in(path: Path) -> dict[str, np.ndarray]:
    """Arrays by name.

    Raises:
        ValueError: It is no such archive, or holds too much: 3 MB of zeros, packed, are 3 GB.
    """
    try:
        with zipfile.ZipFile(path) as packed:
            _check(packed.infolist())
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as file:
            return {name: np.asarray(file[name]) for name in file.files}
    except Exception as error:  # noqa: BLE001 - whatever a damaged archive makes zip, zlib or numpy raise
        raise ValueError(f"it is no .npz of plain arrays: {error}") from None


def _check(parts: Sequence[zipfile.ZipInfo]) -> None:
    size, names = sum(each.file_size for each in parts), [each.filename for each in parts]
    if size > MOST:  # no more than is said there is unpacked
        raise ValueError(f"they would have {size} bytes, and {MOST} at most are read")
    if len({*names}) < len(names):
        raise ValueError(f"'{next(each for each in names if names.count(each) > 1)}' is there twice")
