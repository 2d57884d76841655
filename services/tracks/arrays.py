"""Tracks in .npz files: `positions` (T, 3) or `poses` (T, 7), optional `times` (T,), `forces` (T, 3)."""

from pathlib import Path

import numpy as np

from predicates.learn.track import Array, Track
from sdt_kg.errors import MotionError
from services.motions.archive import arrays_in
from services.tracks.columns import FORCE, PLACE, TURN, track_of

ALLOWED = "positions (T, 3) or poses (T, 7), optional times (T,), orientations (T, 4), forces (T, 3)"

KEYS = {
    "times": ("t",),
    "poses": (*PLACE, *TURN),
    "positions": PLACE,
    "orientations": TURN,
    "forces": FORCE,
}
"""Name of an array → what its columns are called elsewhere."""


def read_arrays(path: Path) -> Track:
    """The track in an .npz file.

    Raises:
        MotionError: No .npz, arrays of another shape, or a sample that is wrong, with its index.
    """
    try:
        arrays = arrays_in(path)
    except ValueError as error:
        raise MotionError(f"{path.name}: {error}", allowed=ALLOWED) from None
    if unknown := sorted(arrays.keys() - KEYS.keys()):
        is_motion = not arrays.keys().isdisjoint({"joint", "robot"})
        raise MotionError(
            f"{path.name} has an array '{unknown[0]}', which means nothing here",
            allowed=ALLOWED,
            remedy="it is a motion: --motion of sdt causes or sdt achieve takes it" if is_motion else "",
        )
    if "poses" not in arrays and "positions" not in arrays:
        raise MotionError(f"{path.name} has {', '.join(arrays) or 'nothing'}", allowed=ALLOWED)
    for one, other in (("poses", "positions"), ("poses", "orientations")):
        if one in arrays and other in arrays:
            raise MotionError(f"{path.name} has '{one}' and '{other}'", allowed="one of both")
    columns, names = list[Array](), list[str]()
    samples = len(np.atleast_1d(arrays["poses" if "poses" in arrays else "positions"]))
    for key, group in KEYS.items():
        if key in arrays:
            columns.append(_column(path.name, key, arrays[key], (samples, len(group))))
            names += group
    return track_of(np.hstack(columns), names, path.name, [f"index {k}" for k in range(samples)])


def _column(name: str, key: str, array: np.ndarray, shape: tuple[int, int]) -> Array:
    if array.dtype.kind not in "iuf":
        raise MotionError(f"'{key}' of {name} holds {array.dtype}", allowed="real numbers")
    found = np.asarray(array, dtype=np.float64)
    if shape[1] == 1 and found.ndim == 1:
        found = found[:, None]
    if found.shape != shape:
        raise MotionError(f"'{key}' of {name} has the shape {array.shape}", allowed=f"{shape}; {ALLOWED}")
    return found
