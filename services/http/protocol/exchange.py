"""Reading requests strictly and answering them: shared by the two protocols."""

from collections.abc import Iterable, Mapping, Sequence
from typing import get_origin
from urllib.parse import parse_qsl

import pyoxigraph as ox
from starlette.requests import Request
from starlette.responses import Response

from sdt_kg.errors import meant
from services.http.problems import RefusedError
from services.http.protocol.negotiate import accepted, called
from services.judging.codec import check_once
from services.store.workers import Answered
from services.store.workers.evaluate import GRAPHS

Pairs = list[tuple[str, str]]
UTF_8 = frozenset({"", "utf-8", "utf8"})
"""Charsets of a request that is read; it may name none."""


def pairs(text: str | bytes) -> Pairs:
    """Name and value of each parameter, percent-decoded once, as UTF-8.

    Raises:
        RefusedError: It is not UTF-8.
    """
    try:
        decoded = text if isinstance(text, str) else text.decode("utf-8")
        return parse_qsl(decoded, keep_blank_values=True, errors="strict")
    except UnicodeDecodeError:
        raise RefusedError(400, "the parameters are not UTF-8", allowed="percent-encoded UTF-8") from None


def query_string(request: Request) -> Pairs:
    """The parameters of the URL."""
    return pairs(request.scope["query_string"])


def content_type(request: Request) -> tuple[str, str]:
    """Media type and charset that the request names, in small letters; empty where it names none."""
    media, *parameters = request.headers.get("content-type", "").split(";")
    charsets = [each.partition("=")[2] for each in parameters if each.strip().lower().startswith("charset=")]
    return media.strip().lower(), (charsets[0].strip(' "').lower() if charsets else "")


def single(parameters: Pairs, name: str) -> str | None:
    """The value of a parameter that may be there once."""
    values = [value for key, value in parameters if key == name]
    if len(values) > 1:
        raise RefusedError(400, f"there are {len(values)} parameters '{name}'", allowed="one")
    return values[0] if values else None


def check_spelling(parameters: Iterable[tuple[str, str]], known: Sequence[str]) -> None:
    """No parameter is left out because its name is misspelled; clients may have others of their own.

    Raises:
        RefusedError: One looks like one of these.
    """
    for name in {name for name, _ in parameters}.difference(known):
        if near := meant(name, known):
            raise RefusedError(
                400, f"there is no parameter '{name[:100]}'", allowed=f"did you mean '{near}'?"
            )


async def check_parameters(request: Request) -> None:
    """The URL of a verb has no parameter that the verb does not know: it would answer another question.

    Raises:
        RefusedError: It has, or one twice that may be there once.
    """
    parameters, known = query_string(request), request.scope["route"].dependant.query_params
    several = {each.alias for each in known if get_origin(each.field_info.annotation) is list}
    for name, _ in parameters:
        if name not in {each.alias for each in known}:
            allowed = ", ".join(each.alias for each in known) or "none here; a POST has them in its body"
            raise RefusedError(400, f"there is no parameter '{name[:100]}'", allowed=allowed)
        if name not in several:
            single(parameters, name)


async def check_body(request: Request) -> None:
    """A body that is JSON is in UTF-8 and says nothing twice.

    Raises:
        RefusedError: It is in another charset.
        InputError: It says something twice, or is no JSON.
    """
    media, charset = content_type(request)
    if charset not in UTF_8:
        raise RefusedError(415, f"the body is in {charset}", allowed="UTF-8")
    if media.endswith("json") and (body := await request.body()):
        check_once(body)


def own_url(request: Request) -> str:
    """The URL of the request without its query: what a relative IRI is resolved against."""
    return f"{request.url.scheme}://{request.headers['host']}{request.scope['path']}"


def accept_of(request: Request) -> str | None:
    """The Accept header; several lines of it are one list (RFC 9110, section 5.3)."""
    return ", ".join(request.headers.getlist("accept")) or None


def check_acceptable(request: Request, offers: tuple[str, ...]) -> tuple[str, ...]:
    """Media types that the client takes, best first.

    Raises:
        RefusedError: None of the offers.
    """
    taken = accepted(accept_of(request), offers)
    if not taken:
        raise RefusedError(406, "none of the accepted media types is offered", allowed=", ".join(offers))
    return taken


def serialized(triples: Iterable[ox.Triple], media: str, prefixes: Mapping[str, str]) -> Answered:
    """Triples in one of our formats."""
    used = None if media == "application/n-triples" else dict(prefixes)
    body = ox.serialize(triples, format=GRAPHS[media], prefixes=used)
    assert body is not None, "without an output, the bytes are returned"
    return Answered(media, body)


def respond(request: Request, answered: Answered) -> Response:
    """The answer; for HEAD its headers alone."""
    headers = {"Content-Type": called(answered.media, accept_of(request)), "Vary": "Accept"}
    if request.method == "HEAD":
        headers["Content-Length"] = str(len(answered.body))
        return Response(b"", 200, headers)
    return Response(answered.body, 200, headers)
