"""Cores lie inside the reference's collision geometry: no triangle meets them, their middles are inside."""

from collections.abc import Iterator

import numpy as np
import pytest
import trimesh

from sdt_kg.load import load_twin
from sdt_kg.mechanism import ShapeType
from tests.robots.conftest import Robot
from tests.robots.shapes import Array, outside

WITH = {"pr2": 192, "tiago_dual": 58, "stretch": 0}
"""How many cores a robot has. The meshes of Stretch are thin shells: nothing is inside them."""

OPEN = 0.01  # [1] by how much the winding number of a surface with slits may differ from 1


def cores(name: str) -> list[tuple[str, Array, Array]]:
    """Link, link_T_core, half extents [m]."""
    twin = load_twin("b", [name])
    found = []
    for link, box in twin.robot(twin.robots[0]).cores:
        assert box.shape is ShapeType.BOX
        found.append((link, box.pose.matrix(), np.array(box.size) / 2))
    return found


def corners(pose: Array, half: Array) -> Array:
    signs = np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T
    return (signs * half) @ pose[:3, :3].T + pose[:3, 3]


def surfaces(meshes: list[trimesh.Trimesh]) -> Iterator[Array]:
    """Triangles (N, 3, 3) of each connected part."""
    for mesh in meshes:
        mesh.merge_vertices()
        yield from (np.asarray(one.triangles) for one in mesh.split(only_watertight=False))


def meets(triangles: Array, half: Array) -> bool:
    """Whether a triangle (N, 3, 3) meets the box about the origin: separating axes."""
    edges = np.roll(triangles, -1, axis=1) - triangles
    normals = np.cross(edges[:, 0], edges[:, 1])[:, None]
    crossed = np.cross(edges[:, :, None], np.eye(3)[None, None]).reshape(-1, 9, 3)
    axes = np.concatenate((np.tile(np.eye(3), (len(triangles), 1, 1)), normals, crossed), axis=1)
    along = np.einsum("nai,nvi->nav", axes, triangles)
    reach = np.abs(axes) @ half
    apart = (along.min(axis=2) > reach) | (along.max(axis=2) < -reach)
    return bool((~apart.any(axis=1)).any())


def winding(triangles: Array) -> float:
    """How often the surface of triangles goes around the origin (van Oosterom and Strackee, 1983)."""
    a, b, c = (triangles[:, k] for k in range(3))
    la, lb, lc = (np.linalg.norm(each, axis=1) for each in (a, b, c))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c))
    dots = [np.einsum("ij,ij->i", *pair) for pair in ((a, b), (b, c), (c, a))]
    below = la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb
    return float(2 * np.arctan2(volume, below).sum() / (4 * np.pi))


def test_corners_lie_inside_our_shapes(robot: Robot) -> None:
    found = cores(robot.name)
    assert len(found) == WITH[robot.name]
    for link, pose, half in found:
        assert outside(robot.links.shapes(link), corners(pose, half)).max() <= 0, link


@pytest.mark.reference
def test_no_triangle_meets_a_core_and_its_middle_is_inside(robot: Robot, theirs: Robot) -> None:
    for link, pose, half in cores(robot.name):
        if any(one.outside(corners(pose, half)).max() == 0 for one in theirs.links.shapes(link)):
            continue  # the source has a shape there, and it is convex
        seen = [(one - pose[:3, 3]) @ pose[:3, :3] for one in surfaces(theirs.links.meshes(link))]
        around = [one for one in seen if abs(winding(one)) == pytest.approx(1, abs=OPEN)]
        assert around, link
        assert any(not meets(one, half) for one in around), link
