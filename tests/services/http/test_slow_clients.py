"""Clients that send a byte now and then keep neither their connection nor the service."""

import socket
import threading
import time
from collections.abc import Callable, Iterator

import pytest
import uvicorn
from starlette.requests import Request
from starlette.responses import PlainTextResponse

from services.http import gate, run
from services.http.gate import Gate
from services.http.settings import Address, Settings

HEAD = b"POST / HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 3\r\n"
PATIENCE = 0.4
Connect = Callable[[], socket.socket]


async def echo(scope, receive, send) -> None:
    body = await Request(scope, receive).body()
    await PlainTextResponse(body)(scope, receive, send)


@pytest.fixture
def connect(monkeypatch: pytest.MonkeyPatch) -> Iterator[Connect]:
    """Connects to a service that has little patience, as `sdt serve` runs it."""
    monkeypatch.setattr(run, "HEAD_SECONDS", PATIENCE)
    monkeypatch.setattr(gate, "BODY_SECONDS", PATIENCE)
    listening = run.bound(Address("127.0.0.1", 0))
    server = uvicorn.Server(run.configured(Gate(echo, Settings())))
    thread = threading.Thread(target=server.run, args=([listening],))
    thread.start()
    while not server.started:
        time.sleep(0.01)
    made: list[socket.socket] = []

    def connected() -> socket.socket:
        made.append(socket.create_connection(listening.getsockname(), timeout=20))
        return made[-1]

    yield connected
    for each in made:
        each.close()
    server.should_exit = True
    thread.join()


def answer(client: socket.socket) -> bytes:
    """What comes until the server closes, or the first answer is whole."""
    got = b""
    while not got.endswith(b"\r\n\r\nabc"):
        part = client.recv(4096)
        if not part:
            break
        got += part
    return got


@pytest.mark.parametrize("head", [b"", b"P", HEAD], ids=["nothing", "a byte", "a head without its end"])
def test_a_head_that_never_ends_is_given_up(connect: Connect, head: bytes) -> None:
    client = connect()
    client.sendall(head)
    assert answer(client) == b""


def test_bytes_now_and_then_buy_no_time(connect: Connect) -> None:
    client = connect()
    client.sendall(HEAD)
    with pytest.raises(OSError, match=r"Broken pipe|reset"):
        send_slowly(client)


def send_slowly(client: socket.socket) -> None:
    """A line of a head now and then, for 20 seconds."""
    until = time.monotonic() + 20
    while time.monotonic() < until:
        client.sendall(b"X-Slow: 1\r\n")
        time.sleep(PATIENCE / 8)


def test_a_body_that_never_ends_is_refused(connect: Connect) -> None:
    client = connect()
    client.sendall(HEAD + b"\r\nab")
    assert answer(client).startswith(b"HTTP/1.1 408 ")


def test_the_next_request_of_a_connection_has_its_own_time(connect: Connect) -> None:
    client = connect()
    for _ in range(3):
        client.sendall(HEAD[:10])
        time.sleep(PATIENCE / 2)
        client.sendall(HEAD[10:] + b"\r\nabc")
        assert answer(client).startswith(b"HTTP/1.1 200 OK")
    client.sendall(HEAD)
    assert answer(client) == b""


def test_others_are_served_meanwhile(connect: Connect) -> None:
    slow = [connect() for _ in range(20)]
    for each in slow:
        each.sendall(HEAD)
    client = connect()
    client.sendall(HEAD + b"\r\nabc")
    assert answer(client).startswith(b"HTTP/1.1 200 OK")
