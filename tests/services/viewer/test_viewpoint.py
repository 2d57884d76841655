"""The first camera sees fronts from before them, with nothing between: in made-up rooms and bundled ones."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray

from services.app import load
from services.viewer.picture.looks import Looks
from services.viewer.picture.shapes import collision_surfaces
from services.viewer.picture.skeleton import Skeleton
from services.viewer.picture.standing import kitchen_positions
from services.viewer.picture.viewpoint import CLEAR, CONE, ROOM, Fronts, fronts_of, largest, viewpoint

Array = NDArray[np.float64]
NOTHING = np.zeros((0, 3, 3))
ROW = Fronts(np.array([[0.0, y, 0.8] for y in (-0.6, 0.0, 0.6)]), np.tile([1.0, 0.0, 0.0], (3, 1)))
"""Three fronts side by side that open towards +x."""


def block(low: tuple[float, float, float], high: tuple[float, float, float]) -> Array:
    """A box as triangles."""
    return np.asarray(trimesh.creation.box(bounds=[low, high]).triangles, dtype=np.float64)


def is_seen(point: Array, place: Array, middle: Array) -> bool:
    """Whether a point is near the middle of the picture."""
    way, forwards = point - place, middle - place
    return way @ forwards > CONE * np.linalg.norm(way) * np.linalg.norm(forwards)


def test_fronts_are_seen_from_where_they_open() -> None:
    view = viewpoint(ROW, NOTHING)
    assert view is not None
    assert view[0][0] > 1.0
    assert all(is_seen(point, *view) for point in ROW.points)


def test_the_camera_is_on_this_side_of_a_wall() -> None:
    wall = block((2.5, -9.0, 0.0), (2.6, 9.0, 9.0))
    view = viewpoint(ROW, wall)
    assert view is not None
    assert 1.0 < view[0][0] < 2.5


def test_the_camera_does_not_stand_over_furniture() -> None:
    island = block((1.0, -9.0, 0.0), (2.2, 9.0, 0.6))
    view = viewpoint(ROW, island)
    assert view is not None
    assert view[0][0] > 2.2


def test_what_is_asked_about_is_seen_though_others_are_more() -> None:
    alone = Fronts(np.vstack(([-1.0, 0.0, 0.8], ROW.points)), np.vstack(([-1.0, 0.0, 0.0], ROW.normals)))
    view = viewpoint(alone, block((-0.9, -9.0, 0.0), (-0.1, 9.0, 9.0)))
    assert view is not None
    assert view[0][0] < -1.0
    assert is_seen(alone.points[0], *view)


def test_the_robot_that_has_opened_it_is_seen_though_others_are_fewer() -> None:
    robot = np.array([1.5, 4.0, 0.8])
    for_fronts, for_robot = viewpoint(ROW, NOTHING), viewpoint(replace(ROW, robot=robot), NOTHING)
    assert for_fronts is not None
    assert for_robot is not None
    assert not is_seen(robot, *for_fronts)
    assert is_seen(robot, *for_robot)
    assert np.linalg.norm(robot - for_robot[0]) > ROOM
    assert is_seen(ROW.points[0], *for_robot)


def test_there_is_no_view_of_nothing_and_none_through_walls() -> None:
    assert viewpoint(Fronts(np.zeros((0, 3)), np.zeros((0, 3))), NOTHING) is None
    assert viewpoint(ROW, block((0.05, -9.0, 0.0), (0.1, 9.0, 9.0))) is None


@pytest.mark.parametrize(("kitchen", "least"), [("a", 7), ("b", 9)])
def test_most_fronts_around_are_seen_in_a_bundled_kitchen(kitchen: str, least: int) -> None:
    twin = load(kitchen).twin
    mechanism, containers = twin.mechanism(twin.environment), twin.containers()
    looks = Looks(Skeleton.of(mechanism), collision_surfaces(mechanism, hulls=False), {}, {})
    joints = kitchen_positions(looks.skeleton, dict(twin.state))
    fronts = fronts_of(looks, joints, containers[0], containers)
    assert len(fronts.points) == len(containers)
    np.testing.assert_allclose(np.linalg.norm(fronts.normals, axis=1), 1.0)
    view = viewpoint(fronts, largest(looks, joints, np.eye(4)))
    assert view is not None
    place, middle = view
    assert np.linalg.norm(fronts.points - place, axis=1).min() > CLEAR
    before = np.einsum("fk,fk->f", place - fronts.points, fronts.normals) > 0
    seen = [each for each, is_before in zip(fronts.points, before, strict=True) if is_before]
    assert before[0]
    assert sum(is_seen(each, place, middle) for each in seen) >= least
