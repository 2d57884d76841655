"""Points in and beside a torus, told by its triangles and by its equation; and in blocks."""

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
import pytest
import trimesh

from services.physics.geometry.inside import Where, where
from services.physics.geometry.shapes import Triangles

pytestmark = pytest.mark.oracle

MAJOR, MINOR = 0.5, 0.2  # [m]
SURE = 0.005  # [m] points nearer to the surface are left out: the triangles are inside the torus

OVER = (1, 0.1, 0.1), (3, 1.9, 1.9)
"""[m] Corners of a block that stands out of the block from 0 to 2 m."""


def torus(turned: float) -> coal.BVHModelBase:
    """Its triangles, some of them looking inwards, and each with vertices of its own."""
    mesh = trimesh.creation.torus(MAJOR, MINOR, 48, 48)
    corners, random = mesh.triangles.copy(), np.random.default_rng(0)
    chosen = random.random(len(corners)) < turned
    corners[chosen] = corners[chosen][:, ::-1]
    model = coal.BVHModelOBBRSS()
    model.beginModel(len(corners), 3 * len(corners))
    for a, b, c in corners:
        model.addTriangle(a, b, c)
    model.endModel()
    return model


@pytest.mark.parametrize("turned", [0.0, 1.0, 0.3])
def test_what_a_torus_contains_is_inside_whichever_way_its_faces_look(turned: float) -> None:
    mesh, random = torus(turned), np.random.default_rng(1)
    points = random.uniform(-0.75, 0.75, (120, 3)) * (1, 1, 0.3)
    deep = MINOR - np.hypot(np.hypot(points[:, 0], points[:, 1]) - MAJOR, points[:, 2])
    points, deep = points[np.abs(deep) > SURE], deep[np.abs(deep) > SURE]
    assert min((deep > 0).sum(), (deep < 0).sum()) > 30
    for point, depth in zip(points, deep, strict=True):
        assert where(mesh, point) is (Where.INSIDE if depth > 0 else Where.OUTSIDE)


@pytest.mark.parametrize("inside_out", [False, True])
def test_two_blocks_that_overlap_have_no_cavity_though_one_is_inside_out(inside_out: bool) -> None:
    one, other = (trimesh.creation.box(bounds=bounds) for bounds in (((0, 0, 0), (2, 2, 2)), OVER))
    if inside_out:
        other.invert()
    faces = np.vstack((one.faces, other.faces + len(one.vertices)))
    mesh = Triangles(np.vstack((one.vertices, other.vertices)), faces)
    assert where(mesh, np.array((1.51, 1.02, 1.03))) is Where.INSIDE
    assert where(mesh, np.array((0.51, 1.02, 1.03))) is Where.INSIDE
    assert where(mesh, np.array((2.51, 1.02, 1.03))) is Where.INSIDE
