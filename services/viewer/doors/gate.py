"""viser's server, with doors that viser does not have: Host, Origin, a policy for the browser, no tunnel.

viser 1.1 gives no hook at the handshake, so its one call of `websockets` is seen through while the server
starts. If it is not seen there, the server does not start: nothing is served without the doors.
"""

import http
import io
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass, field
from typing import Any, Final, NoReturn
from urllib.parse import quote, unquote

import viser
import websockets.asyncio.server as transport
from viser import _messages as wire  # the protocol has no public name
from websockets.asyncio.server import ServerConnection
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from sdt_kg.errors import InputError, OracleUnavailableError
from services.http.settings import Address, host_name, host_names
from services.viewer.doors.dress import dressed

MOST_MESSAGE: Final = 4 * 2**20
"""[bytes] Of one message of a browser; viser sends files in parts of half a megabyte."""
CASE: Final = "/case"
"""Path of a link to a case; `/case?kitchen=b&robot=pr2&task=open:NAME`."""

Answering = Callable[[ServerConnection, Request], Response | None]
Given = Any  # what viser passes on to `websockets`

POLICY: Final = (
    "default-src 'self' 'unsafe-inline' data: blob:; "
    "script-src 'self' 'unsafe-inline' 'unsafe-eval' blob:; "
    "connect-src 'self' data: blob:; object-src 'none'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'"
)
"""Whatever the page's code would ask for elsewhere, the browser does not; viser's client evaluates code."""
HEADERS: Final = {
    "Content-Security-Policy": POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
}

_starting = threading.Lock()


class NoTunnelServer(viser.ViserServer):
    """A server that cannot be published through viser's share service."""

    def request_share_url(self, verbose: bool = True) -> NoReturn:
        """Refuse.

        Raises:
            InputError: Always.
        """
        del verbose
        raise InputError(
            "this page is not published through a tunnel",
            allowed="those who reach its address",
            remedy="put a proxy with passwords in front of it",
        )


@dataclass(slots=True)
class Gate:
    """What every request passes before viser sees it.

    Attributes:
        hosts: Names that a Host header may have, without port.
        origins: Origins of other sites that may connect.
        stood: Whether a server was started behind it.
    """

    hosts: frozenset[str]
    origins: frozenset[str] = frozenset()
    stood: bool = field(default=False, init=False)

    def behind(self, answer: Answering) -> Answering:
        """The way in which viser answers, behind the gate."""

        def process(connection: ServerConnection, request: Request) -> Response | None:
            refusal = self.refusal(request.headers)
            if refusal is not None:
                return _plain(*refusal)
            if request.path.startswith(f"{CASE}?") and "Upgrade" not in request.headers:
                return _to_case(request)
            response = answer(connection, request)
            if response is not None:
                dressed(response)
                for name, value in HEADERS.items():
                    response.headers[name] = value
            return response

        return process

    def refusal(self, headers: Headers) -> tuple[http.HTTPStatus, str] | None:
        """Why a request is not served; None if it is.

        Host defends against DNS rebinding, Origin against pages of other sites.
        """
        hosts, origins = headers.get_all("Host"), headers.get_all("Origin")
        if len(hosts) != 1 or host_name(hosts[0]) not in self.hosts:
            return http.HTTPStatus.MISDIRECTED_REQUEST, "this page has another name"
        own = {f"http://{hosts[0].lower()}", f"https://{hosts[0].lower()}"} | self.origins
        if any(origin.lower() not in own for origin in origins):
            return http.HTTPStatus.FORBIDDEN, "pages of other sites may not ask"
        if "websocket" in headers.get("Upgrade", "").lower() and not origins:
            return http.HTTPStatus.FORBIDDEN, "a browser says where it comes from"
        return None


def serve(address: Address, label: str, hosts: tuple[str, ...] = ()) -> viser.ViserServer:
    """A server at the address, behind its gate.

    Raises:
        InputError: The port is taken, or the address is not of this machine.
        OracleUnavailableError: This version of viser starts in another way; nothing is served.
    """
    gate = Gate(host_names(address, hosts))
    _check_free(address)
    with _starting, _seen_through(gate), redirect_stdout(io.StringIO()):  # it prints a table
        server = NoTunnelServer(host=address.bare_host, port=address.port, label=label, verbose=False)
    if not gate.stood:
        server.stop()
        raise OracleUnavailableError("viser did not start behind the gate; install viser 1.1")
    if address.port and server.get_port() != address.port:
        server.stop()
        raise _taken(address, "it was taken in the meantime")
    for request in (wire.ShareUrlRequest, wire.ShareUrlDisconnect):
        server._websock_server.unregister_handler(request)
    server.gui.configure_theme(show_share_button=False, show_logo=False)
    return server


@contextmanager
def _seen_through(gate: Gate) -> Iterator[None]:
    """While a server starts, its handshake goes through the gate."""
    serve_plainly = transport.serve

    def guarded(*given: Given, process_request: Answering, **options: Given) -> Given:
        gate.stood = True
        options["max_size"] = MOST_MESSAGE
        return serve_plainly(*given, process_request=gate.behind(process_request), **options)

    transport.serve = guarded  # pyright: ignore[reportAttributeAccessIssue]  # put back below
    try:
        yield
    finally:
        transport.serve = serve_plainly


def _check_free(address: Address) -> None:
    """Find out at once what viser would not say: it looks for another port, or waits for ever."""
    family = socket.AF_INET6 if ":" in address.bare_host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((address.bare_host, address.port))
        except OSError as error:
            raise _taken(address, error.strerror or str(error)) from None


def _taken(address: Address, why: str) -> InputError:
    where = f"{address.host}:{address.port}"
    return InputError(
        f"the 3D page cannot listen on {where}: {why}",
        allowed="a free port of this machine",
        remedy="sdt view --http HOST:PORT, sdt serve --view HOST:PORT",
    )


def _to_case(request: Request) -> Response:
    """The page, told by its own link which case it shows: viser's client keeps nothing else of a link."""
    _, _, query = request.path.partition("?")
    parts = ";".join(quote(unquote(part.replace("+", " ")), safe="=:,.") for part in query.split("&"))
    target = f"/?websocket=ws://{request.headers['Host']}{CASE}/{parts}"
    return Response(http.HTTPStatus.FOUND, "Found", Headers(Location=target, **HEADERS), b"")


def _plain(status: http.HTTPStatus, text: str) -> Response:
    body = f"{text}\n".encode()
    headers = Headers(
        {"Content-Type": "text/plain; charset=utf-8", "Content-Length": str(len(body)), **HEADERS}
    )
    return Response(status, status.phrase, headers, body)
