"""How far a bent mesh slides before another one, against many small steps."""

import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # found through a .pth file
import pytest

from services.physics.geometry.gap import gap
from services.physics.geometry.shapes import Triangles
from services.physics.stops.rest import placed
from services.physics.stops.slide import free_way

NEAR = 1e-3  # [m]
STEPS = 1000


def crumpled(random: np.random.Generator) -> Triangles:
    """A sheet of 32 triangles whose corners are anywhere near a plane."""
    x, y = np.meshgrid(np.linspace(-0.2, 0.2, 5), np.linspace(-0.2, 0.2, 5), indexing="ij")
    points = np.stack((x, y, np.zeros_like(x)), axis=-1).reshape(-1, 3) + random.normal(0, 0.02, (25, 3))
    corner = np.array([5 * i + j for i in range(4) for j in range(4)])[:, None]
    return Triangles(points, np.vstack((corner + np.array([0, 5, 6]), corner + np.array([0, 6, 1]))))


@pytest.mark.parametrize("seed", range(20))
def test_a_sheet_goes_as_far_as_many_small_steps_lead(seed: int) -> None:
    random = np.random.default_rng(seed)
    sheets = crumpled(random), crumpled(random)
    turn, turned = (pin.exp3(random.normal(0, 0.3, 3)) for _ in range(2))
    start = pin.SE3(turn, random.normal(0, 0.1, 3) - [0, 0, 0.5])
    rest = placed(pin.SE3(turned, random.normal(0, 0.1, 3)))
    way = np.array([*random.normal(0, 0.3, 2), 0.8])

    def distance(share: float) -> float:
        there = pin.SE3(start.rotation, start.translation + share * way)
        return gap(sheets[0], placed(there), sheets[1], rest)[0]

    assert distance(0.0) > NEAR
    free = free_way(sheets, (placed(start), rest), way, NEAR) / np.linalg.norm(way)
    shares = np.linspace(0, 1, STEPS)
    met = [share for share in shares if distance(float(share)) < NEAR]
    if not met:
        assert free == np.inf
        return
    assert met[0] - 1 / STEPS - 1.1 * NEAR / np.linalg.norm(way) <= free <= met[0]
