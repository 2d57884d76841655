"""Eq. (8): open from 0.9 · upper, closed up to lower + ε."""

import math
import re

import numpy as np
import pytest

import ontology
from predicates.case import Case
from predicates.causes import causes_request
from predicates.satisfies_request import satisfies_request
from sdt_kg.history.events import EventType, events_between
from sdt_kg.load import load_twin
from sdt_kg.motion import Motion
from sdt_kg.state import ROUNDING, State
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.physics.oracle import Kinematics
from tests.sdt_kg.conftest import DRAWER, Write, joint, limit, link, write  # noqa: F401 - a fixture
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
    assert not holds(Verb.OPEN, "low_drawer", 0.450 - 1e-14)
    assert holds(Verb.OPEN, "low_drawer", 0.450)  # upper limit 0.500 m
    assert holds(Verb.OPEN, "low_drawer", 0.500)


def test_closed_ends_a_centimetre_above_the_lower_limit() -> None:
    assert holds(Verb.CLOSE, "low_drawer", 0.0)
    assert holds(Verb.CLOSE, "low_drawer", 0.010)
    assert not holds(Verb.CLOSE, "low_drawer", 0.010 + 1e-14)


def test_the_last_bits_of_a_position_refuse_nothing() -> None:
    assert holds(Verb.OPEN, "low_drawer", math.nextafter(0.450, 0))
    assert holds(Verb.CLOSE, "low_drawer", math.nextafter(0.010, 1))


def test_a_container_that_follows_another_may_end_where_open_begins(write: Write) -> None:  # noqa: F811 - the fixture
    follows = limit(0.0, 0.5) + '<mimic joint="rail" multiplier="3"/>'
    rail = joint("rail", "prismatic", "world", "rail_body", limit(0.0, 0.2))
    drawer = [each.replace(limit(0.0, 0.5), follows) for each in DRAWER]
    twin = load_twin(write(*drawer, link("rail_body"), rail))
    (container,) = twin.containers()
    begin, end = twin.state[container.joint], container.open_from
    assert (container.upper, end) == (0.5, 0.45)
    motion = Motion(container.joint, np.array([0.0, 4.0]), np.array([[begin], [end]]), timed=False)
    (answer,) = causes_request(Case(twin, task=Task(Verb.OPEN, container.iri), motion=motion), Kinematics())
    assert isinstance(answer.case.final, State)
    assert answer.case.final[container.joint] == 3 * (0.45 / 3) == math.nextafter(0.45, 0)
    assert answer.holds, answer.diagnoses
    there = twin.at(answer.case.final)
    assert [str(row["container"]) for row in there.select("open")] == [container.iri]
    happened = [each.type for each in events_between(twin, there)]
    assert happened == [EventType.OPENED, EventType.NO_LONGER_CLOSED]


def test_queries_and_values_take_the_same_for_rounding() -> None:
    for name in ("satisfied_requests", "open", "closed", "cq11_in_how_many_states_is_a_container_open"):
        query = ontology.path(f"queries/{name}.rq").read_text()
        said = re.findall(r"\?position [<>]= \?\w+ [-+] (\S+?)[),\s]", query)
        assert said, name
        assert {float(each) for each in said} == {ROUNDING}, name


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
