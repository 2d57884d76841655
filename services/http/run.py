"""The service on a socket, until it is interrupted."""

import socket

import uvicorn

from sdt_kg.errors import InputError
from services.http.app import Beside, create_app
from services.http.settings import Address, Settings
from services.http.world import World

CONCURRENT = 512
"""Connections; more are answered 503."""
KEEP_ALIVE = 30
"""[s] An idle connection is kept."""
SHUTDOWN = 5
"""[s] Requests may take to finish when the service ends."""


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


def run(world: World, settings: Settings, listening: socket.socket, beside: Beside | None = None) -> None:
    """Serve until interrupted."""
    config = uvicorn.Config(
        create_app(world, settings, beside),
        log_level="warning",
        access_log=False,
        server_header=False,
        proxy_headers=False,
        limit_concurrency=CONCURRENT,
        timeout_keep_alive=KEEP_ALIVE,
        timeout_graceful_shutdown=SHUTDOWN,
    )
    uvicorn.Server(config).run([listening])
