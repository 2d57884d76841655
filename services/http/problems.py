"""Errors as problem documents (RFC 9457): what, what is allowed, what to do, and never a traceback."""

import json
import logging
import secrets
from collections.abc import Callable, Mapping
from http import HTTPStatus
from typing import Any, TypeGuard, get_args

from fastapi import FastAPI
from fastapi.exceptions import RequestValidationError
from fastapi.routing import APIRoute
from pydantic import BaseModel
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Match

from sdt_kg.errors import InputError, OracleUnavailableError, SdtError, StoreError, UnknownEntityError
from services.judging.problems import InternalError
from services.store.guard import RefusedQueryError
from services.store.workers import BusyError, Limit, LimitError, NotAcceptableError

MEDIA = "application/problem+json"
LIMIT_STATUS = {Limit.TIME: 408, Limit.ROWS: 413, Limit.BYTES: 413, Limit.MEMORY: 507}
"""A limit reached is never a shorter answer."""
NO_FIELD = "extra_forbidden"
WORDS = {
    NO_FIELD: "there is no such field",
    "json_invalid": "this is not JSON: {error}",
    "model_attributes_type": "a JSON object is expected",
    "dict_type": "a JSON object is expected",
    "list_type": "a JSON array is expected",
    "tuple_type": "a JSON array is expected",
}
"""Kind of fault in a body, by pydantic's name → what it is, where pydantic's words are about Python."""
METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE")
ERROR_STATUS: tuple[tuple[type[SdtError], int], ...] = (
    (RefusedQueryError, 403),
    (NotAcceptableError, 406),
    (UnknownEntityError, 404),
    (InputError, 400),
    (OracleUnavailableError, 503),
    (StoreError, 503),
    (InternalError, 500),
    (SdtError, 422),
)

_log = logging.getLogger("sdt.http")


class RefusedError(InputError):
    """A request that this service does not do, with the status that says so.

    Attributes:
        status: HTTP status.
        headers: Headers that belong to the status, Allow say.
    """

    def __init__(
        self,
        status: int,
        what: str,
        *,
        allowed: str = "",
        remedy: str = "",
        headers: Mapping[str, str] | None = None,
    ) -> None:
        self.status, self.headers = status, dict(headers or {})
        super().__init__(what, allowed=allowed, remedy=remedy)


def problem(
    status: int, title: str, detail: str, headers: Mapping[str, str] | None = None, **more: object
) -> Response:
    """One problem document."""
    document = {"type": "about:blank", "title": title, "status": status, "detail": detail}
    body = document | {name: value for name, value in more.items() if value}
    return JSONResponse(body, status, dict(headers or {}), MEDIA)


def status_of(error: SdtError) -> int:
    """HTTP status of a typed error."""
    if isinstance(error, RefusedError):
        return error.status
    if isinstance(error, LimitError):
        return LIMIT_STATUS[error.limit]
    return next(status for kind, status in ERROR_STATUS if isinstance(error, kind))


def of_error(error: SdtError) -> Response:
    """A typed error as a problem."""
    status = status_of(error)
    headers = error.headers if isinstance(error, RefusedError) else {}
    if isinstance(error, BusyError):
        headers = {"Retry-After": "1"}
    title = type(error).__name__.removesuffix("Error")
    if isinstance(error, StoreError):  # where it lies is not for everybody
        _log.error("%s", error)
        return problem(status, title, f"the store of this service {error.what}", headers, remedy=error.remedy)
    if not isinstance(error, InputError):
        return problem(status, title, str(error), headers)
    limit = error.limit.value if isinstance(error, LimitError) else ""
    return problem(
        status, title, error.what, headers, allowed=error.allowed, remedy=error.remedy, limit=limit
    )


def install(app: FastAPI, told: Callable[[Request, Response], Response]) -> None:
    """Every error of the app is answered as a problem, or as `told` makes a page of it."""

    @app.exception_handler(SdtError)
    async def typed(request: Request, error: SdtError) -> Response:  # pyright: ignore[reportUnusedFunction]
        return told(request, of_error(error))

    @app.exception_handler(RequestValidationError)
    async def invalid(request: Request, error: RequestValidationError) -> Response:  # pyright: ignore[reportUnusedFunction]
        return told(request, of_body(request.headers.get("content-type", ""), error, _body(request)))

    @app.exception_handler(HTTPException)
    async def plain(request: Request, error: HTTPException) -> Response:  # pyright: ignore[reportUnusedFunction]
        detail = f"{request.method} {request.url.path}"
        headers = dict(error.headers or {})
        if error.status_code == HTTPStatus.METHOD_NOT_ALLOWED:
            headers["Allow"] = ", ".join(_methods(app, request))
        elsewhere = "/ has the pages, /openapi.json the verbs"
        remedy = elsewhere if error.status_code == HTTPStatus.NOT_FOUND else ""
        return told(request, problem(error.status_code, str(error.detail), detail, headers, remedy=remedy))

    @app.exception_handler(Exception)
    async def unforeseen(request: Request, error: Exception) -> Response:  # pyright: ignore[reportUnusedFunction]
        return told(request, unexpected(request.method, request.url.path, error))


def of_body(kind: str, error: RequestValidationError, body: type[BaseModel] | None) -> Response:
    """What is wrong with a request; of a body that was not read, that it does not say it is JSON.

    Args:
        kind: Media type that the request names.
        error: What was found.
        body: What is expected of it.
    """
    media = kind.partition(";")[0].strip().lower()
    unread = [each["loc"] for each in error.errors()] == [("body",)]
    if unread and media != "application/json" and not media.endswith("+json"):
        said = f"the body is '{media}'" if media else "the body does not say what it is"
        return problem(415, "Unsupported Media Type", said, allowed="Content-Type: application/json")
    found = error.errors()
    faults = [f"{'.'.join(map(str, each['loc']))}: {_words(each)}" for each in found]
    allowed = "; ".join(dict.fromkeys(filter(None, (_allowed(each, body) for each in found))))
    return problem(422, "Invalid", "; ".join(faults), allowed=allowed, remedy="/openapi.json has the details")


def _words(fault: Mapping[str, Any]) -> str:
    said = WORDS.get(fault["type"])
    return str(fault["msg"]) if said is None else said.format_map(fault.get("ctx", {}))


def _allowed(fault: Mapping[str, Any], body: type[BaseModel] | None) -> str:
    """The fields that there are, where there is no such field; else an example, if the field has one."""
    place, *inner = map(str, fault["loc"])
    if body is None or place != "body" or not inner:
        return ""
    if fault["type"] == NO_FIELD:
        return f"{'.'.join([place, *inner[:-1]])}: {', '.join(_part(body, inner[:-1]).model_fields)}"
    field = body.model_fields.get(inner[0])
    examples = field.examples if field else None
    return f'for example "{inner[0]}": {json.dumps(examples[0])}' if examples else ""


def _part(body: type[BaseModel], place: list[str]) -> type[BaseModel]:
    """The object at that place of the body."""
    for name in place:
        annotation = body.model_fields[name].annotation
        body = next(each for each in (annotation, *get_args(annotation)) if _is_model(each))
    return body


def _is_model(annotation: object) -> TypeGuard[type[BaseModel]]:
    return isinstance(annotation, type) and issubclass(annotation, BaseModel)


def _body(request: Request) -> type[BaseModel] | None:
    """What is expected of the body of this verb."""
    route = request.scope.get("route")
    field = route.body_field if isinstance(route, APIRoute) else None
    annotation = None if field is None else field.field_info.annotation
    return annotation if _is_model(annotation) else None


def _methods(app: FastAPI, request: Request) -> list[str]:
    """All that the path allows; Starlette names those of the first of its routes."""
    asked = {method: {**request.scope, "method": method} for method in METHODS}
    return [one for one in METHODS if any(each.matches(asked[one])[0] is Match.FULL for each in app.routes)]


def unexpected(method: str, path: str, error: Exception) -> Response:
    """A bug of ours: logged with a number, answered with that number and nothing else."""
    number = secrets.token_hex(4)
    _log.error("%s %s failed (%s)", method, path, number, exc_info=error)
    return problem(500, "Internal error", f"this is logged as {number}")
