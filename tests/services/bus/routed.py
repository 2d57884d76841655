"""Processes of a routed bus: a router, and oracles that connect to it."""

import multiprocessing as mp
import time
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing.process import BaseProcess

import zenoh

from sdt_kg.errors import OracleUnavailableError
from services.bus.keys import Oracle
from services.bus.oracles.server import oracle
from services.bus.sessions import open_session

BARE = "bare"
"""Key of a question that takes as long as Zenoh does."""
FOREVER = 3600.0
"""[s] Until it is killed."""
START = 120.0
"""[s] A process may take to be there, on a busy machine."""


def route(endpoint: str) -> None:
    """Main of the router's process, which answers bare questions itself."""

    def answered(query: zenoh.Query) -> None:
        with query:
            query.reply(query.key_expr, b"")

    with open_session(listen=endpoint, mode="router") as session:
        session.declare_queryable(BARE, answered)
        time.sleep(FOREVER)


def serve_oracle(endpoint: str, kind: str) -> None:
    """Main of an oracle's process."""
    with open_session(connect=endpoint, mode="client") as session, oracle(session, Oracle(kind)):
        time.sleep(FOREVER)


@contextmanager
def routed(endpoint: str, kinds: tuple[str, ...]) -> Iterator[list[BaseProcess]]:
    """A router and oracles of these kinds, each a process of its own; the oracles are given."""
    context = mp.get_context("spawn")
    router = context.Process(target=route, args=(endpoint,))
    router.start()
    wait_for(endpoint)
    oracles: list[BaseProcess] = [
        context.Process(target=serve_oracle, args=(endpoint, kind)) for kind in kinds
    ]
    for each in oracles:
        each.start()
    try:
        yield oracles
    finally:
        for each in (*oracles, router):
            each.kill()
            each.join()


def wait_for(endpoint: str) -> None:
    """Somebody listens at the endpoint."""
    until = time.monotonic() + START
    while True:
        try:
            open_session(connect=endpoint, mode="client").close()
        except OracleUnavailableError:
            if time.monotonic() > until:
                raise
        else:
            return
