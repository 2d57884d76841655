"""What a .npz holds: plain arrays, each once, and no more of them than fit into memory."""

import math
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np

from services.motions.given import check_name, twice

MOST: Final = 2**29
"""[bytes] Of all arrays, unpacked: 200,000 samples of 100 joints with velocities are 320 MB."""

FLOAT: Final = 8
"""[bytes] Of a cell, once it is a number."""

SUFFIX: Final = ".npy"
HEADERS: Final = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
"""How a header is read, by the version of the format; in another one only records are written."""


def arrays_in(path: Path) -> dict[str, np.ndarray]:
    """Arrays by name.

    Raises:
        ValueError: It is no such archive, or holds too much: 3 MB of zeros, packed, are 3 GB.
    """
    try:
        with zipfile.ZipFile(path) as packed:
            _check(packed.infolist())
            _check_cells(packed)
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as file:
            return {name: np.asarray(file[name]) for name in file.files}
    except Exception as error:  # noqa: BLE001 - whatever a damaged archive makes zip, zlib or numpy raise
        raise ValueError(f"it is no .npz of plain arrays: {error}") from None


def _check(parts: Sequence[zipfile.ZipInfo]) -> None:
    size, names = sum(each.file_size for each in parts), [each.filename for each in parts]
    if size > MOST:  # no more than is said there is unpacked
        raise ValueError(f"they would have {size} bytes, and {MOST} at most are read")
    for name in names:
        check_name(name)
    repeated = twice(name.removesuffix(SUFFIX) for name in names)
    if repeated is not None:
        raise ValueError(f"'{repeated}' is there twice")
    other = next((name for name in names if not name.endswith(SUFFIX)), None)
    if other is not None:
        raise ValueError(f"'{other}' is in it, whose name does not end in {SUFFIX}")


def _check_cells(packed: zipfile.ZipFile) -> None:
    """The arrays have no more cells, by their headers, than fit into memory as numbers."""
    size = 0
    for name in packed.namelist():
        with packed.open(name) as part:
            version = np.lib.format.read_magic(part)
            if version not in HEADERS:
                raise ValueError(f"'{name}' is written in version {version} of its format")
            shape, _, kind = HEADERS[version](part)
        if kind.hasobject or kind.kind == "V":
            held = f"'{name}' holds {str(kind)[:80]}, and arrays of numbers or texts are read"
            raise ValueError(held + (": save np.array(…, dtype=str), or float" if kind.hasobject else ""))
        cells = abs(math.prod(shape))
        if cells and not kind.itemsize:
            raise ValueError(f"'{name}' has {cells} texts of no width")
        size += cells * FLOAT
        if size > MOST:
            raise ValueError(f"as numbers they would have {size} bytes, and {MOST} at most are read")
