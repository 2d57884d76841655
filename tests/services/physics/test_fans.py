"""The few vertices of a cone of directions hold the farthest of all along each of them."""

import itertools

import numpy as np
import pytest

from services.physics.geometry.fans import CONES, EDGE, cone, fanned

RNG = np.random.default_rng(4)
ROUNDING = 1e-15  # [m] of points up to 1 m away

BALL = (ball := RNG.normal(size=(300, 3))) / np.linalg.norm(ball, axis=1, keepdims=True)
PRISM = np.array([[np.cos(a), np.sin(a), z] for a in np.linspace(0, 2 * np.pi, 40) for z in (-0.1, 0.1)])
POINTS = {
    "a ball": BALL,
    "a prism, its first corners twice": PRISM,
    "a flat one": BALL * [1.0, 1.0, 0.0],
    "a grid, most of it inside": np.array(list(itertools.product(np.linspace(-0.5, 0.5, 5), repeat=3))),
    "one point": np.array([[0.1, 0.2, 0.3]]),
}

STEPS = np.linspace(-1.0, 1.0, EDGE + 1)
EDGES = [
    np.roll([sign, u, v], axis) for axis in range(3) for sign in (-1.0, 1.0) for u in STEPS for v in STEPS
]


@pytest.mark.parametrize("points", POINTS.values(), ids=POINTS.keys())
def test_no_vertex_that_is_left_out_of_a_cone_is_farther_in_it(points: np.ndarray) -> None:
    starts, some = fanned(points)
    for x, y, z in [*RNG.normal(size=(2000, 3)), *EDGES, *np.eye(3), *-np.eye(3), np.zeros(3)]:
        n = cone(x, y, z)
        along = some[starts[n] : starts[n + 1]] @ [x, y, z]
        assert along.max() >= (points @ [x, y, z]).max() - ROUNDING


def test_every_cone_is_reached_and_has_few_vertices() -> None:
    starts, some = fanned(BALL)
    assert {cone(*each) for each in RNG.normal(size=(20_000, 3))} == set(range(CONES))
    assert len(starts) == CONES + 1
    assert starts[-1] == len(some) < 12 * CONES
    assert (np.diff(starts) > 0).all()
