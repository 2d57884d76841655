"""Requests about all containers of a kitchen are looked at together; none is called inside that is not."""

import pytest

from predicates.case import Case
from predicates.scope import are_inside, look_at_all, out_of_scope, verb_iri
from sdt_kg.iri import SDT
from sdt_kg.load import load_twin
from sdt_kg.scope import D_ARTIC, D_ARTIC_DYN, about_kitchen, shapes_about
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin

OPEN = D_ARTIC.iri, verb_iri(Verb.OPEN)


@pytest.fixture
def kitchen() -> Twin:
    return load_twin("b")


def outside(twin: Twin) -> list[str]:
    """Containers of the kitchen that are outside."""
    asked = ((each, Case(twin, task=Task(Verb.OPEN, each.iri))) for each in twin.containers())
    return [each.iri for each, case in asked if out_of_scope(case, each)]


def test_what_is_inside_alone_is_found_inside_together(kitchen: Twin) -> None:
    assert not outside(kitchen)
    look_at_all(kitchen, Verb.OPEN)
    assert kitchen.entities.inside[OPEN] == {each.iri for each in kitchen.containers()}
    assert not outside(kitchen)


def test_where_one_is_outside_each_is_looked_at_alone(kitchen: Twin) -> None:
    wrong = kitchen.containers()[3]
    edited = kitchen.with_edit(wrong.joint, velocityLimit=0.0)
    look_at_all(edited, Verb.OPEN)
    assert OPEN not in edited.entities.inside
    assert outside(edited) == [wrong.iri]


def test_an_edit_of_a_kitchen_that_was_looked_at_is_looked_at_anew(kitchen: Twin) -> None:
    look_at_all(kitchen, Verb.OPEN)
    wrong = kitchen.containers()[0]
    assert outside(kitchen.with_edit(wrong.joint, velocityLimit=0.0)) == [wrong.iri]


def test_what_only_another_request_says_puts_none_inside(kitchen: Twin) -> None:
    verb, expected = verb_iri(Verb.OPEN), shapes_about(D_ARTIC, verb_iri(Verb.OPEN))
    one, other = (tuple(about_kitchen(kitchen, each, verb, D_ARTIC)) for each in kitchen.containers()[:2])
    assert are_inside(D_ARTIC, (one, other), expected)
    limits = tuple(each for each in one if each[1] == SDT + "velocityLimit")
    assert limits
    lacking = tuple(each for each in one if each not in limits)
    assert not are_inside(D_ARTIC, (lacking, other), expected)
    assert not are_inside(D_ARTIC, (lacking, (*other, *limits)), expected)


def test_a_kitchen_without_forces_is_outside_the_class_with_forces_alone(kitchen: Twin) -> None:
    look_at_all(kitchen, Verb.OPEN, D_ARTIC_DYN)
    assert OPEN in kitchen.entities.inside
    assert (D_ARTIC_DYN.iri, verb_iri(Verb.OPEN)) not in kitchen.entities.inside


def test_a_request_in_which_a_shape_finds_nothing_is_not_inside(kitchen: Twin) -> None:
    verb, expected = verb_iri(Verb.OPEN), shapes_about(D_ARTIC, verb_iri(Verb.OPEN))
    one, other = (tuple(about_kitchen(kitchen, each, verb, D_ARTIC)) for each in kitchen.containers()[:2])
    blind = tuple(each for each in one if each[1] != SDT + "hasHandle" and each[1] != SDT + "hasJoint")
    assert not are_inside(D_ARTIC, (blind, other), expected)
