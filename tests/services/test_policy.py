"""A policy says one thing, and what it says is part of the question that a stored verdict answers."""

import math

import pytest

from sdt_kg.errors import InputError
from services.app import Policy, load
from services.embodiment.certify import Tolerances
from services.policy import SEEDS, told_contact, told_friction


def test_a_start_and_any_start_contradict_each_other() -> None:
    # Both were taken, and searched was from the base: a proof about one base was told of every other.
    with pytest.raises(InputError, match="one of base and any_start"):
        Policy(any_start=True, base=(0.0, 0.0, 0.0))


def test_any_start_is_nothing_to_a_motion_that_is_to_be_found() -> None:
    kitchen = load("b", ["pr2"], policy=Policy(any_start=True))
    with pytest.raises(InputError, match="no robot's motion is given that may begin anywhere"):
        list(kitchen.achieve("open:iai_fridge_door"))


@pytest.mark.parametrize("seed", [-1, SEEDS])
def test_a_seed_is_an_integer_that_can_be_kept(seed: int) -> None:
    assert Policy(seed=SEEDS - 1).seed == SEEDS - 1
    with pytest.raises(InputError, match=f"a seed of {seed}; allowed: a whole number, 0 or more"):
        Policy(seed=seed)


@pytest.mark.parametrize("contact", [-0.001, 0.0021, 0.1, math.nan])
def test_nothing_is_held_by_fingers_that_are_farther_off_than_the_tool_may_slip(contact: float) -> None:
    assert Policy(contact=0.002).contact == Tolerances().tool_position
    with pytest.raises(InputError, match=r"allowed: 0 to 0\.002 m; fingers .* do not hold it"):
        Policy(contact=contact)
    with pytest.raises(InputError, match=r"allowed: 0 to 0\.002 m"):
        Tolerances.within(contact)


@pytest.mark.parametrize("friction", [0.0, -0.5, 11.0, math.inf, math.nan])
def test_a_friction_is_one_that_pads_may_have(friction: float) -> None:
    assert Policy(friction=0.5).friction == 0.5
    with pytest.raises(InputError, match=r"a coefficient of friction of .*; allowed: 0\.01 to 10"):
        Policy(friction=friction)


def test_a_drive_is_a_drive() -> None:
    with pytest.raises(InputError, match=r"'omni' is no Drive; allowed: Drive\.OMNI"):
        Policy(drive="omni")  # pyright: ignore[reportArgumentType]  # as somebody may type it


@pytest.mark.parametrize("force", [-1.0, 0.0, math.inf])
def test_a_force_that_is_none_is_allowed_nowhere(force: float) -> None:
    with pytest.raises(InputError, match="a handle_force of"):
        load("b").with_forces(handle_force=force)


@pytest.mark.parametrize("budget", [-1.0, math.nan])
def test_a_budget_is_a_time(budget: float) -> None:
    with pytest.raises(InputError, match=r"a budget of (-1|nan) s; allowed: 0 s or more"):
        Policy(budget=budget)


@pytest.mark.parametrize("contact", [0.0, 1e-5, 0.001])
@pytest.mark.parametrize("friction", [None, 0.3])
def test_tolerances_that_a_verdict_has_as_text_are_told(contact: float, friction: float | None) -> None:
    said = repr(Tolerances.within(contact, friction))
    assert (told_contact(said), told_friction(said)) == (contact, friction)


@pytest.mark.parametrize("damaged", ["", "1.2.3", "nan", "one", "-0.1"])
def test_what_is_no_number_in_such_a_text_is_none(damaged: str) -> None:
    said = f"Tolerances(contact={damaged}, cone={damaged})"
    assert (told_contact(said), told_friction(said)) == (None, None)
