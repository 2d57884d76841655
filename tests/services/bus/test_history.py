"""What has happened is told again after a sequence number: in order, with its triples, gaps said."""

import asyncio
import queue
import shutil
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import zenoh

from sdt_kg.iri import graph_iri
from services.bus import history
from services.bus.client import Connection
from services.bus.history import Log
from services.bus.sessions import open_session
from services.http.memory import Memory
from services.judging.messages import HistoryRequest
from services.store.files import opened
from tests.ports import free_endpoint
from tests.services.bus.served import small
from tests.small import FOLDER


@pytest.fixture
def served() -> Iterator[tuple[Memory, Connection]]:
    """The small kitchen A on a bus."""
    endpoint = free_endpoint()
    with (
        open_session(listen=endpoint) as session,
        small(session) as (memory, _),
        open_session(connect=endpoint, mode="client") as client,
    ):
        yield memory, Connection(client, "a", 30.0)


def move(memory: Memory, *state: str) -> None:
    asyncio.run_coroutine_threadsafe(memory.world.move(None, state), memory.loop).result()


def test_a_change_of_state_is_published_and_told_again(served: tuple[Memory, Connection]) -> None:
    memory, to = served
    heard: queue.Queue[zenoh.Sample] = queue.Queue()
    subscriber = to.session.declare_subscriber("sdt/v1/a/events/**", heard.put)
    assert to.history("state").last == 0
    move(memory, "all=open")
    move(memory, "all=closed")
    first, second = heard.get(timeout=30), heard.get(timeout=30)
    assert str(first.key_expr) == "sdt/v1/a/events/state/000000000001"
    told = to.history("state", after=1)
    assert [each.sequence for each in told.events] == [2]
    assert told.events[0].quads == second.payload.to_string()
    assert told.gap is None
    assert not told.restarted
    assert [each.sequence for each in to.history("state", limit=1).events] == [1]
    assert to.history("state", limit=1).more
    subscriber.undeclare()


@pytest.mark.oracle
def test_a_question_is_about_the_present_state(served: tuple[Memory, Connection]) -> None:
    memory, to = served
    assert {met.verb for met in to.satisfies()} == {"close"}
    move(memory, "all=open")
    assert {met.verb for met in to.satisfies()} == {"open"}
    assert {met.verb for met in to.satisfies("all=closed")} == {"close"}


@pytest.mark.oracle
def test_a_sweep_is_about_the_state_that_was_present_when_it_began() -> None:
    endpoint = free_endpoint()
    with (
        open_session(listen=endpoint) as session,
        small(session, robots=(str(FOLDER / "pr2.urdf"),)) as (memory, _),
        open_session(connect=endpoint, mode="client") as client,
    ):
        to = Connection(client, "a", 60.0)
        move(memory, "all=open")
        job = to.sweep(tasks=["open:low_drawer"]).job
        until = time.monotonic() + 60
        while to.progress(job).state in {"queued", "running"}:
            assert time.monotonic() < until
            time.sleep(0.1)
        (swept,) = to.result(job)["verdicts"]
        (asked,) = to.achieve("open:low_drawer").objects
        assert swept["iri"] == asked["iri"]
        assert "already meets open" in str(swept["diagnoses"])


def test_numbers_go_on_where_a_server_with_a_store_has_ended(tmp_path: Path) -> None:
    store = opened(tmp_path / "store")
    before = Log("a", "verdict", store)
    graphs = [graph_iri("verdict", str(number)) for number in range(12)]
    assert [before.append(graph) for graph in graphs] == list(range(1, 13))
    store.close()
    store = opened(tmp_path / "store")
    after = Log("a", "verdict", store)
    assert after.epoch == before.epoch
    assert after.append(graphs[0]) == 13
    reply, told = after.after(HistoryRequest(after=10, epoch=before.epoch))
    assert told == [(11, graphs[10]), (12, graphs[11]), (13, graphs[0])]
    assert not reply.restarted
    store.close()


def test_a_kitchen_of_any_name_is_asked_and_its_events_are_kept(tmp_path: Path) -> None:
    kitchen, endpoint = tmp_path / "Küche 2 $*#?.urdf", free_endpoint()
    shutil.copy(FOLDER / "b.urdf", kitchen)
    with open_session(listen=endpoint) as session, open_session(connect=endpoint, mode="client") as client:
        for number, where in enumerate(("all=open", "all=closed"), 1):
            store = opened(tmp_path / "store")
            with small(session, kitchen=kitchen, archive=store) as (memory, _):
                to = Connection(client, kitchen.stem, 30.0)
                assert len(to.select("SELECT ?c { ?c a sdt:Container }")[1]) == 2
                move(memory, where)
                assert to.history("state").last == number
            store.close()


def test_what_is_not_kept_any_more_is_a_gap(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(history, "KEPT", 3)
    log = Log("a", "verdict", None)
    for number in range(5):
        log.append(graph_iri("verdict", str(number)))
    reply, told = log.after(HistoryRequest(after=1))
    assert [number for number, _ in told] == [3, 4, 5]
    assert reply.gap == (2, 2)


def test_numbers_of_another_server_are_told_to_be_that() -> None:
    old, new = (Log("a", "verdict", None) for _ in range(2))
    new.append(graph_iri("verdict", "x"))
    assert new.after(HistoryRequest(after=1, epoch=old.epoch))[0].restarted
    assert new.after(HistoryRequest(after=7))[0].restarted
    assert not new.after(HistoryRequest(after=1, epoch=new.epoch))[0].restarted
