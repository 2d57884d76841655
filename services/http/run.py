"""The service on a socket, until it is interrupted."""

import asyncio
import socket
from collections.abc import Callable
from contextlib import AsyncExitStack

import uvicorn
from fastapi import FastAPI
from starlette.types import ASGIApp
from uvicorn.protocols.http.h11_impl import H11Protocol

from sdt_kg.errors import InputError
from services.http.app import Beside, create_app
from services.http.settings import Address, Settings
from services.http.world import World

CONCURRENT = 512
"""Connections; more are answered 503."""
KEEP_ALIVE = 30
"""[s] An idle connection is kept."""
HEAD_SECONDS = 15
"""[s] From a connection's, or a request's, first byte to the end of its head."""
SHUTDOWN = 5
"""[s] Requests may take to finish when the service ends."""


class Patient(H11Protocol):
    """HTTP/1.1 with patience for a while: a head that never ends does not keep its connection.

    uvicorn counts the idle time between requests only, so that a few hundred clients that send a byte
    now and then would be all that it can serve.
    """

    _impatience: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # pyright: ignore[reportIncompatibleMethodOverride]  # as theirs
        """A client is there, and has to say what it wants."""
        super().connection_made(transport)
        self._await_head()

    def data_received(self, data: bytes) -> None:
        """More of a request: the time runs until its head is whole."""
        before = self.cycle
        super().data_received(data)
        if self.cycle is not before:
            self._head_is_whole()
        elif self._impatience is None and (before is None or before.response_complete):
            self._await_head()

    def connection_lost(self, exc: Exception | None) -> None:
        """The client is gone."""
        self._head_is_whole()
        super().connection_lost(exc)

    def _await_head(self) -> None:
        self._impatience = self.loop.call_later(HEAD_SECONDS, self.transport.close)

    def _head_is_whole(self) -> None:
        if self._impatience is not None:
            self._impatience.cancel()
            self._impatience = None


def bound(address: Address) -> socket.socket:
    """A listening socket.

    Raises:
        InputError: The address is not ours or is in use.
    """
    family = socket.AF_INET6 if ":" in address.bare_host else socket.AF_INET
    # With its protocol spelled out: else the event loop does not know that it may turn off Nagle's delay.
    listening = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((address.bare_host, address.port))
        listening.listen(CONCURRENT)
    except OSError as error:
        listening.close()
        raise InputError(
            f"cannot listen on {address.host}:{address.port}: {error.strerror or error}",
            allowed="a free port of this machine",
            remedy="--http HOST:PORT",
        ) from None
    return listening


class Serving(uvicorn.Server):
    """The application lives as long as its server: what it cannot begin with is raised, and nobody listens.

    uvicorn would log such an error, and end the process.
    """

    def __init__(self, app: FastAPI, ready: Callable[[], None]) -> None:
        super().__init__(configured(app))
        self._app, self._ready, self._life = app, ready, AsyncExitStack()

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Everything is there that requests need, and whoever waits for it is told."""
        await self._life.enter_async_context(self._app.router.lifespan_context(self._app))
        await super().startup(sockets)
        self._ready()

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Requests are finished; then nothing is left."""
        await super().shutdown(sockets)
        await self._life.aclose()


def run(
    world: World,
    settings: Settings,
    listening: socket.socket,
    beside: Beside | None,
    ready: Callable[[], None],
) -> None:
    """Serve until interrupted; what was kept is read before, and raises as `World.remember`.

    Args:
        world: What is served.
        settings: How it is served.
        listening: Where.
        beside: What is served beside it; raises what it raises at its beginning.
        ready: Called when requests are answered.
    """
    world.remember()
    Serving(create_app(world, settings, beside), ready).run([listening])


def configured(app: ASGIApp) -> uvicorn.Config:
    """How an application is served: what it says of itself, how many it serves, how long it waits."""
    return uvicorn.Config(
        app,
        lifespan="off",
        http=Patient,
        log_level="warning",
        access_log=False,
        server_header=False,
        proxy_headers=False,
        limit_concurrency=CONCURRENT,
        timeout_keep_alive=KEEP_ALIVE,
        timeout_graceful_shutdown=SHUTDOWN,
    )
