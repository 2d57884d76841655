"""Newton and Euler in balls: every moment of a span lies within its bounds, and the middle is Pinocchio's."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from services.app import load
from services.dynamics.robot.newton import Along, Robot
from services.embodiment.certify.sweep.pieces import Pieces, hermite
from services.physics.model import Scene

pytestmark = pytest.mark.oracle

SPAN = 0.1  # [s]


@pytest.fixture(scope="module", params=["pr2", "tiago_dual", "stretch"])
def scene(request: pytest.FixtureRequest) -> Scene:
    service = load("b", [request.param])
    return Scene(service.twin, service.robot(None))


def motion(scene: Scene, seed: int) -> Pieces:
    """Five pieces of everything moving at once, up to about 1 rad/s and 3 rad/s2."""
    rng, nq = np.random.default_rng(seed), scene.model.nq
    start = rng.uniform(np.maximum(scene.bounds.lower, -1), np.minimum(scene.bounds.upper, 1))
    v = np.cumsum(rng.normal(0, 0.3, (6, nq)), axis=0)
    v[:, : int(scene.base[0])] = 0.0  # the kitchen stands still
    return hermite(np.linspace(0, 5 * SPAN, 6), start + np.cumsum(v, axis=0) * SPAN, v)


@given(seed=st.integers(0, 10**6), share=st.floats(0, 1))
@settings(max_examples=10)
def test_every_moment_of_a_span_lies_within_its_bounds(scene: Scene, seed: int, share: float) -> None:
    pieces, parts = motion(scene, seed), 3
    piece = np.repeat(np.arange(5), parts)
    begin = pieces.start[piece] + np.tile(np.arange(parts), 5) * SPAN / parts
    robot, data = Robot(scene), pin.Data(scene.model)
    placed = robot.placed(Along(pieces, piece, begin, begin + SPAN / parts))
    wrenches = robot.wrenches(placed)
    efforts = {k: each.interval() for k, each in robot.efforts(placed, wrenches).items()}
    s = begin + share * SPAN / parts - pieces.start[piece]
    for i, (q, v, a) in enumerate(zip(*pieces.at(piece, s), strict=True)):
        pin.forwardKinematics(scene.model, data, q)
        exact = pin.rnea(scene.model, data, q, v, a)
        for k, bound in efforts.items():
            assert bound.lo[i] <= exact[k] <= bound.hi[i]
        first = int(scene.base[0]) + 1
        floor = data.oMi[first].act(data.f[first])
        found = wrenches[int(scene.base[0])].force
        assert np.linalg.norm(floor.linear - found.centre[i]) <= found.radius[i] + 1e-9
        yaw = data.oMi[robot.yaw + 1]
        moment = yaw.rotation @ data.f[robot.yaw + 1].angular
        assert np.linalg.norm(moment - wrenches[robot.yaw].moment.centre[i]) <= (
            wrenches[robot.yaw].moment.radius[i] + 1e-9
        )


def test_a_span_without_length_is_the_moment_itself(scene: Scene) -> None:
    pieces = motion(scene, 1)
    at = pieces.start + 0.4 * SPAN
    robot, data = Robot(scene), pin.Data(scene.model)
    placed = robot.placed(Along(pieces, np.arange(5), at, at))
    efforts = robot.efforts(placed, robot.wrenches(placed))
    for i, (q, v, a) in enumerate(zip(*pieces.at(np.arange(5), at - pieces.start), strict=True)):
        exact = pin.rnea(scene.model, data, q, v, a)
        for k, found in efforts.items():
            assert found.centre[i] == pytest.approx(exact[k], abs=1e-8)
            assert found.radius[i] == 0.0


def test_bounds_shrink_with_the_span(scene: Scene) -> None:
    pieces, robot, widest = motion(scene, 2), Robot(scene), []
    for length in (SPAN, SPAN / 4, SPAN / 16):
        placed = robot.placed(Along(pieces, np.arange(5), pieces.start, pieces.start + length))
        efforts = robot.efforts(placed, robot.wrenches(placed))
        widest.append(max(float(each.radius.max()) for each in efforts.values()))
    assert widest[1] < widest[0] / 3
    assert widest[2] < widest[1] / 3
