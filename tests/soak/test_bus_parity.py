"""The whole of Table 1 asked over the bus: the same verdicts, by IRI and outcome, as in process."""

import pytest

from sdt_kg.annotation import Drive
from services.app import Policy
from services.bus.client import Connection
from services.bus.serving import alone
from services.bus.sessions import open_session
from services.table import cells, run
from tests.ports import free_endpoint

pytestmark = [pytest.mark.oracle, pytest.mark.slow]

ROBOTS = ("pr2", "tiago_dual", "stretch")
BUDGET = 120.0
"""[s] Of search for each container: on a busy machine the usual one may end before the answer."""
PATIENT = 3600.0
"""[s] For all containers of a kitchen and a robot."""

Verdicts = dict[tuple[object, object], tuple[object, object]]


def by_case(verdicts: list[dict[str, object]]) -> Verdicts:
    """Robot and container → IRI and outcome."""
    return {(each["robot"], each["container"]): (each["iri"], each["outcome"]) for each in verdicts}


@pytest.mark.parametrize(("kitchen", "containers"), [("a", 27), ("b", 17)])
def test_table_1_over_the_bus_is_table_1_in_process(kitchen: str, containers: int) -> None:
    endpoint = free_endpoint()
    here = run(
        cells((kitchen,), ROBOTS, "open", (), Policy(drive=Drive.OMNI, budget=BUDGET)), 2, lambda result: None
    )
    with (
        open_session(listen=endpoint) as session,
        alone(session, (kitchen,), ROBOTS),
        open_session(connect=endpoint, mode="client") as asking,
    ):
        to = Connection(asking, kitchen, deadline=PATIENT)
        there = [to.achieve("open", robot, drive="omni", budget=BUDGET) for robot in ROBOTS]
    told = by_case([verdict for each in there for verdict in each.objects])
    assert len(told) == len(ROBOTS) * containers
    assert told == by_case([each.verdict for each in here.results])
    assert {each.iri for verdicts in there for each in verdicts.stored} == {iri for iri, _ in told.values()}
