"""What a grid reuses is true in the edited world: certified in full there, or found by no search there."""

from collections import Counter

import pytest

from predicates.case import Outcome
from sdt_kg.annotation import Drive
from services.app import Policy, Service, load
from services.codesign.asked import Asked, worlds_of
from services.codesign.entries import Entry, How
from services.codesign.grid import run
from services.codesign.judge import motion_of
from services.whatif import World, changed, parse_change

pytestmark = [pytest.mark.oracle, pytest.mark.slow]

EDITS = (
    "box:crate=0.4,0.4,0.9@0.6,1.2,0.45 | box:bin=0.3,0.3,0.7@0.7,0.3,0.35 | "
    "box:lamp=0.2,0.2,1.8@0.4,2.2,0.9 | move:iai_fridge_door=open | handle:iai_fridge_door=0,0,0.1 | "
    "furniture:kitchen_island=0.2,0 | jam:sink_area_left_middle_drawer_main | drive:omni | "
    "broken:left | payload:right=0.1,0.1,0.2"
)
ASKED = Asked(("b",), ("pr2", "stretch"), "open", worlds_of([EDITS]), Policy(budget=5))
STANDING = Asked(
    ("b",),
    ("stretch",),
    "open",
    worlds_of(["box:crate=0.4,0.4,0.9@0.6,1.2,0.45 | box:lamp=0.2,0.2,1.8@0.4,2.2,0.9"]),
    Policy(Drive.FIXED, budget=2),
)
"""Where much is refused: what drives opens everything in the world as it is."""


@pytest.fixture(scope="module")
def grid():
    return run(ASKED, 2)


def _service(entry: Entry, asked: Asked = ASKED) -> tuple[Service, World]:
    world = World(load(entry.kitchen, [entry.robot], policy=asked.policy), entry.robot)
    after = changed(world, tuple(map(parse_change, entry.edits)))
    return after.service, after


def test_every_motion_certified_by_touched_pairs_alone_is_certified_in_full(grid) -> None:
    again = [each for each in grid.edited() if each.found.how is How.AGAIN]
    assert len(again) > 100
    for entry in again:
        service, after = _service(entry)
        motion = motion_of(entry.found)
        (verdict,) = service.achieve(f"open:{entry.container}", after.robot_iri, motion)
        assert verdict.outcome is Outcome.CERTIFIED, (entry.edits, entry.robot, entry.container)


@pytest.mark.parametrize("asked", [ASKED, STANDING], ids=["driving", "standing"])
def test_no_search_finds_what_was_refused_without_one(asked: Asked, request: pytest.FixtureRequest) -> None:
    found = request.getfixturevalue("grid") if asked is ASKED else run(asked, 2)
    reused = [each for each in found.edited() if each.found.how in {How.LESS_ROOM, How.NOTHING, How.CAUSES}]
    assert Counter(each.found.how for each in reused)[How.LESS_ROOM] > 0 or asked is ASKED
    assert reused
    for entry in reused:
        service, after = _service(entry, asked)
        (verdict,) = service.achieve(f"open:{entry.container}", after.robot_iri)
        assert verdict.outcome is entry.found.outcome, (entry.edits, entry.robot, entry.container)


def test_each_case_is_there_once_and_no_refusal_is_without_a_reason(grid) -> None:
    keys = [(each.key, each.edits) for each in grid.entries]
    assert len(keys) == len(set(keys)) == 2 * 17 * 11
    assert all(each.found.diagnoses for each in grid.entries if each.found.outcome is not Outcome.CERTIFIED)
