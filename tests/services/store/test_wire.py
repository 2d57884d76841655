"""What goes over the wire to a server: connections that are kept, passwords, codings."""

import socket
import threading
from collections.abc import Callable, Iterator

import pytest

from sdt_kg.errors import StoreRejectedError
from services.store.server.wire import Wire, shown

JSON = "application/sparql-results+json"
TRUE = b'{"head":{},"boolean":true}'
QUERY, ASKED = "ASK {}", b"query=ASK+%7B%7D"
"""Asked, and how it is sent."""

Serve = Callable[[bytes], tuple[str, list[bytes]]]


def _whole(connection: socket.socket) -> bytes:
    """A request with its body: what is left unread when a connection is closed takes the answer with it."""
    read = b""
    while not read.endswith(ASKED):
        read += connection.recv(65_536)
    return read


@pytest.fixture
def serve() -> Iterator[Serve]:
    """A server that gives each connection one answer and then closes it; what it was sent."""
    with socket.create_server(("127.0.0.1", 0)) as listening:
        heads: list[bytes] = []
        thread: list[threading.Thread] = []

        def answers(answer: bytes) -> None:
            while True:
                try:
                    connection, _ = listening.accept()
                except OSError:
                    return
                with connection:
                    heads.append(_whole(connection))
                    connection.sendall(answer)

        def begin(headers: bytes) -> tuple[str, list[bytes]]:
            length = str(len(TRUE)).encode()
            answer = b"HTTP/1.1 200 OK\r\nContent-Type: " + JSON.encode() + b"\r\n" + headers
            answer += b"Content-Length: " + length + b"\r\n\r\n" + TRUE
            thread.append(threading.Thread(target=answers, args=(answer,)))
            thread[0].start()
            return f"127.0.0.1:{listening.getsockname()[1]}", heads

        yield begin
        listening.shutdown(socket.SHUT_RDWR)
    for each in thread:
        each.join()


def asked(wire: Wire, address: str) -> bytes:
    return wire.query(address, {"query": QUERY}, JSON)


def test_a_connection_that_the_server_has_closed_is_made_anew_at_once(serve: Serve) -> None:
    place, heads = serve(b"Connection: keep-alive\r\n")
    wire = Wire(waits=(0.0,))
    for count in (1, 2, 3):
        assert asked(wire, f"http://{place}/query") == TRUE
        assert len(heads) == count
    wire.close()


def test_user_and_password_are_sent_as_http_basic(serve: Serve) -> None:
    place, heads = serve(b"")
    wire = Wire(waits=())
    asked(wire, f"http://anna:s%40cret@{place}/query?a=b")
    wire.close()
    assert b"authorization: basic yw5uytpzqgnyzxq=" in heads[0].lower()
    assert heads[0].startswith(b"POST /query?a=b HTTP/1.1\r\n")


def test_no_proxy_is_asked(serve: Serve, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("http_proxy", "http://127.0.0.1:9")
    place, _ = serve(b"")
    wire = Wire(waits=())
    assert asked(wire, f"http://{place}/query") == TRUE
    wire.close()


def test_an_answer_in_a_coding_that_it_does_not_have_is_refused(serve: Serve) -> None:
    place, _ = serve(b"Content-Encoding: gzip\r\n")
    wire = Wire(waits=())
    with pytest.raises(StoreRejectedError, match=r"cannot be asked: .*gzip"):
        asked(wire, f"http://{place}/query")
    wire.close()


@pytest.mark.parametrize("address", ["http://127.0.0.1:99999/q", "http://127.0.0.1:x/q"])
def test_an_address_that_is_none_is_refused_and_not_asked_again(address: str) -> None:
    with pytest.raises(StoreRejectedError, match="cannot be asked"):
        asked(Wire(), address)


def test_an_address_is_shown_without_what_may_be_secret() -> None:
    assert shown("https://anna:secret@h:8/q?token=1#x") == "https://h:8/q"
    assert shown("http://h/q") == "http://h/q"
