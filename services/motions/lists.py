"""Lists as JSON writes them → arrays: no cell becomes another because of those beside it."""

from functools import partial

import numpy as np

from sdt_kg.errors import MotionError
from services.motions.given import place_in


def array_of(name: str, value: object) -> np.ndarray:
    """The array. Where texts or truth values are among others, its cells are as they were written.

    Of `[true, 0.5]` numpy alone makes 1 and 0.5, of `[0.5, "a"]` two texts.

    Args:
        name: Of the array, for what is said of it.
        value: Nested lists, or a value alone.

    Raises:
        MotionError: Its rows are not alike, with the first that is another.
    """
    try:
        array = np.asarray(value)
    except ValueError:
        raise _uneven(name, value if isinstance(value, list) else [value]) from None
    kinds = _kinds(value)
    return np.array(value, dtype=object) if len(kinds) > 1 and kinds & {bool, str} else array


def _kinds(value: object) -> set[type]:
    """Types of the cells."""
    if not isinstance(value, list):
        return {type(value)}
    kinds = set(map(type, value))
    if list in kinds:
        inner = (_kinds(each) for each in value if isinstance(each, list))
        return (kinds - {list}).union(*inner)
    return kinds


def _uneven(name: str, rows: list[object]) -> MotionError:
    """What is wrong with rows of which numpy can make no array."""
    first, at = rows[0], partial(place_in, name)
    for k, row in enumerate(rows):
        if not isinstance(row, list) or not isinstance(first, list):
            if isinstance(row, list) != isinstance(first, list):
                one, other = ("a list", "a value") if isinstance(row, list) else ("a value", "a list")
                return MotionError(f"'{name}' at {at(k)} is {one}", allowed=f"{other}, as at {at(0)}")
        elif len(row) != len(first):
            said = f"'{name}' at {at(k)} has {len(row)} values"
            return MotionError(said, allowed=f"{len(first)}, as at {at(0)}")
    nested = (k for k, row in enumerate(rows) if isinstance(row, list) and list in map(type, row))
    return MotionError(f"'{name}' at {at(next(nested, 0))} has a list among its values", allowed="numbers")
