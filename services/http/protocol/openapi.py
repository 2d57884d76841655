"""The two protocols in the OpenAPI document, which knows only JSON verbs by itself."""

from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi

from services.http.problems import MEDIA
from services.store.workers.evaluate import GRAPHS, TABLES

Object = dict[str, Any]  # JSON object

PROBLEM: Object = {
    "type": "object",
    "required": ["type", "title", "status", "detail"],
    "properties": {
        "type": {"type": "string"},
        "title": {"type": "string", "description": "kind of the error"},
        "status": {"type": "integer"},
        "detail": {"type": "string", "description": "what is wrong, with the input's name"},
        "allowed": {"type": "string", "description": "what is allowed instead"},
        "remedy": {"type": "string", "description": "what to do"},
        "limit": {"type": "string", "description": "which limit was reached"},
    },
}
REFUSED: Object = {
    "description": "a problem document (RFC 9457)",
    "content": {MEDIA: {"schema": {"$ref": "#/components/schemas/Problem"}}},
}


def document(app: FastAPI) -> Object:
    """The app's OpenAPI document, with `/sparql`, `/graphs` and the token; made once."""
    if app.openapi_schema is None:
        schema = get_openapi(
            title=app.title, version=app.version, description=app.description, routes=app.routes
        )
        schema["paths"] |= {"/sparql": _sparql(), "/graphs": _graphs()}
        components = schema.setdefault("components", {})
        components["securitySchemes"] = {"token": {"type": "http", "scheme": "bearer"}}
        schemas = components.setdefault("schemas", {})
        schemas["Problem"] = PROBLEM
        for unused in ("HTTPValidationError", "ValidationError"):
            schemas.pop(unused, None)
        for path, item in schema["paths"].items():
            if not path.startswith("/api/"):
                continue
            for verb in item.values():
                verb["responses"].pop("422", None)
                verb["responses"]["default"] = REFUSED
            if "post" in item:
                item["post"]["security"] = [{"token": []}, {}]
        app.openapi_schema = schema
    return app.openapi_schema


def _sparql() -> Object:
    dataset = [_parameter("default-graph-uri", many=True), _parameter("named-graph-uri", many=True)]
    answers = _answers((*TABLES, *GRAPHS))
    text = {"application/sparql-query": {"schema": {"type": "string"}}}
    form = {
        "application/x-www-form-urlencoded": {
            "schema": {"type": "object", "required": ["query"], "properties": {"query": {"type": "string"}}}
        }
    }
    return {
        "get": {
            "summary": "SPARQL 1.1 Protocol: query; without one, the service description",
            "parameters": [_parameter("query"), *dataset],
            "responses": answers,
        },
        "post": {
            "summary": "SPARQL 1.1 Protocol: query",
            "parameters": dataset,
            "requestBody": {"content": text | form},
            "responses": answers,
        },
    }


def _graphs() -> Object:
    return {
        "get": {
            "summary": "SPARQL 1.1 Graph Store Protocol: a whole graph",
            "parameters": [_parameter("graph"), _parameter("default")],
            "responses": _answers(tuple(GRAPHS)),
        }
    }


def _parameter(name: str, *, many: bool = False) -> Object:
    one: Object = {"type": "string"}
    return {"name": name, "in": "query", "schema": {"type": "array", "items": one} if many else one}


def _answers(media: tuple[str, ...]) -> Object:
    complete = {"description": "complete", "content": {each: {} for each in media}}
    return {"200": complete, "default": REFUSED}
