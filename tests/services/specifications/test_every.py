"""A step for every container, where some move together: each is asked in its turn, all at the end."""

from pathlib import Path

import pytest

import tests.small
from predicates.case import Kind, Outcome
from predicates.specification.read import read_specification
from sdt_kg.errors import InputError
from sdt_kg.load import load_twin
from services.app import Policy, Service
from services.specifications import TaskResult, achieve_task, result_json
from services.specifications.told import ORDER
from tests.small.lift import Lifts

PAIR = Path(__file__).parents[1] / "dynamics" / "pair.urdf"
"""A cupboard with two leaves, and a drawer that another one follows half as far."""

EVERY = """
@prefix law: <https://example.org/law#> .
@prefix t: <https://example.org/id/t/> .
t:task a law:TaskSpecification ; law:hasStep t:one .
t:one a law:Task ; law:index 1 ; law:verb law:Open ; law:everyContainer true .
"""


@pytest.fixture
def run(tmp_path: Path):
    def of(told: str) -> TaskResult:
        urdf = tmp_path / "pair.urdf"
        urdf.write_text(PAIR.read_text().replace('multiplier="0.5"', told))
        robot = Path(tests.small.__file__).parent / "pr2.urdf"
        service = Service(load_twin(str(urdf), [str(robot)]), oracles=Lifts(), policy=Policy())
        return achieve_task(service, read_specification(service.twin, EVERY, "every.ttl"))

    return of


def test_what_another_opened_on_the_way_is_not_asked_again(run) -> None:
    found = run('multiplier="0.5"')
    assert [str(each.request) for each in found.steps] == ["open left_leaf", "open lower_drawer"]
    assert (found.outcome, found.of) == (Outcome.CERTIFIED, 2), "upper_drawer opened with lower_drawer"


def test_every_container_is_open_at_the_end_or_the_step_is_not_certified(run) -> None:
    found = run('multiplier="-0.5" offset="0.25"')
    assert [str(each.request) for each in found.steps] == ["open left_leaf", "open upper_drawer"]
    assert {each.verdict.outcome for each in found.steps} == {Outcome.CERTIFIED}
    assert found.outcome is Outcome.NOT_CERTIFIED, "lower_drawer, open at first, closes as upper_drawer opens"
    (undone,) = found.diagnoses
    assert (undone.kind, undone.proof) == (Kind.SEMANTIC, False)
    assert "open lower_drawer" in undone.reason


def test_a_refused_step_for_every_container_says_that_another_order_was_not_tried(run) -> None:
    assert ORDER in result_json(run('multiplier="-0.5" offset="0.25"'))["notes"]
    assert ORDER not in result_json(run('multiplier="0.5"'))["notes"]


def test_a_step_for_every_container_has_no_goal_position_not_even_0() -> None:
    text = EVERY.replace("true .", "true ; law:goalPosition 0.0 .")
    with pytest.raises(InputError, match="about every container, and about one"):
        read_specification(load_twin(str(PAIR)), text, "every.ttl")
