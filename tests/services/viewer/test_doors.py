"""Who is let in: Host and Origin at the handshake, no tunnel, files of a bounded size."""

import gzip
import http.client
from collections.abc import Iterator

import pytest
import viser
from viser import _messages as wire
from viser.infra import _infra as infra
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect
from websockets.typing import Origin, Subprotocol

from sdt_kg.errors import InputError
from services.http.settings import Address
from services.viewer.doors import gate, uploads
from services.viewer.running import Offer, running

LOOPBACK = Address("127.0.0.1", 0)
SPOKEN = Subprotocol(f"viser-v{viser.__version__}")


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    one = gate.serve(LOOPBACK, "test", ("kitchen.example",))
    yield one
    one.stop()


def asked(server: viser.ViserServer, path: str = "/", **headers: str) -> http.client.HTTPResponse:
    connection = http.client.HTTPConnection("127.0.0.1", server.get_port(), timeout=20)
    connection.request("GET", path, headers=headers)
    response = connection.getresponse()
    response.read()
    connection.close()
    return response


def connected(server: viser.ViserServer, origin: str | None) -> None:
    """A browser at a page of that origin connects; raises InvalidStatus if it is refused."""
    said = None if origin is None else Origin(origin)
    with connect(f"ws://127.0.0.1:{server.get_port()}/", origin=said, subprotocols=[SPOKEN], open_timeout=20):
        pass


def test_the_pages_own_origin_connects(server: viser.ViserServer) -> None:
    connected(server, f"http://127.0.0.1:{server.get_port()}")


@pytest.mark.parametrize(
    "origin",
    ["http://evil.example", "null", "http://127.0.0.1:1", "http://localhost.evil.example", None],
)
def test_a_foreign_origin_is_refused_at_the_handshake(server: viser.ViserServer, origin: str | None) -> None:
    with pytest.raises(InvalidStatus) as refused:
        connected(server, origin)
    assert refused.value.response.status_code == 403
    assert not server.get_clients()


def test_another_host_is_refused_against_dns_rebinding(server: viser.ViserServer) -> None:
    port = server.get_port()
    assert asked(server, Host=f"evil.example:{port}").status == 421
    assert asked(server, Host=f"kitchen.example:{port}").status == 200
    assert asked(server, Origin="http://evil.example").status == 403


def test_the_browser_is_told_to_ask_nobody_else(server: viser.ViserServer) -> None:
    policy = asked(server).headers["Content-Security-Policy"]
    assert "connect-src 'self' data: blob:" in policy
    assert "default-src 'self'" in policy
    assert "http" not in policy


def test_the_page_has_our_title_and_colours_packed_or_not(server: viser.ViserServer) -> None:
    for packing in ("identity", "gzip"):
        connection = http.client.HTTPConnection("127.0.0.1", server.get_port(), timeout=20)
        connection.request("GET", "/", headers={"Accept-Encoding": packing})
        body = connection.getresponse().read()
        connection.close()
        page = gzip.decompress(body) if packing == "gzip" else body
        assert b"<title>sdt: kitchens, robots and verdicts in 3D</title><style>" in page
        assert b"<title>Viser</title>" not in page
        assert page.index(b"'data:image/jpeg'") < page.index(b"<script data-p="), "before viser's own code"


def test_a_link_to_a_case_becomes_the_path_of_the_connection(server: viser.ViserServer) -> None:
    answer = asked(server, "/case?kitchen=b&robot=pr2&task=open%3Adoor&base=0%2C1%2C0.5")
    target = f"ws://127.0.0.1:{server.get_port()}/case/kitchen=b;robot=pr2;task=open:door;base=0,1,0.5"
    assert (answer.status, answer.headers["Location"]) == (302, f"/?websocket={target}")
    split = asked(server, "/case?kitchen=b%0D%0ASet-Cookie:x=1").headers
    assert "Set-Cookie" not in split


def test_the_tunnel_of_visers_share_service_cannot_be_opened(server: viser.ViserServer) -> None:
    with pytest.raises(InputError, match="not published through a tunnel"):
        server.request_share_url()
    handlers = server._websock_server._incoming_handlers
    assert wire.ShareUrlRequest not in handlers  # nor at a browser's request
    assert server._share_tunnel is None


def test_a_port_that_is_taken_is_said_and_no_other_is_taken(server: viser.ViserServer) -> None:
    with pytest.raises(InputError, match=r"page cannot listen on 127\.0\.0\.1.* sdt serve --view"):
        gate.serve(Address("127.0.0.1", server.get_port()), "test")
    with pytest.raises(InputError, match=r"cannot listen on 192\.0\.2\.1"):
        gate.serve(Address("192.0.2.1", 0), "test")


def test_beyond_loopback_is_not_listened_without_being_told() -> None:
    said = "knows no passwords.*; sdt view --unprotected listens there without"
    with pytest.raises(InputError, match=said), running("0.0.0.0:0", Offer(("b",), ("pr2",))):
        pytest.fail("it must not listen")


def test_files_are_bounded_whatever_the_browser_says(server: viser.ViserServer) -> None:
    refusals: list[str] = []
    inner = server._websock_server
    state = infra._ClientHandleState(inner._broadcast_buffer, server._event_loop)
    connection = infra.WebsockClientConnection(infra.ClientId(7), state)
    client = viser.ClientHandle(connection, server)
    button = client.gui.add_upload_button("file")
    uploads.bounded(client, lambda transfer, why: refusals.append(f"{transfer}: {why}"))
    (start,) = connection._incoming_handlers[wire.FileTransferStartUpload]
    (part,) = connection._incoming_handlers[wire.FileTransferPart]

    def begin(transfer: str, size: int, parts: int) -> None:
        start(7, wire.FileTransferStartUpload(button._impl.uuid, transfer, "m.npz", "", parts, size))

    def send(transfer: str, index: int, content: bytes) -> None:
        part(7, wire.FileTransferPart(button._impl.uuid, transfer, index, content))

    begin("whole", 4, 2)
    send("whole", 0, b"ab")
    send("whole", 1, b"cd")
    assert button.value.content == b"abcd"
    begin("large", 300 * 2**20, 600)
    send("large", 0, b"x")
    begin("liar", 2, 2)
    send("liar", 0, b"abc")
    send("liar", 1, b"d")
    assert refusals == [
        "large: 'm.npz' has 300 MB; allowed: 32 MB",
        "liar: the file is longer than it was said to be",
    ]
    assert not client.gui._current_file_upload_states
    assert button.value.content == b"abcd"
