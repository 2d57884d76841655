"""Every smallest change that is told is certified when it is asked for by name, in the time of a case.

And it is the smallest: of those smaller by more than the tolerance none on a grid is certified.
"""

import numpy as np
import pytest

from predicates.case import Outcome
from services.app import Policy, load
from services.codesign.families import LENGTH_TOLERANCE
from services.codesign.turning import Question, turned
from services.whatif import World, changed, parse_change

pytestmark = [pytest.mark.oracle, pytest.mark.slow]

REFUSED = (
    ("a", "pr2", "wardrobe_door_left"),
    ("a", "stretch", "dishwasher_drawer_middle"),
    ("b", "stretch", "oven_area_oven_door"),
    pytest.param(
        *("a", "stretch", "cabinet1_door_top_left"),
        marks=pytest.mark.xfail(
            reason="lowered by 0.16 m it opens, by more again not; 0.22 m is told", strict=True
        ),
    ),
)
JOBS = 2
WITHIN = 30.0  # [s] of CPU of each process
LAST = 3.0  # [s] by which the last edit may take longer than the longest before it
STEP = 0.04  # [m] of the grid of smaller changes


@pytest.mark.parametrize(("kitchen", "robot", "container"), REFUSED)
def test_what_turns_a_refusal_is_certified_when_asked_by_name(kitchen, robot, container) -> None:
    question = Question(kitchen, robot, f"open:{container}", (), Policy())
    found = turned(question, WITHIN, JOBS)
    assert found.actual.outcome is Outcome.NOT_CERTIFIED
    assert found.cpu_seconds < JOBS * (WITHIN + LAST)
    world = World(load(kitchen, [robot]), robot)
    for each in found.sought:
        if each.turn is None:
            continue
        after = changed(world, (parse_change(each.turn.edit),))
        (verdict,) = after.service.achieve(f"open:{container}", after.robot_iri)
        assert verdict.outcome is Outcome.CERTIFIED, each.turn.edit
        smaller = [] if each.family.lengths or not each.family.scan else less(each.turn.edit)
        for text in smaller:
            world = World(load(kitchen, [robot], policy=Policy(budget=WITHIN / 20)), robot)
            after = changed(world, (parse_change(text),))
            (verdict,) = after.service.achieve(f"open:{container}", after.robot_iri)
            assert verdict.outcome is not Outcome.CERTIFIED, text


def less(edit: str) -> list[str]:
    """The edit on a grid of smaller ones, as far as the tolerance."""
    kind, _, rest = edit.partition("=")
    numbers = np.array([float(each) for each in rest.split(",")])
    size = float(np.abs(numbers).max())
    steps = np.arange(STEP, size - LENGTH_TOLERANCE, STEP)
    return [f"{kind}={','.join(repr(float(each)) for each in numbers * step / size)}" for step in steps]
