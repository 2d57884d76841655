"""Where a finger that is moved first touches its handle, against coal."""

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from services.embodiment.certify.held.moved import EXACT, LEVEL, press, slope, tolerated
from services.physics.geometry.convex import ROOM
from services.physics.geometry.packed import pack

pytestmark = pytest.mark.oracle

INWARD, CONTACT, ENGAGED = np.array([0.0, -1.0, 0.0]), 0.005, 0.003
SIDES = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
NEARLY = 2e-5  # [m] before they touch, where a direction from one to the other is told
AGREES = 3e-6  # [m] coal calls shapes touching that are 1e-6 m apart
ROWS = np.array([[0, 1]])


def shapes(handle: coal.CollisionGeometry) -> tuple:
    both = [coal.Box(0.02, 0.01, 0.03), handle]
    for one in both:
        one.computeLocalAABB()
    return both, pack(both)


def room() -> tuple:
    return np.empty(3), np.zeros(ROOM)


def touches(both: list, turn: np.ndarray, middle: np.ndarray, shift: np.ndarray) -> bool:
    finger, handle = (
        coal.Transform3s(turn[0], middle[0] + shift),
        coal.Transform3s(turn[1], middle[1]),
    )
    result = coal.CollisionResult()
    return bool(coal.collide(both[0], finger, both[1], handle, coal.CollisionRequest(), result))


@pytest.mark.parametrize("handle", [coal.Cylinder(0.006, 0.1), coal.Box(0.1, 0.012, 0.01), coal.Sphere(0.01)])
def test_a_finger_touches_where_coal_has_it_touch(handle: coal.CollisionGeometry) -> None:
    rng, (both, convex), pressing = np.random.default_rng(7), shapes(handle), 0
    for _ in range(40):
        turn = np.array([np.eye(3), Rotation.from_rotvec(rng.normal(size=3) * 0.3).as_matrix()])
        middle = np.array([[0.0, rng.uniform(0.008, 0.016), 0.0], rng.normal(size=3) * 1e-3])
        posed = np.array([0, 1]), turn, middle
        gap, over = press(convex, ROWS, posed, INWARD, SIDES, CONTACT, ENGAGED, 0.5, room())
        if np.isnan(gap):
            continue
        pressing += 1
        assert touches(both, turn, middle, (gap + AGREES) * INWARD)
        assert not touches(both, turn, middle, (gap - AGREES) * INWARD)
        assert 0.0 <= over <= ENGAGED
    assert pressing > 10


def test_one_beside_the_handle_or_past_it_does_not_press() -> None:
    _, convex = shapes(coal.Box(0.1, 0.01, 0.01))
    for finger in ([0.0, 0.03, 0.0], [0.0, -0.02, 0.0], [0.0, 0.01, 0.03]):
        posed = np.array([0, 1]), np.array([np.eye(3)] * 2), np.array([finger, [0.0, 0.0, 0.0]])
        assert np.isnan(press(convex, ROWS, posed, INWARD, SIDES, CONTACT, ENGAGED, 0.5, room())[0])


def test_what_fingers_reach_over_is_how_far_the_handle_may_be_elsewhere() -> None:
    both, convex = shapes(coal.Box(0.1, 0.01, 0.01))
    finger = [0.01 + 0.05 - 0.004, 0.0, 0.0]  # 4 mm over the end of the handle, along x
    middle = np.array([finger, [0.0, 0.0, 0.0], finger])
    middle[0, 1], middle[2, 1] = 0.01, -0.01  # touching from above and from below
    posed = np.array([0, 1, 0]), np.array([np.eye(3)] * 3), middle
    gap, over = press(convex, ROWS, posed, INWARD, SIDES, CONTACT, 0.006, 0.5, room())
    assert abs(gap) < 2 * AGREES
    assert over == pytest.approx(0.004, abs=AGREES + EXACT)
    rows = ROWS, np.array([[2, 1]])
    asked = CONTACT, ENGAGED, 0.5
    found = tolerated(convex, rows, posed, (INWARD, -INWARD), SIDES, *asked, room())
    assert 0 < found <= (0.004 - ENGAGED) / np.sqrt(2)
    assert touches(both, posed[1][:2], middle[:2], np.zeros(3) - 1e-5 * np.array([0.0, 1.0, 0.0]))


@pytest.mark.parametrize("handle", [coal.Cylinder(0.006, 0.1), coal.Box(0.1, 0.012, 0.01), coal.Sphere(0.01)])
def test_a_handle_elsewhere_by_what_is_tolerated_is_met_by_faces_that_look_along_the_way(
    handle: coal.CollisionGeometry,
) -> None:
    rng, (_, convex), shown = np.random.default_rng(3), shapes(handle), 0
    asked, rows, ways = (CONTACT, ENGAGED, 0.5), (ROWS, np.array([[2, 1]])), (INWARD, -INWARD)
    for _ in range(300):
        turn = np.array([np.eye(3), Rotation.from_rotvec(rng.normal(size=3) * 0.3).as_matrix(), np.eye(3)])
        middle = np.array([[0.0, 0.012, 0.0], rng.normal(size=3) * 3e-3, [0.0, -0.012, 0.0]])
        every = np.array([0, 1, 0])
        error = tolerated(convex, rows, (every, turn, middle), ways, SIDES, *asked, room())
        for way in np.vstack((np.eye(3), -np.eye(3), rng.normal(size=(6, 3)))) if error else ():
            elsewhere = middle + np.array([[0.0], [1.0], [0.0]]) * error * way / np.linalg.norm(way)
            for pairs, inward in zip(rows, ways, strict=True):
                gap, over = press(convex, pairs, (every, turn, elsewhere), inward, SIDES, *asked, room())
                assert gap <= CONTACT + AGREES
                assert over >= ENGAGED - AGREES
        shown += error > 0
    assert shown > 10


@pytest.mark.parametrize("handle", [coal.Cylinder(0.006, 0.1), coal.Box(0.1, 0.012, 0.01), coal.Sphere(0.01)])
def test_faces_look_no_farther_away_than_is_told_where_coal_has_them_touch(
    handle: coal.CollisionGeometry,
) -> None:
    rng, (both, convex), told = np.random.default_rng(11), shapes(handle), []
    for _ in range(300):
        turn = Rotation.from_rotvec(rng.normal(size=(2, 3)) * 0.3).as_matrix()
        middle = np.array([[0.0, rng.uniform(0.008, 0.016), 0.0], rng.normal(size=3) * 3e-3])
        posed = np.array([0, 1]), turn, middle
        gap, _ = press(convex, ROWS, posed, INWARD, SIDES, CONTACT, ENGAGED, 0.6, room())
        if np.isnan(gap):
            continue
        most = slope(convex, ROWS, posed, INWARD, SIDES, gap, 0.6, room())
        if np.isfinite(most):
            finger = coal.Transform3s(turn[0], middle[0] + (gap - NEARLY) * INWARD)
            result = coal.DistanceResult()
            bar = coal.Transform3s(turn[1], middle[1])
            coal.distance(both[0], finger, both[1], bar, coal.DistanceRequest(), result)
            along = abs(result.normal @ INWARD)
            assert np.sqrt(1 - along**2) / along <= most + 0.01
            told.append(most)
    assert len(told) > 40
    assert min(told) < 0.3 < max(told)
    assert min(told) >= LEVEL / 2
