"""Ports on loopback for servers of tests: where nobody listens, and no client of another is given one."""

import socket
from random import SystemRandom

LISTENED = range(20_000, 32_000)
"""Below those that Linux and macOS give to clients: one of these that is free may be taken a moment later."""


def free_port() -> int:
    """A port where nobody listens."""
    while True:
        port = SystemRandom().choice(LISTENED)
        with socket.socket() as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
        return port


def free_endpoint() -> str:
    """The same, as an endpoint of Zenoh."""
    return f"tcp/127.0.0.1:{free_port()}"
