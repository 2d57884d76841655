"""A certificate says which joints move besides those of who holds."""

import numpy as np
import pytest

from sdt_kg.motion import BodyMotion
from sdt_kg.twin import Twin
from services.embodiment.certify import Certified
from tests.services.embodiment.gantry import RESTS, opening
from tests.services.embodiment.judging import judge
from tests.services.embodiment.two_hands import BOTH, taken_over, two_handed

pytestmark = pytest.mark.oracle

BESIDES = "besides gripper "


@pytest.fixture(scope="module")
def twin(tmp_path_factory: pytest.TempPathFactory) -> Twin:
    return two_handed(tmp_path_factory.mktemp("two"))


def told(twin: Twin, motion: BodyMotion) -> list[str]:
    """What the certificate says of what moves besides who holds."""
    found = judge(twin, motion)
    assert isinstance(found, Certified), found.diagnoses
    return [each for each in found.nearest if each.startswith(BESIDES)]


def pulled(aside: float, opened: float = 0.04) -> BodyMotion:
    """The first hand opens the drawer; the second arm, and its fingers, are elsewhere meanwhile."""
    second = np.full((len(RESTS), 2), (0.0, 0.04))
    second[2:4] = aside, opened
    return opening(0.1, np.hstack((RESTS[:, :-1], second, RESTS[:, -1:])), BOTH)


def test_another_arm_that_moves_is_named_with_its_joints(twin: Twin) -> None:
    (said,) = told(twin, pulled(0.1, 0.02))
    assert said == f"{BESIDES}hand and what carries it these joints move: second_arm_joint, second_up_joint"


def test_what_stands_is_not_named_though_the_base_carries_it(twin: Twin) -> None:
    assert told(twin, pulled(0.0)) == []


def test_what_moves_by_less_than_is_told_stands(twin: Twin) -> None:
    assert told(twin, pulled(0.0009)) == []
    assert len(told(twin, pulled(0.0011))) == 1


def test_hands_that_hold_in_turn_are_both_of_who_holds(twin: Twin) -> None:
    assert told(twin, taken_over()) == []
