"""Every request as it is seen from outside: counted, logged with its id, traced."""

import logging
import re
import time
import uuid

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import Request
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from services.telemetry.metrics import MEDIA
from services.telemetry.origin import Origin, within
from services.telemetry.told import Telemetry

_ID = re.compile(r"[A-Za-z0-9._:-]{1,128}")
METHODS = frozenset({"GET", "HEAD", "OPTIONS", "POST"})
_log = logging.getLogger("sdt.http.request")


class Observed:
    """The outermost middleware.

    An `X-Request-ID` is taken up if it is short and plain, else one is made; it comes back with the answer.
    """

    def __init__(self, app: ASGIApp, telemetry: Telemetry) -> None:
        self._app, self._telemetry = app, telemetry

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        given = headers.get("x-request-id", "")
        request = given if _ID.fullmatch(given) else uuid.uuid4().hex
        span = self._telemetry.spans.begin(
            f"{scope['method']} {scope['path']}", headers.get("traceparent", ""), request=request
        )
        began, status = time.perf_counter(), [500]

        async def answered(message: Message) -> None:
            if message["type"] == "http.response.start":
                status[0] = message["status"]
                MutableHeaders(scope=message)["X-Request-ID"] = request
            await send(message)

        with within(Origin(request, span.traceparent)):
            try:
                await self._app(scope, receive, answered)
            finally:
                self._told(scope, status[0], time.perf_counter() - began)
                span.end(status=status[0])

    def _told(self, scope: Scope, status: int, seconds: float) -> None:
        end = "answer" if status < 400 else str(status)
        self._telemetry.metrics.asked("http", _what(scope), end, seconds)
        fields = {
            "method": scope["method"],
            "path": scope["path"],
            "status": status,
            "seconds": round(seconds, 6),
        }
        _log.info("%s %s %s", scope["method"], scope["path"], status, extra={"fields": fields})


def _what(scope: Scope) -> str:
    """Method and handler: a path of a resource, or a method that somebody made up, would be a label."""
    method = scope["method"] if scope["method"] in METHODS else "other"
    return f"{method} {getattr(scope.get('endpoint'), '__name__', 'none')}"


async def metrics(request: Request) -> Response:
    """Counts and latencies for Prometheus."""
    telemetry: Telemetry = request.app.state.telemetry
    return Response(telemetry.metrics.text(), media_type=MEDIA)
