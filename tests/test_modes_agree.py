"""What generation makes, verification certifies and explanation names: a third of what Table 1 certifies.

`make soak` asks about all of it.
"""

import pytest

from predicates.case import Case, Outcome
from predicates.law import law
from sdt_kg.task import Verb
from services import load
from services.motions import read_motion
from tests.conftest import Table1

ROBOTS = ("pr2", "tiago_dual", "stretch")
STRIDE = 3  # every so many cases


@pytest.mark.oracle
@pytest.mark.slow
@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("kitchen", ["a", "b"])
def test_modes_agree(table1, kitchen, robot) -> None:
    check_agree(table1, kitchen, robot, STRIDE)


def check_agree(table1: Table1, kitchen: str, robot: str, stride: int) -> None:
    """What is made is certified again, and is known for what it does; of every so many cases."""
    service = load(kitchen, [robot], policy=table1.policy)
    cells = [each.cell for each in table1.result.results if each.verdict["outcome"] == "certified"]
    mine = [cell for cell in cells if (cell.kitchen, cell.robot) == (kitchen, robot)]
    assert mine
    for cell in mine[::stride]:
        motion = read_motion(table1.motions / cell.file_name, service.twin)
        (verified,) = service.achieve(cell.task, motion=motion)
        assert verified.outcome is Outcome.CERTIFIED, (cell.task, verified.diagnoses)
        explained = list(law(Case(service.twin, body_motion=motion), service.physics, service.embodiment))
        named = {(each.case.task.verb, service.twin.name(each.case.task.container)) for each in explained}
        assert named == {(Verb.OPEN, cell.task.partition(":")[2])}
        assert [each.outcome for each in explained] == [Outcome.CERTIFIED]
