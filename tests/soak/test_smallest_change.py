"""Every smallest change that is told is certified when it is asked for by name, in the time of a case."""

import pytest

from predicates.case import Outcome
from services.app import Policy, load
from services.codesign.turning import Question, turned
from services.whatif import World, changed, parse_change

pytestmark = [pytest.mark.oracle, pytest.mark.slow]

REFUSED = (
    ("a", "pr2", "wardrobe_door_left"),
    ("a", "stretch", "dishwasher_drawer_middle"),
    ("b", "stretch", "oven_area_oven_door"),
    ("a", "pr2", "cabinet7_door_bottom_left"),
)
WITHIN = 30.0  # [s] a case
LAST = 3.0  # [s] by which the last edit may take longer than the longest before it


@pytest.mark.parametrize(("kitchen", "robot", "container"), REFUSED)
def test_what_turns_a_refusal_is_certified_when_asked_by_name(kitchen, robot, container) -> None:
    question = Question(kitchen, robot, f"open:{container}", (), Policy())
    found = turned(question, WITHIN, 2)
    assert found.actual.outcome is Outcome.NOT_CERTIFIED
    assert found.seconds < WITHIN + LAST
    world = World(load(kitchen, [robot]), robot)
    for each in found.sought:
        if each.turn is None:
            continue
        after = changed(world, (parse_change(each.turn.edit),))
        (verdict,) = after.service.achieve(f"open:{container}", after.robot_iri)
        assert verdict.outcome is Outcome.CERTIFIED, each.turn.edit
