"""Convex pieces of meshes, kept on disk: a mesh of 100,000 triangles takes seconds to cut up."""

import io
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from services.keeping.files import place, read, write

Array = NDArray[np.float64] | NDArray[np.int64]

PIECES = "pieces"
"""Kind of what is kept."""


def kept(follows_from: Sequence[object], make: Callable[[], list[Array]]) -> list[Array]:
    """Arrays of two axes, as they were made: read, or made and kept for the next time.

    Args:
        follows_from: All that decides them; its text is the key.
        make: The arrays, where none are kept. A folder that cannot be written keeps nothing.
    """
    path = place(PIECES, follows_from)
    content = read(path)
    if content is not None:
        return _unpacked(content)
    arrays = make()
    write(path, _packed(arrays))
    return arrays


def _packed(arrays: list[Array]) -> bytes:
    """One array of integers: how many; of each whether it is of numbers, its rows and columns; then all."""
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
