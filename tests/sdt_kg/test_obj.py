"""Plain OBJ files are read as Assimp reads them; all others are left to it."""

from pathlib import Path

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
import pytest
from numpy.typing import NDArray

from sdt_kg.urdf.obj import plain
from services.physics.geometry.shapes import corners

WEDGE = """# Blender
mtllib wedge.mtl
o wedge one
v 0.100000 -0.2 3e-1
v 1 0 0
v 9 9 9
v 0 1.5 0
v 0.25 0.25 -2
vn 0 0 1
vt 0 0
vt 1 0
vt 0 1
g side
usemtl wood
s off
f 1//1 2//1 4//1
f 1/1/1 4/2/1 5/3/1\t

f 5 2 1\r
"""


def triangles(content: str) -> NDArray[np.float64]:
    """Corners of each triangle of a plain file, shape (M, 3, 3)."""
    found = plain(content.encode())
    assert found is not None
    return found[0][found[1]]


def in_order(faces: NDArray[np.float64]) -> list[tuple[tuple[float, ...], ...]]:
    """Triangles in any order, each begun at any corner, in one order."""
    each = (tuple(map(tuple, face)) for face in faces.tolist())
    return sorted(min((face, face[1:] + face[:1], face[2:] + face[:2])) for face in each)


def test_a_plain_file_has_the_triangles_that_assimp_finds(tmp_path: Path) -> None:
    file = tmp_path / "wedge.obj"
    file.write_text(WEDGE)
    theirs = corners(coal.MeshLoader(coal.BV_OBBRSS).load(str(file), np.ones(3)))
    assert len(theirs) == 3
    assert in_order(triangles(WEDGE)) == in_order(theirs)


def test_what_is_too_large_for_a_number_is_no_point() -> None:
    assert np.isinf(triangles(WEDGE.replace("v 1 0 0", "v 1 0 1e39"))).any()


def test_points_of_no_face_are_left_out() -> None:
    found = plain(WEDGE.encode())
    assert found is not None
    assert found[0].max() == 1.5


@pytest.mark.parametrize(
    "spelled",
    [
        WEDGE.replace("f 5 2 1", "f 5 2 1 4"),
        WEDGE.replace("f 5 2 1", "f 5 2"),
        WEDGE.replace("f 5 2 1", "f -1 2 1"),
        WEDGE.replace("f 5 2 1", "f 0 2 1"),
        WEDGE.replace("f 5 2 1", "f 6 2 1"),
        WEDGE.replace("f 5 2 1", "f 5 2 2"),
        WEDGE.replace("f 5 2 1", "f 5 2 \\\n1"),
        WEDGE.replace("f 5 2 1", "l 5 2 1"),
        WEDGE.replace("f 5 2 1", " f 5 2 1"),
        WEDGE.replace("f 5 2 1", "f\t5 2 1"),
        WEDGE.replace("v 9 9 9", "v 1 0 0").replace("f 5 2 1", "f 5 2 3"),
        WEDGE.replace("v 1 0 0", "v 1 0 0 1"),
        WEDGE.replace("v 1 0 0", "v 1 0 nan"),
        WEDGE.replace("v 1 0 0", "v 1 0 0-1"),
        WEDGE.replace("v 1 0 0", "v 1 0"),
        WEDGE.replace("s off", "curv 0 1 1 2"),
        WEDGE.replace("usemtl wood", "usemtl wood\\"),
        *(WEDGE.replace("s off", f"# a face behind{end}f 1 2 3") for end in "\r\f\0"),
        WEDGE.partition("f ")[0],
        "",
    ],
)
def test_what_is_spelled_otherwise_is_left_to_assimp(spelled: str) -> None:
    assert spelled != WEDGE
    assert plain(spelled.encode()) is None
