"""What every request passes before anything reads it: Host, Origin, size, time, token; and CORS.

The Host header defends against DNS rebinding: a page of another site whose name was made to point here
sends that name. The Origin header defends against pages of other sites which ask from this machine's
browser. Both hold on loopback too, where there may be no token.
"""

import asyncio
import hmac
from collections.abc import Callable
from urllib.parse import urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import Request
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from services.http.problems import RefusedError, of_error, unexpected
from services.http.settings import Settings, host_name

READING = frozenset({"GET", "HEAD", "OPTIONS"})
GUARDED = "/api/"
"""Below it every other method writes or computes, and needs the token if there is one."""
BODY_SECONDS = 60.0
"""[s] From the end of a request's head to the end of its body."""
SECURITY_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "same-origin",  # a form of a page without any would have no Origin
    "Cross-Origin-Resource-Policy": "same-origin",
    "Content-Security-Policy": "default-src 'none'; style-src 'self'; img-src 'self'; form-action 'self'; "
    "frame-ancestors 'none'; base-uri 'none'",
}


class Gate:
    """The middleware.

    Args:
        app: What it guards.
        settings: Names, origins, sizes and the token.
        told: Makes a page of a problem, for those who may read pages.
    """

    def __init__(
        self,
        app: ASGIApp,
        settings: Settings,
        told: Callable[[Request, Response], Response] = lambda _, problem: problem,
    ) -> None:
        self._app, self._settings, self._told = app, settings, told

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        answer = _Answer(self._finished(send, headers))
        try:
            self._check(scope, headers)
        except RefusedError as error:  # no page: it would tell who is refused here what is served
            await of_error(error)(scope, receive, answer)
            return
        try:
            if scope["method"] == "OPTIONS" and "access-control-request-method" in headers:
                await _preflight(answer)
                return
            body = _Body(receive, self._most(scope["path"]), headers, answer)
            await self._app(scope, body, answer)
            refusal = body.refusal
        except RefusedError as error:
            refusal = error
        except Exception as error:  # the edge of a service: logged, and answered as a failure
            if answer.started:
                raise
            await unexpected(scope["method"], scope["path"], error)(scope, receive, answer)
            return
        if refusal is not None:
            await self._told(Request(scope), of_error(refusal))(scope, receive, answer.anew)

    def _check(self, scope: Scope, headers: Headers) -> None:
        settings = self._settings
        hosts = headers.getlist("host")
        if len(hosts) != 1 or not hosts[0]:
            raise RefusedError(400, "there is no Host header, or there are several", allowed="one")
        if host_name(hosts[0]) not in settings.hosts:
            raise RefusedError(
                421,
                f"this service is not '{hosts[0][:100]}'",
                allowed=", ".join(sorted(settings.hosts)),
                remedy="sdt serve --allow-host NAME",
            )
        origin = headers.get("origin")
        if origin is not None and origin not in settings.origins and not _same(origin, hosts[0], scope):
            raise RefusedError(
                403, f"pages of '{origin[:100]}' may not ask", remedy="sdt serve --allow-origin ORIGIN"
            )
        coding = headers.get("content-encoding", "identity")
        if coding.lower() != "identity":
            raise RefusedError(
                415,
                f"a body in the coding '{coding[:100]}' is not unpacked",
                allowed="a body as it is",
                headers={"Accept-Encoding": "identity"},
            )
        if scope["path"].startswith(GUARDED) and scope["method"] not in READING:
            self._check_token(headers)

    def _check_token(self, headers: Headers) -> None:
        token = self._settings.token
        if token is None:
            return
        scheme, _, given = headers.get("authorization", "").partition(" ")
        right = hmac.compare_digest(given.strip().encode(), token.encode())
        if scheme.lower() != "bearer" or not right:
            raise RefusedError(
                401,
                "this needs the token",
                allowed="Authorization: Bearer TOKEN",
                headers={"WWW-Authenticate": 'Bearer realm="sdt"'},
            )

    def _most(self, path: str) -> int:
        return self._settings.upload if path.startswith(GUARDED) else self._settings.body

    def _finished(self, send: Send, headers: Headers) -> Send:
        """Security headers on every answer; for origins that are named those of CORS; how long it holds."""
        origin = headers.get("origin")

        async def finished(message: Message) -> None:
            if message["type"] == "http.response.start":
                out = MutableHeaders(scope=message)
                for name, value in SECURITY_HEADERS.items():
                    out.setdefault(name, value)
                out.setdefault("Cache-Control", "no-cache")  # a cache may not guess for how long it holds
                if origin is not None and origin in self._settings.origins:
                    out["Access-Control-Allow-Origin"] = origin
                    out["Cross-Origin-Resource-Policy"] = "cross-origin"
                    out.add_vary_header("Origin")
            await send(message)

        return finished


class _Answer:
    """The answer on its way; one that is withheld never leaves."""

    def __init__(self, send: Send) -> None:
        self._send = send
        self.started, self.withheld = False, False

    async def __call__(self, message: Message) -> None:
        if not self.withheld:
            await self.anew(message)

    async def anew(self, message: Message) -> None:
        """Answer instead of what was withheld."""
        self.started = True
        await self._send(message)


class _Body:
    """The body on its way in, refused as soon as it is too long or slow, whatever the reader makes of that.

    Attributes:
        refusal: Why, once it was.
    """

    def __init__(self, receive: Receive, most: int, headers: Headers, answer: _Answer) -> None:
        self._receive, self._most, self._answer, self._length = receive, most, answer, 0
        self.refusal: RefusedError | None = None
        self._until: float | None = asyncio.get_running_loop().time() + BODY_SECONDS
        declared = headers.get("content-length", "0")
        if not declared.isdecimal() or int(declared) > most:
            raise self._too_long()

    async def __call__(self) -> Message:
        try:
            async with asyncio.timeout_at(self._until):
                message = await self._receive()
        except TimeoutError:
            problem = f"the request's body took longer than {BODY_SECONDS:g} s"
            self._refuse(RefusedError(408, problem, headers={"Connection": "close"}))
            return {"type": "http.disconnect"}
        self._length += len(message.get("body", b""))
        if not message.get("more_body"):
            self._until = None  # what may still come is that the client leaves
        if self._length > self._most:
            self._refuse(self._too_long())
        return message

    def _refuse(self, refusal: RefusedError) -> None:
        if not self._answer.started:
            self._answer.withheld = True
            self.refusal = refusal
            raise refusal

    def _too_long(self) -> RefusedError:
        return RefusedError(
            413, f"the request is longer than {self._most} bytes", allowed=f"{self._most} bytes"
        )


async def _preflight(send: Send) -> None:
    allow = [
        (b"access-control-allow-methods", b"GET, HEAD, POST"),
        (b"access-control-allow-headers", b"Accept, Authorization, Content-Type"),
        (b"access-control-max-age", b"600"),
    ]
    await send({"type": "http.response.start", "status": 204, "headers": allow})
    await send({"type": "http.response.body", "body": b""})


def _same(origin: str, host: str, scope: Scope) -> bool:
    parts = urlsplit(origin)
    return parts.scheme == scope["scheme"] and parts.netloc.lower() == host.lower()
