"""Pairs of the right arms that were proved apart; those of the left are in `tests/robots`."""

import pytest

from tests.robots.conftest import Robot, robot, theirs  # noqa: F401 - fixtures
from tests.robots.test_proved_apart import RIGHT, assert_apart

pytestmark = pytest.mark.reference


@pytest.mark.parametrize("robot", RIGHT, indirect=True)
def test_allowed_pairs_of_the_right_arm_are_apart_in_the_reference(
    robot: Robot,  # noqa: F811 - the fixture
    theirs: Robot,  # noqa: F811 - the fixture
) -> None:
    assert_apart(robot, theirs, RIGHT[robot.name])
