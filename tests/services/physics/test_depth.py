"""How deep the triangles of a mesh are in a convex body, against a linear programme for each."""

import coal
import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

from services.physics.geometry import depth
from services.physics.geometry.depth import FINE, FINE_SKIN, Faces, faces, placed, skin_depth, surface_depth
from services.physics.geometry.shapes import Triangles, hull

pytestmark = pytest.mark.oracle

Array = NDArray[np.float64]


def deepest_by_programme(corners: Array, body: Faces) -> float:
    """The most that a point of a triangle, a mean of its corners, may be moved away and stay in the body."""
    rows = np.column_stack((body.normals @ corners.T, np.ones(len(body.normals))))
    whole, share = ([[1.0, 1.0, 1.0, 0.0]], [1.0]), [(0, None)] * 3 + [(None, None)]
    return float(linprog((0, 0, 0, -1), rows, body.offsets, *whole, bounds=share).x[3])


@pytest.mark.parametrize("seed", range(8))
def test_triangles_are_as_deep_in_a_hull_as_a_linear_programme_finds(seed: int) -> None:
    rng = np.random.default_rng(seed)
    shape = hull(rng.normal(scale=0.01, size=(30, 3))) if seed % 2 else coal.Box(0.02, 0.03, 0.01)
    at = Rotation.random(rng=rng).as_matrix(), rng.normal(scale=0.005, size=3)
    triangles = rng.normal(size=(20, 3, 3)) * rng.uniform(0.003, 0.1) + at[1]
    best = [max(deepest_by_programme(each, placed(faces(shape), *at)), 0.0) for each in triangles]
    assert max(best) > 0
    for corners, most in zip(triangles, best, strict=True):
        found = surface_depth(Triangles(corners, np.array([[0, 1, 2]])), shape, *at)
        assert most - 1e-9 <= found + (FINE if found == 0 else 0.0) <= most + 1.001 * FINE
    whole = Triangles(triangles.reshape(-1, 3), np.arange(60).reshape(-1, 3))
    assert surface_depth(whole, shape, *at) == pytest.approx(max(best), abs=1.001 * FINE)


def test_a_box_is_as_deep_in_a_ball_of_small_triangles_as_it_is_pushed() -> None:
    """What coal says of such a mesh is how deep the triangle is that it finds first."""
    ball = trimesh.creation.icosphere(4, 0.1)
    mesh = Triangles(np.array(ball.vertices), np.array(ball.faces))
    for deep in (0.001, 0.01, 0.05):
        found = surface_depth(mesh, coal.Box(0.2, 0.3, 0.3), np.eye(3), np.array((0.2 - deep, 0.0, 0.0)))
        assert found == pytest.approx(deep, abs=1.001 * FINE)


def test_a_point_is_in_the_wall_of_a_tube_or_in_its_hole() -> None:
    tube = trimesh.creation.annulus(0.03, 0.05, 0.2, 256)
    mesh = Triangles(np.array(tube.vertices), np.array(tube.faces))
    in_wall, in_hole, outside = np.array(((0.042, 0, 0), (0.02, 0, 0), (0.06, 0, 0)))
    points = np.repeat(np.array((in_wall, in_hole, outside))[:, None], 3, axis=1)
    assert skin_depth(mesh, points) - FINE_SKIN == pytest.approx(0.008, abs=1e-5)
    assert skin_depth(mesh, points[1:]) == 0


def bow() -> trimesh.Trimesh:
    """A bent handle: a bar of 12 mm along an arc."""
    ring = ((0.088, -6e-3), (0.1, -6e-3), (0.1, 6e-3), (0.088, 6e-3))
    points = [(r * np.cos(turn), r * np.sin(turn), z) for turn in np.linspace(-1, 1, 9) for r, z in ring]
    pairs = [(4 * k + i, 4 * k + (i + 1) % 4) for k in range(8) for i in range(4)]
    sides = [face for a, b in pairs for face in ((a, b, b + 4), (a, b + 4, a + 4))]
    return trimesh.Trimesh(points, [*sides, (0, 2, 1), (0, 3, 2), (32, 33, 34), (32, 34, 35)])


@pytest.mark.parametrize("deep", [2e-5, 1e-4, 5e-4, 2e-3])
def test_what_lies_flat_on_a_bent_handle_is_cut_into_few_parts(
    deep: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Where it lies on it, it was cut into pieces of a tenth of a millimetre: a certificate took minutes.
    looked, off = list[int](), depth._off

    def counted(*about: object) -> tuple[float, int]:
        looked.append(1)
        return off(*about)  # type: ignore[arg-type]

    monkeypatch.setattr(depth, "_off", counted)
    around, turn = bow(), Rotation.from_rotvec((0.3, -0.7, 0.5)).as_matrix()
    flat = np.array(((0.03, -0.05, 0.0), (0.15, -0.05, 0.0), (0.15, 0.05, 0.0), (0.03, 0.05, 0.0)))
    finger = (flat + np.array((0.0, 0.0, 6e-3 - deep))) @ turn.T
    mesh = Triangles(np.array(around.vertices) @ turn.T, np.array(around.faces))
    found = skin_depth(mesh, finger[[[0, 1, 2], [0, 2, 3]]])
    assert deep - 1e-9 <= found <= deep + FINE_SKIN + 1e-9
    assert 100 < len(looked) < 8_000


@pytest.mark.parametrize("seed", range(6))
def test_a_triangle_is_as_deep_in_a_bent_handle_as_the_deepest_of_its_points(seed: int) -> None:
    rng, around = np.random.default_rng(seed), bow()
    mesh = Triangles(np.array(around.vertices), np.array(around.faces))
    triangle = rng.normal(scale=(0.05, 0.05, 0.004), size=(3, 3)) + np.array((0.09, 0.0, 0.0))
    points = rng.dirichlet((1.0, 1.0, 1.0), 40_000) @ triangle
    inside = points[around.contains(points)]
    deepest = float(np.abs(trimesh.proximity.closest_point(around, inside)[1]).max()) if len(inside) else 0.0
    assert deepest <= skin_depth(mesh, triangle[None]) + FINE_SKIN
    assert skin_depth(mesh, triangle[None]) <= deepest + FINE_SKIN + 4e-4


@pytest.mark.parametrize("seed", range(4))
def test_a_triangle_is_as_deep_in_a_mesh_as_the_deepest_of_its_points(seed: int) -> None:
    """A box in small triangles, of which each point knows how deep it is."""
    rng, half = np.random.default_rng(seed), np.array((0.02, 0.03, 0.01))
    box = trimesh.creation.box(2 * half).subdivide().subdivide()
    mesh = Triangles(np.array(box.vertices), np.array(box.faces))
    triangle = rng.normal(scale=0.03, size=(3, 3))
    points = rng.dirichlet((1.0, 1.0, 1.0), 200_000) @ triangle
    deepest = max(float((half - np.abs(points)).min(axis=1).max()), 0.0)
    assert deepest > 0
    assert deepest <= skin_depth(mesh, triangle[None]) <= deepest + FINE_SKIN + 2e-4
