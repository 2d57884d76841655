"""Signed distances of two shapes that coal tells otherwise."""

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
import pytest

from services.physics.geometry.gap import gap
from services.physics.geometry.shapes import Triangles

pytestmark = pytest.mark.oracle


@pytest.mark.parametrize("first", [True, False])
@pytest.mark.parametrize("seed", range(20))
def test_a_ball_is_as_deep_in_a_cylinder_as_its_middle_and_its_radius_say(seed: int, first: bool) -> None:
    rng = np.random.default_rng(seed)
    radius, half, own = 10 ** rng.uniform(-2.5, 0, 3)
    at = rng.uniform(-1, 1, 3) * (radius / 2, radius / 2, half)
    ball, cylinder = coal.Sphere(own), coal.Cylinder(radius, 2 * half)
    placed, still = coal.Transform3s(np.eye(3), at), coal.Transform3s()
    pair = (ball, placed, cylinder, still) if first else (cylinder, still, ball, placed)
    expected = max(np.hypot(at[0], at[1]) - radius, abs(at[2]) - half) - own
    assert gap(*pair)[0] == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("first", [True, False])
@pytest.mark.parametrize("shape", [coal.Box(0.2, 0.2, 0.2), coal.Cylinder(0.1, 0.2), coal.Sphere(0.1)])
def test_a_mesh_of_small_triangles_is_as_deep_in_a_shape_as_it_is_pushed(
    shape: coal.CollisionGeometry, first: bool
) -> None:
    # A wall of 200 triangles, 30 mm beyond the shape's highest point.
    across = np.linspace(-0.5, 0.5, 11)
    points = np.stack(np.meshgrid(across, across, [0.0]), axis=-1).reshape(-1, 3)
    corner = np.arange(110).reshape(10, 11)[:, :10].reshape(-1, 1)
    faces = np.concatenate((corner + np.array((0, 1, 12)), corner + np.array((0, 12, 11))))
    wall, still = Triangles(points, faces.astype(np.int64)), coal.Transform3s()
    at = coal.Transform3s(np.eye(3), np.array((0.013, 0.007, 0.07)))
    pair = (wall, at, shape, still) if first else (shape, still, wall, at)
    assert gap(*pair)[0] == pytest.approx(-0.03, abs=5e-4)
