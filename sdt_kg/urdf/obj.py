"""Plain OBJ files, as most meshes of kitchens are: points, and faces of three of them.

Assimp, which reads every format, clears 16 MB for each OBJ file: that takes five times as long as reading it.
"""

import re
from typing import Final

import numpy as np
from numpy.typing import NDArray

SUFFIX: Final = ".obj"
OTHER: Final = re.compile(
    rb"^(?![vf] |v[nt] |#|[ogs] |usemtl |mtllib |\r?$)|\\\r?$|\r(?!\n)|[\0\v\f]", re.MULTILINE
)
"""Anything but points, faces, normals, names and materials; a line that goes on in the next; or a sign that
ends one for other readers, behind which a comment may hide a face."""
POINT: Final = re.compile(rb"^v((?:[ \t]+[-+.\deE]+){3})[ \t]*\r?$", re.MULTILINE)
FACE: Final = re.compile(rb"^f((?:[ \t]+\d+(?:/\d*){0,2}){3})[ \t]*\r?$", re.MULTILINE)
ASIDE: Final = re.compile(rb"/[/\d]*")
"""Of a face's corner, what is no number of a point."""


def plain(content: bytes) -> tuple[NDArray[np.float64], NDArray[np.int64]] | None:
    """Points (V, 3) in the file's unit, and the three points of each face (M, 3); None of any other file.

    That may well be a mesh, spelled in another way, or one with a face that is a line. Numbers are of single
    precision, as Assimp's are; points of no face are left out.
    """
    points, faces = POINT.findall(content), FACE.findall(content)
    if not faces or OTHER.search(content) or len(points) + len(faces) != _shaping(content):
        return None
    try:
        with np.errstate(over="ignore"):  # what is too large for a point is none, and told as such
            places = np.array(b"".join(points).split(), dtype=np.float32).reshape(-1, 3)
    except ValueError:
        return None
    numbers = np.fromstring(ASIDE.sub(b"", b"".join(faces)), dtype=np.int64, sep=" ")
    used, corners = np.unique(numbers, return_inverse=True)
    if used[0] < 1 or used[-1] > len(places):
        return None
    whole, three = places[used - 1].astype(np.float64), corners.reshape(-1, 3)
    lines = (whole[three] == whole[np.roll(three, 1, axis=1)]).all(axis=2)
    return None if lines.any() else (whole, three)


def _shaping(content: bytes) -> int:
    """How many lines begin as points and faces do."""
    return sum(content.count(b"\n" + word) + content.startswith(word) for word in (b"v ", b"f "))
