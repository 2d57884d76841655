"""τ in every form: each determines the others, exactly."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sdt_kg.errors import DisconnectedFrameError, MotionError
from sdt_kg.iri import body_iri
from sdt_kg.motion import Motion
from services.physics.oracle import Kinematics
from services.physics.points import as_point, as_poses, as_values, residuals
from services.physics.tree import build
from tests.small import small_twin

TWIN = small_twin("a")
MODEL = build(TWIN.mechanism(TWIN.environment))
EXACT = 1e-9
KITCHEN = TWIN.mechanism(TWIN.environment).name

containers = st.sampled_from([each.name for each in TWIN.containers()])
shares = st.lists(st.floats(0.0, 1.0), min_size=2, max_size=12)
offsets = st.tuples(*[st.floats(-0.5, 0.5)] * 3).map(np.array)


def motion(name: str, along: list[float]) -> Motion:
    container = TWIN.container(name)
    values = container.lower + np.array(along) * (container.upper - container.lower)
    return Motion(container.joint, np.arange(len(along)) * 0.5, values[:, None])


@settings(max_examples=40)
@given(containers, shares)
def test_values_to_poses_of_the_handle_and_back(name: str, along: list[float]) -> None:
    given_values = motion(name, along)
    poses = as_poses(MODEL, TWIN, given_values, TWIN.container(name).handle)
    assert as_values(MODEL, TWIN, poses).values == pytest.approx(given_values.values, abs=EXACT)


@settings(max_examples=40)
@given(containers, shares, offsets)
def test_values_to_any_point_of_the_body_and_back(name: str, along: list[float], offset: np.ndarray) -> None:
    if np.linalg.norm(offset[[0, 2]]) < 0.05 or np.linalg.norm(offset[:2]) < 0.05:
        offset = offset + np.array([0.1, 0.0, 0.0])  # off every axis
    given_values = motion(name, along)
    path = as_point(MODEL, TWIN, given_values, TWIN.container(name).iri, offset)
    assert as_values(MODEL, TWIN, path).values == pytest.approx(given_values.values, abs=EXACT)
    assert residuals(MODEL, TWIN, path).max() < EXACT


FOLDING = ("folding_door", TWIN.container("folding_door").iri)


def test_a_point_that_comes_near_a_place_twice_is_where_it_is() -> None:
    given_values, offset = motion(FOLDING[0], [0.0, 0.875]), np.array([-0.3984375, 0.0, 0.0])
    path = as_point(MODEL, TWIN, given_values, FOLDING[1], offset)
    assert as_values(MODEL, TWIN, path).values == pytest.approx(given_values.values, abs=EXACT)


def test_a_point_that_comes_to_a_place_twice_says_nothing_of_the_joint() -> None:
    given_values, offset = motion(FOLDING[0], [0.0, 0.875]), np.array([-0.4, 0.0, 0.0])
    path = as_point(MODEL, TWIN, given_values, FOLDING[1], offset)
    with pytest.raises(MotionError, match=r"sample 1: .* at 0\.\d+ and at 0\.875"):
        as_values(MODEL, TWIN, path)


@settings(max_examples=20)
@given(containers, shares)
def test_a_corners_path_to_the_handles_poses_and_back(name: str, along: list[float]) -> None:
    container, corner = TWIN.container(name), np.array([-0.02, 0.5, -0.3])
    path = as_point(MODEL, TWIN, motion(name, along), container.iri, corner)
    poses = as_poses(MODEL, TWIN, path, container.handle)
    again = as_point(MODEL, TWIN, poses, container.iri, corner)
    assert again.positions == pytest.approx(path.positions, abs=EXACT)


def test_the_oracle_replays_every_form_to_the_same_state() -> None:
    values = motion("side_door", [0.0, 0.2, 0.5, 0.8, 0.95])
    values = Motion(values.of, values.times * 2, values.values)
    container, physics = TWIN.container("side_door"), Kinematics()
    poses = as_poses(MODEL, TWIN, values, container.handle)
    path = as_point(MODEL, TWIN, values, container.iri, np.array([0.0, 0.5, 0.3]))
    finals = [
        physics.replay(TWIN, each).final[container.joint]
        for each in (values, poses, as_values(MODEL, TWIN, path))
    ]
    assert finals == pytest.approx([0.95 * 1.5] * 3, abs=EXACT)


def test_a_point_on_the_hinge_says_nothing() -> None:
    path = as_point(
        MODEL, TWIN, motion("side_door", [0, 1]), TWIN.container("side_door").iri, np.array([0.0, 0.0, 0.3])
    )
    with pytest.raises(DisconnectedFrameError, match="lies on its axis"):
        as_values(MODEL, TWIN, path)


def test_a_body_that_another_joint_moves_has_no_path() -> None:
    with pytest.raises(DisconnectedFrameError, match="'side_door_joint' does not move 'low_drawer'"):
        as_poses(MODEL, TWIN, motion("side_door", [0, 1]), body_iri(KITCHEN, "low_drawer"))
