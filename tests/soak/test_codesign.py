"""What is cleared or opened makes room: plans and families on real kitchens."""

import pytest

from predicates.case import Outcome
from sdt_kg.annotation import Drive
from services.app import Policy, load
from services.codesign.asked import Asked
from services.codesign.design import designed
from services.codesign.judge import one_of
from services.codesign.smallest.families import families
from services.whatif import World, changed, parse_change

OPENED = "move:cabinet7_door_bottom_left=open"

pytestmark = [pytest.mark.oracle, pytest.mark.slow]


@pytest.mark.parametrize("edit", [OPENED, f"furniture:wardrobe=0.5,0 & {OPENED}"])
def test_the_drawer_behind_the_dishwasher_door_is_planned_by_opening_that_door(edit: str) -> None:
    drawer = "dishwasher_drawer_middle"
    asked = Asked(("a",), ("stretch",), "open", (), Policy(budget=5), (), (drawer, "cabinet9_drawer_top"))
    edits = ("furniture:wardrobe=0.5,0", edit)
    (plan,) = designed(asked, 1, edits).plans
    assert [(each.what, each.gained, each.covered) for each in plan.steps] == [(edit, (drawer,), 2)]


def test_what_a_refusal_names_is_cleared_and_a_door_that_stands_open_is_closed() -> None:
    world = World(load("b", ["pr2"], policy=Policy(Drive.OMNI, budget=2)), "pr2")
    edits = ("box:crate=1.2,1.2,1@0.3,-0.41,0.5", "move:iai_fridge_door=0.5")  # the drawer runs into it
    world = changed(world, tuple(map(parse_change, edits)))
    container = world.service.twin.container("sink_area_trash_drawer_main")
    verdict = one_of(world.service.achieve(f"open:{container.name}", world.robot_iri))
    assert verdict.outcome is Outcome.NOT_CERTIFIED
    found = {each.name: each for each in families(world, verdict, container)}
    assert found["which obstacle is cleared"].edits[0] == "clear:crate"
    assert "move:iai_fridge_door=closed" in found["which other door or drawer is moved"].edits
    cleared = changed(world, (parse_change("clear:crate"),))
    assert one_of(cleared.service.achieve(f"open:{container.name}", world.robot_iri)).diagnoses == ()
