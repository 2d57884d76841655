"""Drives over a lattice: found through a gap, refused where there is none."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import cast

import numpy as np
import pytest

from sdt_kg.annotation import Drive
from services.embodiment.ways import cells
from services.embodiment.ways.lattice import Lattice
from services.embodiment.ways.roads import Roads
from services.embodiment.ways.spaces import DriveSpace

START, GOAL = np.array([0.03, 0.02, 0.3]), np.array([2.04, 0.07, 1.5])
STEP = 0.01  # [m] between two checks


@dataclass(frozen=True)
class Yard:
    """A point that drives in a walled yard, 3 m by 2 m, with a wall at x = 1 that has a gap."""

    drive: Drive
    gap: tuple[float, float]
    east: float = 2.5
    north: float = 1.0

    def stands(self, pose: np.ndarray) -> bool:
        x, y, _ = pose
        in_yard = -0.5 < x < self.east and -1.0 < y < self.north
        return bool(in_yard and not (abs(x - 1.0) < 0.04 and not self.gap[0] < y < self.gap[1]))

    def stand_free(self, poses: np.ndarray) -> list[bool]:
        return [self.stands(pose) for pose in poses]

    def distance(self, one: np.ndarray, others: np.ndarray) -> np.ndarray:
        return np.linalg.norm((others - one)[:, :2], axis=1)

    def edge(self, start: np.ndarray, end: np.ndarray) -> np.ndarray:
        return np.stack([start, end])

    def free(self, start: np.ndarray, end: np.ndarray) -> bool:
        pieces = int(np.linalg.norm(end[:2] - start[:2]) / STEP) + 2
        return all(self.stands(pose) for pose in np.linspace(start, end, pieces))

    def free_along(self, poses: np.ndarray) -> bool:
        return all(self.free(one, other) for one, other in pairwise(poses))


def lattice(drive: Drive, gap: tuple[float, float]) -> Lattice:
    return Lattice(cast(DriveSpace, Yard(drive, gap)))


def late() -> bool:
    return False


def whole(road: Sequence[np.ndarray]) -> list[np.ndarray]:
    return [START, *road, GOAL]


@pytest.mark.parametrize("drive", [Drive.OMNI, Drive.DIFFERENTIAL])
def test_a_gap_of_three_cells_is_found_and_every_piece_of_the_drive_is_free(drive: Drive) -> None:
    yard = Yard(drive, (0.62, 0.92))
    road = lattice(drive, yard.gap).road(START, GOAL, late)
    assert road is not None
    assert all(yard.free(one, other) for one, other in pairwise(whole(road)))
    assert max(pose[1] for pose in road) > 0.62


def test_a_differential_base_drives_only_along_its_heading() -> None:
    road = lattice(Drive.DIFFERENTIAL, (0.62, 0.92)).road(START, GOAL, late)
    assert road is not None
    for one, other in pairwise(road):
        way = other[:2] - one[:2]
        if np.linalg.norm(way) > 0:
            assert one[2] == other[2]
            assert abs(np.cos(one[2]) * way[1] - np.sin(one[2]) * way[0]) < 1e-9


def test_where_there_is_no_gap_the_goal_is_known_to_be_shut_in() -> None:
    closed = lattice(Drive.OMNI, (0.0, 0.0))
    assert closed.road(START, GOAL, late) is None
    assert closed.shut_in(GOAL)
    assert not closed.shut_in(START)
    assert all(i > 10 for i, _, _ in closed.shut)
    closed.begin()
    assert not closed.shut_in(GOAL)


def test_the_floor_that_the_goal_is_shut_in_on_is_known_where_nothing_but_walls_ends_it() -> None:
    closed = lattice(Drive.OMNI, (0.0, 0.0))
    assert closed.road(START, GOAL, late) is None
    assert closed.room == pytest.approx(14 * 19 * 0.01)  # poses from 1.1 to 2.4 m and from -0.9 to 0.9 m
    closed.begin()
    assert closed.room == 0.0
    outside = lattice(Drive.OMNI, (0.0, 0.0))
    outside.space = cast(DriveSpace, replace(Yard(Drive.OMNI, (0.0, 0.0)), east=np.inf, north=0.2))
    assert outside.road(START, GOAL, late) is None
    assert outside.shut_in(GOAL)
    assert outside.room == 0.0, "what was searched ended there, and not the floor"


def test_a_straight_drive_is_taken_only_where_it_is_free() -> None:
    yard = cast(DriveSpace, Yard(Drive.OMNI, (0.62, 0.92)))
    roads = Roads(yard, np.zeros(3), Lattice(yard))
    np.testing.assert_array_equal(roads.straight(START, START + 0.1), np.stack([START, START + 0.1]))
    assert roads.straight(START, GOAL) is None


def test_a_drive_around_leads_to_the_goal_s_heading_and_has_no_corner_that_it_does_without() -> None:
    yard = Yard(Drive.OMNI, (0.62, 0.92))
    road = Roads(cast(DriveSpace, yard), np.zeros(3), lattice(yard.drive, yard.gap)).around(START, GOAL, late)
    assert road is not None
    assert all(yard.free(one, other) for one, other in pairwise(road))
    np.testing.assert_array_equal(road[0], START)
    np.testing.assert_allclose(road[-1], GOAL)
    assert len(road) < 8


def test_a_drive_does_not_depend_on_what_was_asked_before() -> None:
    yard = cast(DriveSpace, Yard(Drive.OMNI, (0.62, 0.92)))
    fresh, used = (Roads(yard, np.zeros(3), Lattice(yard)) for _ in range(2))
    for seed, goal in enumerate((GOAL - [0.3, 0.5, 0.0], np.array([9.0, 0.0, 0.0]), GOAL)):
        used.begin(seed)
        used.around(START, goal, late)
    for roads in (fresh, used):
        roads.begin(7)
    one, other = (roads.around(START, GOAL, late) for roads in (fresh, used))
    assert one is not None
    assert other is not None
    np.testing.assert_array_equal(one, other)


def test_what_is_compiled_before_workers_begin_is_what_a_search_takes() -> None:
    cells.warm()
    assert lattice(Drive.OMNI, (0.62, 0.92)).road(START, GOAL, late) is not None
    assert len(cells.search.signatures) == 1
