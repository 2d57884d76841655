"""Mesh files of which Assimp reads less than is written, without a word, or which it reads for ever."""

import re
from collections.abc import Callable, Iterator
from typing import Final

NUMBER: Final = re.compile(rb"(?:\d|[-+]\.?\d)[\d.]*(?:e[-+]?\d+)?|[-+]?(?:nan|inf)", re.IGNORECASE)
"""A number as Assimp counts it: one that begins with a point alone is none to it."""
NUMBERS: Final = (3, 4, 6)
"""How many a point has: without more, with a weight or with a colour. Any other point is left out, and
those behind it have its number."""
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
    for line in content.splitlines():
        if b"#" in line:
            yield line, "has a comment", "take comments out of the file"


_FORMATS: Final[dict[str, Callable[[bytes], Iterator[Unread]]]] = {".obj": _obj, ".off": _off}
