"""Where no gripper is named, another may take over: it comes once the one before has left the handle."""

import re

import pytest

from sdt_kg.motion import Motion
from sdt_kg.twin import Twin
from services.embodiment.certify import Certified
from services.embodiment.certify.certificate import read_certificate
from tests.services.embodiment.judging import judge
from tests.services.embodiment.judging import reasons as why_refused
from tests.services.embodiment.two_hands import (
    ARM,
    COMES,
    FINGER,
    GONE,
    LEAVES,
    SECOND_ARM,
    SECOND_FINGER,
    SHUTS,
    VALUE,
    taken_over,
    two_handed,
)

pytestmark = pytest.mark.oracle

CLOSED, AT_BAR, IN_BAR = 0.005, 0.605, 0.5902


@pytest.fixture(scope="module")
def twin(tmp_path_factory: pytest.TempPathFactory) -> Twin:
    return two_handed(tmp_path_factory.mktemp("two"))


def reasons(twin: Twin, *changes: tuple[int, int, float], gripper: str = "", **more: bool | Motion) -> str:
    """Why the motion, so changed, is refused."""
    return why_refused(twin, taken_over(*changes, gripper=gripper), **more)


@pytest.mark.parametrize("step", [0.02, 0.1, 100.0])
def test_the_other_hand_may_take_over_where_the_container_rests(twin: Twin, step: float) -> None:
    found = judge(twin, taken_over(step=step))
    assert isinstance(found, Certified), found.diagnoses
    assert found.figures["holds"] == (2.0, "1")
    told = "is held from 11.00 s to 15.00 s, then anew, by gripper second after hand"
    assert any(told in one for one in found.nearest)


def test_a_certificate_of_two_hands_is_verified_again(twin: Twin) -> None:
    found = judge(twin, taken_over())
    assert isinstance(found, Certified)
    motion = read_certificate(found.certificate.content()).motion
    again = judge(twin, motion)
    assert isinstance(again, Certified)
    assert again.figures == found.figures


@pytest.mark.parametrize(
    ("gripper", "reason"),
    [
        ("hand", "drawer_main moves on before it is held anew"),
        ("second", "drawer_main moves before it is held"),
    ],
)
def test_a_gripper_that_is_named_holds_alone(twin: Twin, gripper: str, reason: str) -> None:
    assert reason in reasons(twin, gripper=gripper)


def test_where_one_hold_is_asked_for_none_takes_over(twin: Twin) -> None:
    assert "is let go at 0.23 m" in reasons(twin, one_hold=True)


def test_both_hands_are_never_at_the_handle_at_once(twin: Twin) -> None:
    stays = [(row, ARM, AT_BAR) for row in range(LEAVES, SHUTS + 1)]
    stays += [(SHUTS + 1, ARM, 0.575), *((row, FINGER, CLOSED) for row in range(LEAVES, SHUTS + 2))]
    assert "second_up_finger and drawer_handle" in reasons(twin, *stays)


def test_the_hand_that_let_go_keeps_clear_of_the_handle(twin: Twin) -> None:
    """Its closed fingers come 0.2 mm into the bar from before, while the second hand holds that."""
    comes = [(COMES, ARM, IN_BAR), (SHUTS, ARM, IN_BAR), (SHUTS + 1, ARM, IN_BAR - 0.03)]
    comes += [(row, FINGER, 0.0005) for row in range(COMES, SHUTS + 2)]
    assert re.search(r"(^| )up_finger and drawer_handle are \d\.\d mm in each other", reasons(twin, *comes))


def test_the_second_hand_is_not_at_the_handle_before_the_first_has_left(twin: Twin) -> None:
    early = [(row, SECOND_ARM, AT_BAR) for row in (LEAVES, GONE)]
    early += [(LEAVES, SECOND_FINGER, CLOSED), (GONE, SECOND_FINGER, CLOSED), (COMES, SECOND_FINGER, CLOSED)]
    assert "second_up_finger and drawer_handle" in reasons(twin, *early)


def test_the_container_does_not_move_on_before_the_second_hand_holds_it(twin: Twin) -> None:
    assert "moves on before it is held anew" in reasons(twin, (SHUTS, VALUE, 0.24), (COMES, VALUE, 0.23))


@pytest.mark.parametrize(("open_by", "certified"), [(0.0065, True), (0.0071, False)])
def test_the_second_hand_holds_as_any_hand_does(twin: Twin, open_by: float, certified: bool) -> None:
    motion = taken_over((SHUTS, SECOND_FINGER, open_by), (SHUTS + 1, SECOND_FINGER, open_by))
    assert isinstance(judge(twin, motion), Certified) is certified


def test_a_tool_that_slips_in_the_second_hand_is_refused_and_no_contact_is_called_lost(twin: Twin) -> None:
    said = reasons(twin, (SHUTS + 1, SECOND_ARM, 0.571), in_full=True)
    assert "the tool slips by 0.004 m on drawer_handle" in said
    assert "is lost" not in said
    assert "collision" not in said
