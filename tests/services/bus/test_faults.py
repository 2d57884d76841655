"""Two hundred mixed requests while everything dies now and then; `make soak` asks ten thousand."""

from collections.abc import Iterator

import pytest

from services.bus.client import Connection
from services.bus.sessions import open_session
from tests.ports import free_endpoint
from tests.services.bus.mixed import DRAWER, is_typed, run, scattered
from tests.services.bus.stage import Stage, staged

pytestmark = pytest.mark.oracle

TASK = f"open:{DRAWER}"
REQUESTS = 200


@pytest.fixture
def stage() -> Iterator[Stage]:
    with staged(free_endpoint(), ("causes", "canperform")) as one:
        yield one


def test_every_request_ends_in_a_right_answer_or_a_typed_error(stage: Stage) -> None:
    with open_session(connect=stage.endpoint, mode="client") as session:
        (said,) = Connection(session, "b").achieve(TASK, "pr2").objects
    assert said["outcome"] == "certified"
    harms = {stage.kill_worker: 2, stage.kill_oracle: 2, stage.restart_router: 1}
    cases = {(TASK, 0): (said["iri"], said["outcome"])}
    found = run(stage.endpoint, REQUESTS, scattered(REQUESTS, harms), cases, 0, stage.is_excused)
    assert sum(found.counts.values()) == REQUESTS
    assert not found.wrong
    assert all(is_typed(end) for _, end in found.counts)
    assert found.counts["select", "answer"] > 20
    assert found.counts["achieve", "answer"]
    with open_session(connect=stage.endpoint, mode="client") as session:
        there = Connection(session, "b")
        assert there.satisfies(), "the service lives on"
        _, rows = there.select("SELECT ?v WHERE { ?v a law:Verdict }")
    assert found.verdicts <= {row["v"] for row in rows}, "nothing that was acknowledged is lost"
