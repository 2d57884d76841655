"""SPARQL 1.1 Protocol over HTTP: kept connections, bounded retries, typed errors."""

import base64
import select
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from http.client import HTTPConnection, HTTPException, HTTPMessage, HTTPSConnection, InvalidURL
from string import punctuation
from typing import Final, Self
from urllib.parse import quote, unquote, urlencode, urlsplit, urlunsplit

from sdt_kg.errors import QueryError, StoreRejectedError, StoreUnavailableError

RETRY_WAITS: Final = (0.1, 0.2, 0.4, 0.8, 1.6)
"""[s] Before each further attempt: a server that restarts is back within three seconds."""

CONNECT_TIMEOUT: Final = 5.0
ANSWER_TIMEOUT: Final = 120.0
"""[s] Without a byte from the server."""

SHOWN_ANSWER: Final = 200
"""[characters] Of what a server says of an error."""

FORM: Final = "application/x-www-form-urlencoded"
UPDATE: Final = "application/sparql-update"
"""An update is sent as it is: in a form, each sign of it would be looked at twice more."""

N_QUADS: Final = "application/n-quads"

RETRIED_STATUS: Final = frozenset({429, 502, 503, 504})
BAD_REQUEST: Final = 400
DENIED_STATUS: Final = frozenset({401, 403})
MOST_ROWS: Final = "X-SPARQL-MaxRows"
"""Virtuoso's header of an answer that has not all rows; its status is 200."""

WRONG_PLACE_STATUS: Final = frozenset({404, 405, 415, 501})

Form = Mapping[str, str | Sequence[str]]


@dataclass(frozen=True, slots=True)
class Answer:
    """What a server said, whole."""

    status: int
    reason: str
    headers: HTTPMessage
    body: bytes = field(repr=False)

    def __str__(self) -> str:
        return f"answers {self.status} {self.reason}".rstrip()

    def said(self) -> str:
        """The beginning of its text, on one line."""
        return " ".join(self.body.decode(errors="replace").split())[:SHOWN_ANSWER]


@dataclass(frozen=True, slots=True)
class Place:
    """What an address says.

    Attributes:
        login: Value of the header Authorization; None without user and password.
    """

    is_encrypted: bool
    host: str
    port: int | None
    target: str
    login: str | None

    @classmethod
    @lru_cache
    def of(cls, address: str) -> Self:
        """The parts of a URL.

        Raises:
            ValueError: It is none.
        """
        url = urlsplit(address)
        target = quote(urlunsplit(("", "", url.path or "/", url.query, "")), safe=punctuation)
        user = f"{unquote(url.username or '')}:{unquote(url.password or '')}"
        login = "Basic " + base64.b64encode(user.encode()).decode() if user != ":" else None
        return cls(url.scheme == "https", url.hostname or "", url.port, target, login)


class Wire:
    """A client of servers. It asks no proxy, reads no netrc, follows no redirect.

    Whatever is sent twice must mean the same as once: requests are repeated when a connection breaks.
    """

    def __init__(self, waits: Sequence[float] = RETRY_WAITS, timeout: float = ANSWER_TIMEOUT) -> None:
        self._waits = waits
        self._timeout = timeout
        self._idle: dict[tuple[bool, str, int | None], list[HTTPConnection]] = {}

    def query(self, address: str, form: Form, accept: str) -> bytes:
        """The whole answer to a query, in the media type that was asked for.

        Raises:
            QueryError: The server does not understand the query.
            StoreError: There is no whole answer.
        """
        answer = self._post(address, urlencode(form, doseq=True).encode(), FORM, accept)
        if answer.status == BAD_REQUEST:
            raise QueryError(f"the server refuses the query: {answer.said()}", allowed="SPARQL 1.1")
        _check(answer, address)
        given = answer.headers.get("content-type", "").partition(";")[0].strip()
        if given != accept:
            raise StoreRejectedError(
                shown(address),
                f"answers with '{given}' instead of {accept}",
                remedy="is that the address of a SPARQL query service?",
            )
        if MOST_ROWS in answer.headers:
            raise StoreRejectedError(
                shown(address),
                f"broke its answer off after {answer.headers[MOST_ROWS]} rows",
                remedy="raise its limit (Virtuoso: ResultSetMaxRows), or ask for less",
            )
        return answer.body

    def update(self, address: str, text: str) -> None:
        """Have an update done; it is, when this returns.

        Raises:
            StoreError: It may not have been.
        """
        _check(self._post(address, text.encode(), UPDATE, "*/*"), address)

    def load(self, address: str, quads: bytes) -> None:
        """Have N-Quads added; they are there when this returns.

        Raises:
            StoreError: They may not be.
        """
        _check(self._post(address, quads, N_QUADS, "*/*"), address)

    def close(self) -> None:
        """Let go of the connections."""
        for connections in self._idle.values():
            while connections:
                connections.pop().close()

    def _post(self, address: str, body: bytes, media: str, accept: str) -> Answer:
        for wait in (*self._waits, None):
            try:
                answer = self._sent(Place.of(address), body, {"accept": accept, "content-type": media})
                problem = str(answer)
                if answer.status not in RETRIED_STATUS:
                    return answer
            except TimeoutError as error:
                raise _gone(address, f"did not answer in {self._timeout:g} s") from error
            except (InvalidURL, ValueError) as error:
                raise StoreRejectedError(shown(address), f"cannot be asked: {error}") from None
            except (OSError, HTTPException) as error:
                problem = f"does not answer ({str(error) or type(error).__name__})"
            if wait is None:
                raise _gone(address, f"{problem}, {len(self._waits) + 1} times in a row")
            time.sleep(wait)
        raise AssertionError("the last attempt returns or raises")

    def _sent(self, place: Place, body: bytes, headers: dict[str, str]) -> Answer:
        """The answer to one request; its connection is kept if the server keeps it."""
        idle = self._idle.setdefault((place.is_encrypted, place.host, place.port), [])
        connection = _usable(idle) or self._connected(place)
        if place.login:
            headers["authorization"] = place.login
        try:
            connection.request("POST", place.target, body, headers)
            answer = connection.getresponse()
            whole = Answer(answer.status, answer.reason, answer.headers, answer.read())
        except BaseException:
            connection.close()
            raise
        if connection.sock is not None:  # http.client closes it when the server says so
            idle.append(connection)
        coding = whole.headers.get("content-encoding", "identity")
        if coding != "identity":
            raise ValueError(f"its answer is coded as '{coding}', which was not asked for")
        return whole

    def _connected(self, place: Place) -> HTTPConnection:
        kind = HTTPSConnection if place.is_encrypted else HTTPConnection
        connection = kind(place.host, place.port, timeout=CONNECT_TIMEOUT)
        try:
            connection.connect()
        except TimeoutError:
            raise ConnectionError(f"no connection in {CONNECT_TIMEOUT:g} s") from None
        connection.sock.settimeout(self._timeout)
        return connection


def _usable(idle: list[HTTPConnection]) -> HTTPConnection | None:
    """A kept connection which the server has not closed meanwhile; the others are let go."""
    while idle:
        connection = idle.pop()
        poll = select.poll()
        poll.register(connection.sock, select.POLLIN)
        if not poll.poll(0):  # what can be read before anything was asked is its end
            return connection
        connection.close()
    return None


def shown(address: str) -> str:
    """The address without user, password and parameters, one of which may be a token."""
    url = urlsplit(address)
    return urlunsplit((url.scheme, url.netloc.rpartition("@")[2], url.path, "", ""))


def _gone(address: str, problem: str) -> StoreUnavailableError:
    return StoreUnavailableError(
        shown(address), problem, remedy="is the server running? try again; what was acknowledged is kept"
    )


def _check(answer: Answer, address: str) -> None:
    """Raise StoreRejectedError for any status but success, with what would help."""
    if answer.status // 100 == 2:
        return
    remedy = ""
    if answer.status in DENIED_STATUS:
        remedy = "give user and password: http://USER:PASSWORD@HOST/…"
    elif answer.status in WRONG_PLACE_STATUS:
        remedy = "give both addresses of the server, for query and for update: services/README.md"
    elif "location" in answer.headers:
        remedy = f"give the address it leads to: {answer.headers['location']}"
    raise StoreRejectedError(shown(address), f"{answer}: {answer.said()}".rstrip(": "), remedy=remedy)
