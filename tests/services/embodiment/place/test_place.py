"""`place`: every pose that is given is certified when it is asked again, and the map contradicts none."""

import re
from dataclasses import replace

import numpy as np
import pytest

from predicates.case import Outcome
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.task import Task, Verb
from services.app import Policy, load
from services.embodiment.oracle import WholeBody
from services.embodiment.place import Placement, Status, place, spots
from services.embodiment.place.answer import base_of, lines, to_json
from services.embodiment.place.asked import placed
from services.embodiment.prove.prover import Prover
from services.requests import parse_base

pytestmark = pytest.mark.oracle

DRAWER = "sink_area_left_middle_drawer_main"
ISLAND = "kitchen_island_left_upper_drawer_main"
BUDGET = 60.0  # [s] far more than is needed: a full machine must not decide this test
SEEDS = 3


@pytest.fixture(scope="module")
def found() -> Placement:
    twin = load("b", ["pr2"]).twin
    return place(twin, twin.robots[0], Task(Verb.OPEN, twin.container(DRAWER).iri), BUDGET, SEEDS, enough=2)


@pytest.mark.parametrize(("tried", "told"), [(0, True), (3, False)])
def test_where_no_pose_was_even_asked_about_it_is_said_why(found: Placement, tried: int, told: bool) -> None:
    said = next(lines(to_json(replace(found, spots=(), tried=tried))))
    why = "; no hold was found that follows the handle while the base stands where it can be parked"
    assert said == f"no pose found for {DRAWER}: searched, not proved" + why * told


def test_the_best_pose_is_certified_when_it_is_asked_again(found: Placement) -> None:
    best = found.best
    assert best is not None
    policy = Policy(Drive.FIXED, (best.x, best.y, best.yaw), BUDGET, SEEDS)
    (verdict,) = load("b", ["pr2"], policy=policy).achieve(f"open:{DRAWER}")
    assert verdict.outcome is Outcome.CERTIFIED
    assert [spot.margin for spot in found.spots] == sorted((one.margin for one in found.spots), reverse=True)


def test_a_telescope_that_pulls_a_drawer_lies_along_its_way_to_the_last_digit_that_is_printed() -> None:
    service = load("b", ["stretch"])
    task, robot = Task(Verb.OPEN, service.twin.container(ISLAND).iri), service.robot(None)
    (spot,) = spots(service.twin, robot, task, BUDGET, SEEDS, enough=1)
    assert spot.yaw % np.pi == pytest.approx(np.pi / 2, abs=1e-6)
    policy = Policy(Drive.FIXED, parse_base(base_of(spot)), BUDGET, SEEDS)
    (verdict,) = load("b", ["stretch"], policy=policy).achieve(f"open:{ISLAND}")
    assert verdict.outcome is Outcome.CERTIFIED
    start = dict(WholeBody(Drive.FIXED, (spot.x, spot.y, spot.yaw)).settings(service.twin, robot))["start"]
    assert parse_base(start) == (spot.x, spot.y, spot.yaw)  # a pose rounded off is another question


def test_the_map_shows_the_poses_and_proves_none_of_them_impossible(found: Placement) -> None:
    marked = [cell for row in found.rows for cell in row if cell.status is Status.CERTIFIED]
    assert marked
    for spot in found.spots:
        near = min(abs(cell.x - spot.x) + abs(cell.y - spot.y) for row in found.rows for cell in row)
        inside = min(abs(cell.x - spot.x) + abs(cell.y - spot.y) for cell in marked)
        assert inside == near
    assert to_json(found)["impossible"] is False
    assert any("certified" in line and "#" in line for line in lines(to_json(found)))
    assert "--drive fixed --friction 0.3  gripper" in next(iter(lines(to_json(found), 0.3)))


def test_people_find_each_pose_on_the_map_that_they_read(found: Placement) -> None:
    shown = list(lines(to_json(found)))
    (head,) = (k for k, line in enumerate(shown) if line.startswith("map, "))
    size, x, y = map(float, re.findall(r"(-?[\d.]+) m", shown[head]))
    rows = [line.split() for line in shown[head + 1 : head + 1 + len(found.rows)]][::-1]
    for spot in found.spots:
        assert rows[round((spot.y - y) / size)][round((spot.x - x) / size)] == "#"


def test_a_square_across_the_room_is_proved_impossible_and_one_that_holds_a_pose_is_not(
    found: Placement,
) -> None:
    twin = load("b", ["pr2"]).twin
    container = twin.container(DRAWER)
    values = np.array([0.0, container.open_from])
    prover = Prover(twin, twin.robots[0], container, Drive.FIXED, (0.0, 0.0, 0.0), values)
    assert prover.standing((-2.0, 0.0, 0.0), (0.3, 0.3, np.pi)).excludes(400)
    for spot in found.spots:
        assert not prover.standing((spot.x, spot.y, 0.0), (0.01, 0.01, np.pi)).excludes(4000)


def test_what_is_open_already_needs_no_place() -> None:
    twin = load("b", ["pr2"], state=[f"{DRAWER}=open"]).twin
    answer = place(twin, twin.robots[0], Task(Verb.OPEN, twin.container(DRAWER).iri), BUDGET)
    assert answer.spots == ()
    assert answer.diagnoses


def test_a_task_about_no_container_is_refused() -> None:
    twin = load("b", ["pr2"]).twin
    with pytest.raises(InputError, match="no container"):
        place(twin, twin.robots[0], Task(Verb.OPEN), BUDGET)
    with pytest.raises(InputError, match=r"'open' names no container; allowed: open:CONTAINER or close:"):
        placed(twin, twin.robots[0], "open", budget=BUDGET, seed=0, friction=None)


def test_what_is_asked_in_words_is_answered_as_its_placement() -> None:
    twin = load("b", ["pr2"], state=[f"{DRAWER}=open"]).twin
    said = placed(twin, twin.robots[0], f"open:{DRAWER}", budget=BUDGET, seed=0, friction=None)
    task = Task(Verb.OPEN, twin.container(DRAWER).iri)
    expected = to_json(place(twin, twin.robots[0], task, BUDGET))
    assert said | {"seconds": 0.0} == expected | {"seconds": 0.0}
    assert said["diagnoses"][0]["reason"].startswith("nothing to cause")
