"""Tracks in text: columns divided by whitespace, commas or semicolons, with a header or without."""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from predicates.learn.track import Track
from sdt_kg.errors import MotionError
from sdt_kg.numbers import number_in
from services.tracks.columns import ALLOWED, names_of, track_of

MISSING = {"", "nan", "na", "none", "null", "-"}
"""What stands in a cell for: not observed."""

_DIVIDER = re.compile(r"\s*[,;]\s*|\s+")


def read_text(path: Path) -> Track:
    """The track in a text file; empty lines and lines that begin with # are passed over.

    Raises:
        MotionError: With the line that is wrong.
    """
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise MotionError(f"{path.name} is no text", allowed=ALLOWED) from None
    rows = [
        (number, _cells(path.name, number, line))
        for number, line in enumerate(lines, 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    header = None
    if rows and not any(_is_number(cell) for cell in rows[0][1]):
        header, rows = rows[0][1], rows[1:]
    if not rows:
        raise MotionError(f"{path.name} has no samples", allowed=ALLOWED)
    width = len(header) if header is not None else len(rows[0][1])
    table = np.array([_numbers(path.name, number, cells, width) for number, cells in rows])
    names = names_of(table, header, path.name)
    return track_of(table, names, path.name, [f"line {number}" for number, _ in rows])


def _cells(name: str, number: int, line: str) -> list[str]:
    """Cells of a line. A line with commas or semicolons may have empty cells.

    Raises:
        MotionError: It has several dividers: the commas may be those of decimals.
    """
    dividers = {each.strip() or "blanks" for each in _DIVIDER.findall(line.strip())}
    if len(dividers) > 1:
        raise MotionError(
            f"line {number} of {name} is divided by {' and '.join(sorted(dividers))}",
            allowed="one of commas, semicolons and blanks",
            remedy="write decimals with a point",
        )
    return _DIVIDER.split(line.strip())


def _numbers(name: str, number: int, cells: Sequence[str], width: int) -> list[float]:
    if len(cells) != width:
        raise MotionError(f"line {number} of {name} has {len(cells)} columns", allowed=f"{width}, as before")
    found: list[float] = []
    for cell in cells:
        if cell.lower() in MISSING:
            found.append(np.nan)
        elif _is_number(cell):
            found.append(number_in(cell))
        else:
            raise MotionError(f"line {number} of {name}: '{cell[:40]}' is no number", allowed=ALLOWED)
    return found


def _is_number(cell: str) -> bool:
    if cell.lower() in MISSING:
        return cell.lower() == "nan"
    try:
        number_in(cell)
    except ValueError:
        return False
    return True
