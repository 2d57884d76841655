"""Every case that Table 1 certifies is certified again as it was made, and known for what it does."""

import pytest

from tests.conftest import Table1
from tests.test_modes_agree import ROBOTS, check_agree

pytestmark = [pytest.mark.oracle, pytest.mark.slow]


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("kitchen", ["a", "b"])
def test_modes_agree_in_every_case(table1: Table1, kitchen: str, robot: str) -> None:
    check_agree(table1, kitchen, robot, 1)
