"""Which column is what, and a table of columns as a track."""

from collections.abc import Sequence

import numpy as np

from predicates.learn.track import Array, Track, checked
from sdt_kg.errors import MotionError
from sdt_kg.motion import LARGEST, SHORTEST

PLACE, TURN, FORCE = ("x", "y", "z"), ("qx", "qy", "qz", "qw"), ("fx", "fy", "fz")
KNOWN = ("t", *PLACE, *TURN, *FORCE)

ORDERS = {
    3: PLACE,
    4: ("t", *PLACE),
    6: (*PLACE, *FORCE),
    8: ("t", *PLACE, *TURN),
    10: (*PLACE, *TURN, *FORCE),
    11: KNOWN,
}
"""Number of columns → their names where the file has no header; 7 are told apart by their values."""

UNIT_NORM = 0.01
"""[1] How far a quaternion's norm may be from 1 to be normalised rather than refused."""

ROOM = 50.0
"""[m] A point farther from the frame's origin is probably given in millimetres."""

STRENGTH = 1e5
"""[N] No hand, and no robot of a kitchen, pulls as hard: its unit is another one."""

ALLOWED = (
    "x y z [m], optional t [s] before, qx qy qz qw and fx fy fz [N] after them, or a header with these names"
)


def names_of(table: Array, header: Sequence[str] | None, name: str) -> tuple[str, ...]:
    """Name of each column of a table, shape (T, columns).

    Raises:
        MotionError: A header that lacks x, y, z or names something else; columns that could be two things.
    """
    if header is not None:
        return _from_header(header, name)
    count = table.shape[1]
    if count == 7:
        return _seven(table, name)
    if count not in ORDERS:
        raise MotionError(f"{name} has {count} columns and no header", allowed=ALLOWED)
    return ORDERS[count]


def _from_header(header: Sequence[str], name: str) -> tuple[str, ...]:
    names = tuple(each.strip().strip('"').lower() for each in header)
    names = tuple("t" if each in {"time", "stamp", "timestamp"} else each for each in names)
    unknown = [each for each in names if each not in KNOWN]
    twice = sorted({each for each in names if names.count(each) > 1})
    if unknown or twice:
        what = f"an unknown column '{unknown[0]}'" if unknown else f"the column '{twice[0]}' twice"
        raise MotionError(f"the header of {name} has {what}", allowed=", ".join(KNOWN))
    for group, needed in ((PLACE, True), (TURN, False), (FORCE, False)):
        lacking = [each for each in group if each not in names]
        if lacking and (needed or len(lacking) < len(group)):
            raise MotionError(f"the header of {name} lacks {', '.join(lacking)}", allowed=ALLOWED)
    return names


def _seven(table: Array, name: str) -> tuple[str, ...]:
    """Seven columns: a pose, or time, place and force."""
    whole = table[np.isfinite(table).all(axis=1)]
    norms = np.linalg.norm(whole[:, 3:], axis=1)
    if len(whole) and (np.abs(norms - 1) <= UNIT_NORM).all():
        return (*PLACE, *TURN)
    if len(whole) > 1 and (np.diff(whole[:, 0]) > 0).all():
        return ("t", *PLACE, *FORCE)
    raise MotionError(
        f"{name} has 7 columns that are neither x y z qx qy qz qw nor t x y z fx fy fz",
        allowed="unit quaternions, or times that increase",
        remedy="add a header line with the names of the columns",
    )


def track_of(table: Array, names: Sequence[str], name: str, places: Sequence[str]) -> Track:
    """A table, shape (T, columns), as a track; rows without a position are left out and counted.

    Args:
        table: NaN where nothing was observed.
        names: Of the columns.
        name: Of the source, for messages.
        places: Where each row stands in the source: "line 7".

    Raises:
        MotionError: With the row that is wrong.
    """
    column = {each: index for index, each in enumerate(names)}
    kept = np.flatnonzero(np.isfinite(table).all(axis=1))
    missing = len(table) - len(kept)
    table, places = table[kept], [places[int(k)] for k in kept]
    groups = {
        group[0]: table[:, [column[each] for each in group]] if group[0] in column else None
        for group in (PLACE, TURN, FORCE)
    }
    positions = groups["x"]
    assert positions is not None, "every order of columns has x, y, z"
    _check_room(positions, places, name)
    _check_strength(groups["fx"], places, name)
    times = table[:, column["t"]] if "t" in column else np.arange(len(table), dtype=np.float64)
    _check_times(times, places, name)
    turned = _unit(groups["qx"], places, name)
    return checked(Track(positions, times, "t" in column, turned, groups["fx"], missing, name))


def _check_room(positions: Array, places: Sequence[str], name: str) -> None:
    beyond = np.flatnonzero(np.abs(positions).max(axis=1) > ROOM) if len(positions) else np.zeros(0, int)
    if beyond.size:
        k = int(beyond[0])
        farthest = np.abs(positions[k]).max()
        raise MotionError(
            f"{places[k]} of {name}: a position of {farthest:.6g} m, probably in millimetres",
            allowed=f"m, up to {ROOM:g}",
            remedy="convert to m",
        )


def _check_strength(forces: Array | None, places: Sequence[str], name: str) -> None:
    beyond = (
        np.flatnonzero(np.abs(forces).max(axis=1) > STRENGTH) if forces is not None and len(forces) else []
    )
    if len(beyond):
        k = int(beyond[0])
        assert forces is not None, "one of them is too large"
        raise MotionError(
            f"{places[k]} of {name}: a force of {np.abs(forces[k]).max():.6g} N",
            allowed=f"N, up to {STRENGTH:g}",
        )


def _check_times(times: Array, places: Sequence[str], name: str) -> None:
    beyond = np.flatnonzero(np.abs(times) > LARGEST)
    if beyond.size:
        k = int(beyond[0])
        raise MotionError(
            f"{places[k]} of {name}: the time {times[k]:.6g} s, probably in nanoseconds",
            allowed=f"s, up to {LARGEST:g}",
            remedy="convert to s",
        )
    falling = np.flatnonzero(np.diff(times) < SHORTEST)
    if falling.size:
        k = int(falling[0]) + 1
        raise MotionError(
            f"{places[k]} of {name}: the time {times[k]:.16g} s is not after {times[k - 1]:.16g} s",
            allowed=f"increasing times, each {SHORTEST:g} s or more after the one before",
        )


def _unit(quaternions: Array | None, places: Sequence[str], name: str) -> Array | None:
    if quaternions is None:
        return None
    norms = np.linalg.norm(quaternions, axis=1)
    wrong = np.flatnonzero(np.abs(norms - 1) > UNIT_NORM)
    if wrong.size:
        k = int(wrong[0])
        raise MotionError(
            f"{places[k]} of {name}: the quaternion has the norm {norms[k]:.4g}",
            allowed="a unit quaternion qx qy qz qw",
        )
    return quaternions / norms[:, None]
