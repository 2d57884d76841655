"""Who may write through a page: whoever may write at all, or has signed in with the token.

A form of a page cannot send an Authorization header, so that the token is given once and a cookie stands
for it, which no script reads and which no other site's page sends along.
"""

import hmac
import secrets
import time
from typing import Final
from urllib.parse import parse_qsl, urlencode, urlsplit

from starlette.requests import Request
from starlette.responses import RedirectResponse, Response

from services.http.problems import RefusedError

COOKIE: Final = "sdt_session"
LASTS: Final = 8 * 3600
"""[s] Of a session."""
MOST: Final = 1000
"""Sessions; the oldest of more is ended."""
FORM: Final = "application/x-www-form-urlencoded"

Form = dict[str, str]


class Sessions:
    """Who has signed in since the service began."""

    def __init__(self) -> None:
        self._ends: dict[str, float] = {}

    def begin(self) -> str:
        """The name of a new session, which nobody can guess."""
        while len(self._ends) >= MOST:
            del self._ends[next(iter(self._ends))]
        name = secrets.token_urlsafe(32)
        self._ends[name] = time.monotonic() + LASTS
        return name

    def lasts(self, name: str) -> bool:
        """Whether somebody has signed in under this name, and not too long ago."""
        return self._ends.get(name, 0.0) > time.monotonic()

    def end(self, name: str) -> None:
        """It is over."""
        self._ends.pop(name, None)


def may_write(request: Request) -> bool:
    """Whether the request may have something judged."""
    token: str | None = request.app.state.settings.token
    if token is None:
        return True
    scheme, _, given = request.headers.get("authorization", "").partition(" ")
    if scheme.lower() == "bearer" and _same(given.strip(), token):
        return True
    return request.app.state.sessions.lasts(request.cookies.get(COOKIE, ""))


def check_may_write(request: Request) -> None:
    """Nothing, if the request may write.

    Raises:
        RefusedError: It needs the token.
    """
    if not may_write(request):
        raise RefusedError(
            401,
            "this needs the token",
            allowed="Authorization: Bearer TOKEN, or a session",
            remedy="sign in at /sign-in",
            headers={"WWW-Authenticate": 'Bearer realm="sdt"'},
        )


async def sign_in(request: Request) -> Response:
    """A session for who knows the token, and back to where it was asked for."""
    form = await posted(request)
    token: str | None = request.app.state.settings.token
    if token is not None and not _same(form.get("token", "").strip(), token):
        back = urlencode({"next": local(form.get("next", "")), "wrong": "1"})
        return RedirectResponse(f"/sign-in?{back}", 303)
    answer = RedirectResponse(local(form.get("next", "")), 303)
    if token is not None:
        name = request.app.state.sessions.begin()
        secure = request.url.scheme == "https"
        answer.set_cookie(COOKIE, name, LASTS, httponly=True, samesite="strict", secure=secure)
    return answer


async def sign_out(request: Request) -> Response:
    """The session is over."""
    form = await posted(request)
    request.app.state.sessions.end(request.cookies.get(COOKIE, ""))
    answer = RedirectResponse(local(form.get("next", "")), 303)
    answer.delete_cookie(COOKIE)
    return answer


async def posted(request: Request) -> Form:
    """The fields of a form that was sent; the last of each name."""
    return dict(await posted_pairs(request))


async def posted_pairs(request: Request) -> list[tuple[str, str]]:
    """The fields of a form that was sent, in its order.

    Raises:
        RefusedError: It is no form, or not UTF-8.
    """
    media = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if media != FORM:
        raise RefusedError(415, f"a form cannot be sent as '{media or 'nothing'}'", allowed=FORM)
    try:
        text = (await request.body()).decode("utf-8")
        return parse_qsl(text, keep_blank_values=True, errors="strict")
    except UnicodeDecodeError:
        raise RefusedError(400, "the form is not UTF-8", allowed="percent-encoded UTF-8") from None


def local(address: str) -> str:
    """The address, if it is a path of this service; else the start page: nobody is sent elsewhere."""
    parts = urlsplit(address)
    plain = address.startswith("/") and not address.startswith(("//", "/\\")) and address.isprintable()
    return address if plain and not parts.scheme and not parts.netloc else "/"


def _same(given: str, token: str) -> bool:
    return hmac.compare_digest(given.encode(), token.encode())
