"""A server or an oracle that is there and does nothing any more: its token is stale, and others answer.

Zenoh notices a partner that says nothing when its lease ends: ten seconds, unless a configuration differs.
Until then a question may have gone to whoever is frozen.
"""

import contextlib
import multiprocessing as mp
import os
import signal
import time
from collections.abc import Iterator
from contextlib import ExitStack
from multiprocessing.process import BaseProcess

import pytest

from services.app import load
from services.bus.client import Connection
from services.bus.oracles.remote import BusOracles
from services.bus.sessions import open_session
from services.judging.problems import BusUnavailableError, DeadlineError
from tests.ports import free_endpoint
from tests.services.bus.routed import FOREVER, START, routed
from tests.services.bus.served import small

LEASE = 10.0
"""[s] Of Zenoh's transports."""
SLACK = 5.0
"""[s] Beyond it, on a busy machine."""
DRAWERS = "ASK { ?d a sdt:Drawer }"


def serve(endpoint: str) -> None:
    """Main of a server's process."""
    with open_session(connect=endpoint, mode="client") as session, small(session):
        time.sleep(FOREVER)


@pytest.fixture
def two() -> Iterator[tuple[Connection, list[BaseProcess]]]:
    """Two servers that are to be behind a router, each a process, and who asks."""
    endpoint, context = free_endpoint(), mp.get_context("spawn")
    processes: list[BaseProcess] = [context.Process(target=serve, args=(endpoint,)) for _ in range(2)]
    with ExitStack() as ended:
        ended.enter_context(open_session(listen=endpoint, mode="router"))
        to = Connection(ended.enter_context(open_session(connect=endpoint, mode="client")), "a", 30.0)
        for each in processes:
            each.start()
            ended.callback(each.join)
            ended.callback(each.kill)
        yield to, processes


def wait(to: Connection, count: int) -> None:
    """So many servers are there."""
    until = time.monotonic() + START
    while len(to.servers()) != count:
        assert time.monotonic() < until
        time.sleep(0.2)


def freeze(process: BaseProcess) -> None:
    """It stays where it is, and so do its connections."""
    assert process.pid is not None
    os.kill(process.pid, signal.SIGSTOP)


def thaw(process: BaseProcess) -> None:
    """It goes on."""
    assert process.pid is not None
    os.kill(process.pid, signal.SIGCONT)


def test_what_went_to_a_frozen_server_is_answered_by_another_when_its_lease_ends(
    two: tuple[Connection, list[BaseProcess]],
) -> None:
    to, processes = two
    wait(to, 2)
    assert to.ask(DRAWERS)
    freeze(processes[0])
    for _ in range(3):
        began = time.monotonic()
        assert to.ask(DRAWERS)
        assert time.monotonic() - began < LEASE + SLACK
    wait(to, 1)


def test_a_server_that_begins_while_the_token_of_a_frozen_one_is_there_answers(
    two: tuple[Connection, list[BaseProcess]],
) -> None:
    to, (first, second) = two
    freeze(second)  # before it has begun to listen
    wait(to, 1)
    freeze(first)
    assert len(to.servers()) == 1, "its token is stale"
    with pytest.raises(DeadlineError):
        Connection(to.session, to.twin, 0.5).ask(DRAWERS)
    thaw(second)
    until = time.monotonic() + START
    answered = False
    while not answered:
        assert time.monotonic() < until
        with contextlib.suppress(BusUnavailableError, DeadlineError):
            answered = to.ask(DRAWERS)
    wait(to, 1)


@pytest.mark.oracle
def test_work_that_went_to_a_frozen_oracle_is_done_by_another() -> None:
    here = load("b", ["pr2"])
    (caused,) = here.causes("open:sink_area_left_middle_drawer_main")
    endpoint = free_endpoint()
    with (
        routed(endpoint, ("causes", "causes")) as processes,
        open_session(connect=endpoint, mode="client") as session,
    ):
        physics = BusOracles.on(session).physics()
        until = time.monotonic() + START
        while len(physics.pinned.callers.instances()) < 2:
            assert time.monotonic() < until
            time.sleep(0.2)
        for _ in range(2):  # both hold the twin
            physics.replay(here.twin, caused.case.motion)
        freeze(processes[0])
        for _ in range(4):
            began = time.monotonic()
            found = physics.replay(here.twin, caused.case.motion)
            assert found.final == here.physics.replay(here.twin, caused.case.motion).final
            assert time.monotonic() - began < LEASE + SLACK
        assert len(physics.pinned.callers.instances()) == 1
