"""Mesh files that hold several meshes, and formats that are not read as they are meant."""

from pathlib import Path

import numpy as np
import pytest

from sdt_kg.errors import UrdfError
from sdt_kg.mechanism import Geometry, Pose, ShapeType
from sdt_kg.urdf.meshes import mesh_hash
from services.physics.geometry.shapes import corners, solids, surface

pytestmark = pytest.mark.oracle

PART = """<triangles material="{name}" count="{count}"><input semantic="VERTEX" source="#v" offset="0"/>
<p>{faces}</p></triangles>"""
COLLADA = """<?xml version="1.0"?><!-- once <unit meter="0.01"/> -->
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit meter="1"/></asset>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="12">
0 0 0 1 0 0 0 2 0 0 0 3</float_array><technique_common><accessor source="#a" count="4" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
{parts}</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s">
{nodes}</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>"""
WHOLE = PART.format(name="a", count=4, faces="0 2 1 0 1 3 0 3 2 1 2 3")
HALVES = PART.format(name="a", count=2, faces="0 2 1 0 1 3") + PART.format(
    name="b", count=2, faces="0 3 2 1 2 3"
)
HERE = '<instance_geometry url="#g"/>'
THERE = f"<node><node><translate>10 0 0</translate>{HERE}</node></node>"
QUADS = """v 0 0 0
v 1 0 0
v 1 2 0
v 0 2 0
v 10 0 3
v 11 0 3
v 11 2 3
v 10 2 3
usemtl a
f 1 2 3 4
usemtl b
f 5 6 7 8
"""


def mesh(file: Path, content: str, scale: tuple[float, ...] = (1.0, 1.0, 1.0)) -> Geometry:
    file.write_text(content, encoding="utf-8")
    return Geometry(ShapeType.MESH, Pose(), scale, str(file), mesh_hash(file))


def triangles(geometry: Geometry) -> set[tuple[tuple[float, ...], ...]]:
    """Triangles of a surface, each its points in order of size."""
    (whole,) = surface(geometry)
    found = np.round(corners(whole), 6).tolist()
    return {tuple(sorted(map(tuple, each))) for each in found}


def expected(shift: float) -> set[tuple[tuple[float, ...], ...]]:
    points = [(shift, 0.0, 0.0), (shift + 1, 0.0, 0.0), (shift, 2.0, 0.0), (shift, 0.0, 3.0)]
    return {tuple(sorted(points[:left] + points[left + 1 :])) for left in range(4)}


@pytest.mark.parametrize(
    ("parts", "nodes", "shifts"),
    [
        (HALVES, f"<node>{HERE}</node>", (0.0,)),
        (WHOLE, f"<node>{HERE}</node>{THERE}", (0.0, 10.0)),
        (HALVES, f"<node>{HERE}</node>{THERE}", (0.0, 10.0)),
    ],
    ids=["two materials", "a node in a node", "both"],
)
def test_every_mesh_of_a_file_is_where_the_file_has_it(
    parts: str, nodes: str, shifts: tuple[float, ...], tmp_path: Path
) -> None:
    # Triangles of the second joined points of the first: half of a drawer was not there.
    file = mesh(tmp_path / "two.dae", COLLADA.format(parts=parts, nodes=nodes))
    assert triangles(file) == set().union(*map(expected, shifts))


def test_the_robots_pieces_hold_every_mesh_of_a_file(tmp_path: Path) -> None:
    file = mesh(tmp_path / "quads.obj", QUADS, (-1.0, 1.0, 2.0))
    boxes = [piece.aabb_local for piece in solids(file)]
    assert np.min([box.min_ for box in boxes], axis=0) == pytest.approx((-11, 0, 0), abs=1e-3)
    assert np.max([box.max_ for box in boxes], axis=0) == pytest.approx((0, 2, 6), abs=1e-3)


def test_a_format_whose_first_node_would_be_left_out_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UrdfError, match="may lie in other files too"):
        surface(mesh(tmp_path / "mesh.gltf", "{}"))


@pytest.mark.parametrize(
    ("name", "content", "shown"),
    [
        ("a.obj", QUADS.replace("f 5", " f 5"), "'f 5 6 7 8' begins with a blank"),
        ("a.obj", QUADS.replace("v 11 0 3", "\tv 11 0 3"), "'v 11 0 3' begins with a blank"),
        ("a.obj", "v .5 0 0\n" + QUADS, "'v .5 0 0' is no point"),
        ("a.obj", "v 1,0 0 0\n" + QUADS, "'v 1,0 0 0' is no point"),
        ("a.obj", "v 1 0\n" + QUADS, "'v 1 0' is no point"),
        ("a.obj", "v 1 0 \\\n.5\n" + QUADS, "'v 1 0 .* .5' is no point"),
        ("A.OBJ", "v 0 0 0 1 1\n" + QUADS, "'v 0 0 0 1 1' is no point"),
        ("a.obj", QUADS + "surf 0 1 0 1 1 2 3 4\n", "'surf 0 1 0 1 1 2 3 4' is of a free-form"),
        ("a.off", "OFF # ours\n\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "'OFF # ours' has a comment"),
        ("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n# one\n\n3 0 1 2\n", "'# one' has a comment"),
    ],
)
def test_a_line_that_assimp_would_leave_out_or_never_end_is_refused(
    name: str, content: str, shown: str, tmp_path: Path
) -> None:
    # Points behind one that is left out had its number: another shape, or a misleading "index out of range".
    with pytest.raises(UrdfError, match=shown):
        surface(mesh(tmp_path / name, content))


CORNER = ["0 0 0", "1 0 0", "0 1 0", "0 0 1", "3 0 2 1", "3 0 1 3", "3 0 3 2", "3 1 2 3"]


def off(head: str = "OFF\n4 4 6", rows: list[str] = CORNER, **other: str) -> str:
    """A corner as an OFF file; rows by their number in words are written otherwise."""
    said = [other.get(f"row{i}", row) for i, row in enumerate(rows)]
    return "\n".join([head, *said]) + "\n"


@pytest.mark.parametrize(
    ("content", "shown"),
    [
        (off(row7="3 1 2 4"), "'3 1 2 4' is no face"),  # the last point was taken
        (off(row7="3 1 2 -1"), "'3 1 2 -1' is no face"),
        (off(row7="3 1 2 3.0"), "'3 1 2 3.0' is no face"),
        (off(row7="4 1 2 3"), "'4 1 2 3' is no face"),
        (off(row3="0 0 1,5"), "'0 0 1,5' is no point"),
        (off(row3="0 0 1d-1"), "'0 0 1d-1' is no point"),  # 1 it was
        (off("OFF 4 3 6"), "'3 1 2 3' is more than the 4 points and 3 faces"),
        (off("4OFF\n4 4 6"), "'4OFF' says that points have four coordinates"),
    ],
)
def test_numbers_of_an_off_file_that_assimp_reads_otherwise_are_refused(
    content: str, shown: str, tmp_path: Path
) -> None:
    with pytest.raises(UrdfError, match=shown):
        surface(mesh(tmp_path / "a.off", content))


@pytest.mark.parametrize(
    "content",
    [
        off("OFF 4 4 6"),
        off(" OFF\n\n 4\t4  6", row2="\t0 1. -0"),
        off("COFF\n4 4 6", [row + " 255 0 0 255" for row in CORNER]),
        off(row3="0 0 1e0 7", row7="3 1 2 3 255 0 0"),
        off().replace("\n", "\r\n"),
    ],
)
def test_other_ways_to_write_an_off_file_are_read(content: str, tmp_path: Path) -> None:
    assert triangles(mesh(tmp_path / "a.off", content)) == triangles(mesh(tmp_path / "as.off", off()))


def test_points_with_weights_colours_comments_and_signs_are_read(tmp_path: Path) -> None:
    whole = QUADS.replace("usemtl b\n", "")
    spelled = whole.replace("v 1 0 0", "v 2 0 -.0 2 # half").replace("v 1 2 0", "v +1. 2e0 0 1 1 1")
    assert triangles(mesh(tmp_path / "spelled.obj", spelled)) == triangles(mesh(tmp_path / "as.obj", whole))


def test_pieces_of_the_same_bytes_in_another_format_are_not_taken_for_this_one(tmp_path: Path) -> None:
    corner = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n"
    assert solids(mesh(tmp_path / "a.obj", corner))
    with pytest.raises(UrdfError, match="cannot be read"):
        solids(mesh(tmp_path / "a.ply", corner))
