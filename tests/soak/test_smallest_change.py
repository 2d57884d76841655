"""Every smallest change that is told is certified when it is asked for by name, in the time of a case.

Where smaller ones are said to have been tried as finely as the tolerance, none on another grid turns it.
"""

import numpy as np
import pytest

from predicates.case import Outcome
from services.app import Policy, load
from services.codesign.smallest.families import LENGTH_TOLERANCE, made_at_once
from services.codesign.smallest.sought import Question
from services.codesign.smallest.turning import turned
from services.whatif import World, changed

pytestmark = [pytest.mark.oracle, pytest.mark.slow]

CASES = (
    ("a", "pr2", "wardrobe_door_left"),
    ("a", "stretch", "dishwasher_drawer_middle"),
    ("a", "stretch", "cabinet1_door_top_left"),
    ("a", "stretch", "cabinet4_door_bottom"),
    ("b", "stretch", "oven_area_oven_door"),
    ("b", "pr2", "iai_fridge_door"),
)
"""Refusals in kitchen a but for the wardrobe; of what is certified, what breaks it."""
JOBS = 2
WITHIN = 30.0  # [s] of CPU of each process
LAST = 3.0  # [s] by which the last edit may take longer than the longest before it
STEP = 0.04  # [m] of the grid of smaller changes


@pytest.mark.parametrize(("kitchen", "robot", "container"), CASES)
def test_what_turns_a_verdict_does_so_when_asked_by_name_and_nothing_smaller_that_counts(
    kitchen, robot, container
) -> None:
    question = Question(kitchen, robot, f"open:{container}", (), Policy())
    found = turned(question, WITHIN, JOBS)
    assert found.cpu_seconds < JOBS * (WITHIN + LAST)
    is_refused = found.actual.outcome is Outcome.NOT_CERTIFIED
    world = World(load(kitchen, [robot], policy=Policy(budget=WITHIN / 20)), robot)

    def is_certified(text: str) -> bool:
        after = changed(world, made_at_once(text))
        (verdict,) = after.service.achieve(f"open:{container}", after.robot_iri)
        return verdict.outcome is Outcome.CERTIFIED

    for each in found.sought:
        if each.turn is None:
            continue
        assert is_certified(each.turn.edit) is is_refused, each.turn.edit
        if each.family.start is None and each.family.scan and each.is_complete:
            for text in less(each.turn.edit):
                assert is_certified(text) is not is_refused, text


def less(edit: str) -> list[str]:
    """The edit on a grid of smaller ones, as far as the tolerance."""
    kind, _, rest = edit.partition("=")
    numbers = np.array([float(each) for each in rest.split(",")])
    size = float(np.abs(numbers).max())
    steps = np.arange(STEP, size - LENGTH_TOLERANCE, STEP)
    return [f"{kind}={','.join(repr(float(each)) for each in numbers * step / size)}" for step in steps]
