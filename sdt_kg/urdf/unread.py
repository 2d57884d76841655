"""Mesh files of which Assimp reads less than is written, without a word, or which it reads for ever."""

import re
from collections.abc import Callable, Iterator
from typing import Final

NUMBER: Final = re.compile(rb"(?:\d|[-+]\.?\d)[\d.]*(?:e[-+]?\d+)?|[-+]?(?:nan|inf)", re.IGNORECASE)
"""A number as Assimp counts it: one that begins with a point alone is none to it."""
NUMBERS: Final = (3, 4, 6)
"""How many a point has: without more, with a weight or with a colour. Any other point is left out, and
those behind it have its number."""
DECIMAL: Final = re.compile(rb"[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?", re.IGNORECASE)
COUNTED: Final = re.compile(rb"\s*\w*OFF\s+\d")
"""The first line of an OFF file that has the counts of points and faces in it."""
INDENTED: Final = re.compile(rb"[ \t]+[vf][ \t]")
POINT: Final = re.compile(rb"v[ \t]")
FREE: Final = re.compile(rb"(?:curv2?|surf)[ \t]")
CONTINUED: Final = re.compile(rb"\\\r?\n")

Unread = tuple[bytes, str, str]
"""The line, what is wrong with it, and what to do."""


def unread(suffix: str, content: bytes) -> Unread | None:
    """The first line of a mesh file for which another shape than the written one would be read, or none."""
    found = _FORMATS.get(suffix.lower())
    return None if found is None else next(found(content), None)


def _obj(content: bytes) -> Iterator[Unread]:
    for line in CONTINUED.sub(b" ", content).splitlines():
        if INDENTED.match(line):
            yield line, "begins with a blank", "take the blanks at the beginnings of lines away"
        elif FREE.match(line):
            yield line, "is of a free-form curve or surface", "export the mesh as polygons"
        elif POINT.match(line) and not _is_point(line.partition(b"#")[0].split()[1:]):
            remedy = "write each point as 'v x y z' with decimal points, 0.5 for .5"
            yield line, "is no point of 3, 4 or 6 numbers", remedy


def _is_point(numbers: list[bytes]) -> bool:
    return len(numbers) in NUMBERS and all(map(NUMBER.fullmatch, numbers))


def _off(content: bytes) -> Iterator[Unread]:
    lines = [line for line in content.splitlines() if line.strip()]
    for line in lines:
        if b"#" in line:
            yield line, "has a comment", "take comments out of the file"
    if lines and lines[0].split()[0].startswith(b"4OFF"):
        yield lines[0], "says that points have four coordinates", "export the mesh with three"
    yield from _off_rows(lines)


def _off_rows(lines: list[bytes]) -> Iterator[Unread]:
    """Rows of an OFF file, whose other numbers Assimp reads up to where it knows them no more."""
    sizes, start = (lines[0].split()[1:], 1) if lines and COUNTED.match(lines[0]) else ([], 2)
    sizes = sizes or b"".join(lines[1:2]).split()
    if len(sizes) < 2 or not all(map(bytes.isdigit, sizes)):
        return  # no header: Assimp says so
    points, faces = map(int, sizes[:2])
    for line in lines[start : start + points]:
        if not all(map(DECIMAL.fullmatch, line.split()[:3])):
            yield line, "is no point", "write each point as 'x y z' with decimal points"
    for line in lines[start + points : start + points + faces]:
        if not _is_face(line.split(), points):
            remedy = f"write each face as how many corners and their numbers, 0 to {points - 1}"
            yield line, "is no face", remedy
    for line in lines[start + points + faces :]:
        yield line, f"is more than the {points} points and {faces} faces of its header", "correct the counts"


def _is_face(numbers: list[bytes], points: int) -> bool:
    if not numbers[0].isdigit():
        return False
    corners = numbers[1 : 1 + int(numbers[0])]
    return len(corners) == int(numbers[0]) and all(each.isdigit() and int(each) < points for each in corners)


_FORMATS: Final[dict[str, Callable[[bytes], Iterator[Unread]]]] = {".obj": _obj, ".off": _off}
