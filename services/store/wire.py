"""SPARQL 1.1 Protocol over HTTP: one kept connection, bounded retries, typed errors."""

import time
from collections.abc import Mapping, Sequence
from typing import Final
from urllib.parse import urlencode

import httpx

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

RETRIED_STATUS: Final = frozenset({429, 502, 503, 504})
BAD_REQUEST: Final = 400
DENIED_STATUS: Final = frozenset({401, 403})
MOST_ROWS: Final = "X-SPARQL-MaxRows"
"""Virtuoso's header of an answer that has not all rows; its status is 200."""

WRONG_PLACE_STATUS: Final = frozenset({404, 405, 415, 501})

Form = Mapping[str, str | Sequence[str]]


class Wire:
    """A client of one server. It asks no proxy, reads no netrc, follows no redirect.

    Whatever is sent twice must mean the same as once: requests are repeated when a connection breaks.
    """

    def __init__(self, waits: Sequence[float] = RETRY_WAITS, timeout: float = ANSWER_TIMEOUT) -> None:
        self._waits = waits
        self._client = httpx.Client(
            timeout=httpx.Timeout(timeout, connect=CONNECT_TIMEOUT), trust_env=False, follow_redirects=False
        )

    def query(self, address: str, form: Form, accept: str) -> bytes:
        """The whole answer to a query, in the media type that was asked for.

        Raises:
            QueryError: The server does not understand the query.
            StoreError: There is no whole answer.
        """
        answer = self._post(address, urlencode(form, doseq=True), FORM, accept)
        if answer.status_code == BAD_REQUEST:
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
        return answer.content

    def update(self, address: str, text: str) -> None:
        """Have an update done; it is, when this returns.

        Raises:
            StoreError: It may not have been.
        """
        answer = self._post(address, text, UPDATE, "*/*")
        _check(answer, address)

    def close(self) -> None:
        """Let go of the connection."""
        self._client.close()

    def _post(self, address: str, body: str, media: str, accept: str) -> httpx.Response:
        headers = {"accept": accept, "content-type": media}
        for wait in (*self._waits, None):
            try:
                answer = self._client.post(address, content=body.encode(), headers=headers)
                problem = f"answers {answer.status_code} {answer.reason_phrase}"
                if answer.status_code not in RETRIED_STATUS:
                    return answer
            except httpx.ReadTimeout as error:
                raise _gone(address, f"did not answer in {self._client.timeout.read:g} s") from error
            except httpx.TransportError as error:
                problem = f"does not answer ({error or type(error).__name__})"
            except (httpx.InvalidURL, httpx.DecodingError) as error:
                raise StoreRejectedError(shown(address), f"cannot be asked: {error}") from None
            if wait is None:
                raise _gone(address, f"{problem}, {len(self._waits) + 1} times in a row")
            time.sleep(wait)
        raise AssertionError("the last attempt returns or raises")


def shown(address: str) -> str:
    """The address without user, password and parameters, one of which may be a token."""
    url = httpx.URL(address)
    bare = url.copy_with(username=None, password=None, query=None)
    return str(bare) if url.userinfo or url.query else address


def _gone(address: str, problem: str) -> StoreUnavailableError:
    return StoreUnavailableError(
        shown(address), problem, remedy="is the server running? try again; what was acknowledged is kept"
    )


def _check(answer: httpx.Response, address: str) -> None:
    """Raise StoreRejectedError for any status but success, with what would help."""
    if answer.is_success:
        return
    remedy = ""
    if answer.status_code in DENIED_STATUS:
        remedy = "give user and password: http://USER:PASSWORD@HOST/…"
    elif answer.status_code in WRONG_PLACE_STATUS:
        remedy = "give both addresses of the server, for query and for update: services/README.md"
    elif answer.is_redirect:
        remedy = f"give the address it leads to: {answer.headers.get('location', '')}"
    problem = f"answers {answer.status_code} {answer.reason_phrase}: {_said(answer)}"
    raise StoreRejectedError(shown(address), problem.rstrip(": "), remedy=remedy)


def _said(answer: httpx.Response) -> str:
    return " ".join(answer.text.split())[:SHOWN_ANSWER]
