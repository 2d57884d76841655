"""Several servers of one twin: each answers for its own jobs and numbers, and one stands in for another."""

import json
import queue
import time
from collections.abc import Iterator
from contextlib import ExitStack

import pytest
import zenoh

from services.bus import keys, serving
from services.bus.client import Connection
from services.bus.server import Server
from services.bus.sessions import open_session
from services.http.memory import Memory
from services.judging.problems import BusUnavailableError
from tests.ports import free_endpoint
from tests.services.bus.served import small
from tests.services.bus.test_history import move

DRAWERS = "ASK { ?d a sdt:Drawer }"
Two = tuple[tuple[Memory, Server], tuple[Memory, Server], Connection]


@pytest.fixture
def two(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[Two]:
    """Two servers behind a router, of one name where the test says so, and who asks."""
    if hasattr(request, "param"):
        monkeypatch.setattr(serving, "new_name", lambda: request.param)
    endpoint = free_endpoint()
    with ExitStack() as ended:
        ended.enter_context(open_session(listen=endpoint, mode="router"))
        sessions = [ended.enter_context(open_session(connect=endpoint, mode="client")) for _ in range(3)]
        first, second = (ended.enter_context(small(session)) for session in sessions[:2])
        to, names = Connection(sessions[2], "a", 30.0), {server.instance for _, server in (first, second)}
        until = time.monotonic() + 30
        while set(to.servers()) != names:
            assert time.monotonic() < until, "their tokens did not come"
        yield first, second, to


@pytest.mark.oracle
def test_a_job_is_answered_for_by_the_server_that_has_it(two: Two) -> None:
    (_, first), (_, second), to = two
    assert to.servers() == sorted((first.instance, second.instance))
    job = to.sweep("close").job
    owner = keys.server_of(job)
    assert owner in to.servers()
    for _ in range(10):
        assert to.progress(job).job == job
    assert to.cancel(job).state in {"cancelled", "done", "failed"}
    assert to.result(job)["job"] == job
    (first if first.instance == owner else second).close()
    with pytest.raises(BusUnavailableError, match="its jobs have ended with it"):
        to.progress(job)
    assert to.ask(DRAWERS), "the other one is there"


def test_each_server_has_its_own_numbers_and_says_so(two: Two) -> None:
    (one, first), (_, second), to = two
    heard: queue.Queue[zenoh.Sample] = queue.Queue()
    subscriber = to.session.declare_subscriber("sdt/v1/a/events/**", heard.put)
    assert to.history("state", instance=first.instance).last == 0
    move(one, "all=open")
    sample = heard.get(timeout=30)
    assert sample.attachment is not None
    told = json.loads(sample.attachment.to_bytes())
    assert told["instance"] == first.instance
    again = to.history("state", epoch=told["epoch"], instance=told["instance"])
    assert [each.quads for each in again.events] == [sample.payload.to_string()]
    other = to.history("state", after=1, epoch=told["epoch"], instance=second.instance)
    assert (other.last, other.restarted) == (0, True)
    subscriber.undeclare()


@pytest.mark.parametrize("two", ["same"], indirect=True)
def test_two_of_one_name_answer_as_one_and_when_one_ends_the_other_is_there(two: Two) -> None:
    (_, first), (_, second), to = two
    assert first.instance == second.instance == "same"
    assert to.servers() == ["same"]
    assert len(to.health()) == 2
    assert to.history("state", instance="same").last == 0
    first.close()
    assert to.ask(DRAWERS)
    assert to.servers() == ["same"]
    second.close()
    with pytest.raises(BusUnavailableError, match="no server of 'a'"):
        to.ask(DRAWERS)
