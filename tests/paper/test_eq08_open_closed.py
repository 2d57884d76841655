"""Eq. (8): open from 0.9 · upper, closed up to lower + ε."""

import math

import pytest

from predicates.case import Case
from predicates.satisfies_request import satisfies_request
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from tests.small import small_twin


def holds(verb: Verb, container: str, position: float) -> bool:
    twin = small_twin("a")
    joint = twin.container(container).joint
    final = twin.at({joint: position}).state
    (answer,) = satisfies_request(Case(twin, task=Task(verb, twin.container(container).iri), final=final))
    return answer.holds


@pytest.fixture
def twin() -> Twin:
    return small_twin("a")


def test_open_begins_at_90_percent_of_the_upper_limit() -> None:
    assert not holds(Verb.OPEN, "low_drawer", 0.449)
    assert not holds(Verb.OPEN, "low_drawer", math.nextafter(0.450, 0))
    assert holds(Verb.OPEN, "low_drawer", 0.450)  # upper limit 0.500 m
    assert holds(Verb.OPEN, "low_drawer", 0.500)


def test_closed_ends_a_centimetre_above_the_lower_limit() -> None:
    assert holds(Verb.CLOSE, "low_drawer", 0.0)
    assert holds(Verb.CLOSE, "low_drawer", 0.010)
    assert not holds(Verb.CLOSE, "low_drawer", math.nextafter(0.010, 1))


def test_half_open_is_neither_open_nor_closed() -> None:
    assert not holds(Verb.OPEN, "side_door", 0.75)
    assert not holds(Verb.CLOSE, "side_door", 0.75)


def test_a_mimic_door_is_judged_by_its_own_joint_not_by_the_actuated_one() -> None:
    assert not holds(Verb.OPEN, "folding_door", 1.79)  # the upper panel is at 0.895 of 1
    assert holds(
        Verb.OPEN, "folding_door", 1.8
    )  # effective upper limit 2.0: twice the upper panel's 1.0, not 2.4


def test_the_effective_upper_limit_is_the_minimum_over_the_coupling(twin: Twin) -> None:
    assert twin.container("folding_door").upper == 2.0
