"""SPARQL 1.1 Protocol over HTTP: kept connections, bounded retries, typed errors."""

import base64
import time
from collections.abc import Mapping, Sequence
from typing import Final
from urllib.parse import unquote, urlencode, urlsplit, urlunsplit

import urllib3
from urllib3.exceptions import DecodeError, HTTPError, LocationValueError, ReadTimeoutError

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


class Wire:
    """A client of servers. It asks no proxy, reads no netrc, follows no redirect.

    Whatever is sent twice must mean the same as once: requests are repeated when a connection breaks.
    """

    def __init__(self, waits: Sequence[float] = RETRY_WAITS, timeout: float = ANSWER_TIMEOUT) -> None:
        self._waits = waits
        self._timeout = timeout
        self._pools = urllib3.PoolManager(
            timeout=urllib3.Timeout(connect=CONNECT_TIMEOUT, read=timeout), retries=False
        )

    def query(self, address: str, form: Form, accept: str) -> bytes:
        """The whole answer to a query, in the media type that was asked for.

        Raises:
            QueryError: The server does not understand the query.
            StoreError: There is no whole answer.
        """
        answer = self._post(address, urlencode(form, doseq=True).encode(), FORM, accept)
        if answer.status == BAD_REQUEST:
            raise QueryError(f"the server refuses the query: {_said(answer)}", allowed="SPARQL 1.1")
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
        return answer.data

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
        self._pools.clear()

    def _post(self, address: str, body: bytes, media: str, accept: str) -> urllib3.BaseHTTPResponse:
        headers = {"accept": accept, "content-type": media} | _login(address)
        for wait in (*self._waits, None):
            try:
                answer = self._pools.request("POST", address, body=body, headers=headers, redirect=False)
                problem = _status(answer)
                if answer.status not in RETRIED_STATUS:
                    return answer
            except ReadTimeoutError as error:
                raise _gone(address, f"did not answer in {self._timeout:g} s") from error
            except (LocationValueError, DecodeError) as error:
                raise StoreRejectedError(shown(address), f"cannot be asked: {error}") from None
            except HTTPError as error:
                problem = f"does not answer ({error})"
            if wait is None:
                raise _gone(address, f"{problem}, {len(self._waits) + 1} times in a row")
            time.sleep(wait)
        raise AssertionError("the last attempt returns or raises")


def _login(address: str) -> dict[str, str]:
    """The header for the user and password of an address, if it has any."""
    url = urlsplit(address)
    if url.username is None and url.password is None:
        return {}
    pair = f"{unquote(url.username or '')}:{unquote(url.password or '')}"
    return {"authorization": "Basic " + base64.b64encode(pair.encode()).decode()}


def shown(address: str) -> str:
    """The address without user, password and parameters, one of which may be a token."""
    url = urlsplit(address)
    return urlunsplit((url.scheme, url.netloc.rpartition("@")[2], url.path, "", ""))


def _gone(address: str, problem: str) -> StoreUnavailableError:
    return StoreUnavailableError(
        shown(address), problem, remedy="is the server running? try again; what was acknowledged is kept"
    )


def _check(answer: urllib3.BaseHTTPResponse, address: str) -> None:
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
    problem = f"{_status(answer)}: {_said(answer)}".rstrip(": ")
    raise StoreRejectedError(shown(address), problem, remedy=remedy)


def _status(answer: urllib3.BaseHTTPResponse) -> str:
    return f"answers {answer.status} {answer.reason or ''}".rstrip()


def _said(answer: urllib3.BaseHTTPResponse) -> str:
    """The beginning of its text, on one line."""
    return " ".join(answer.data.decode(errors="replace").split())[:SHOWN_ANSWER]
