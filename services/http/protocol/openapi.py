"""The two protocols in the OpenAPI document, which knows only JSON verbs by itself."""

from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi

from services.store.workers.evaluate import GRAPHS, TABLES

Object = dict[str, Any]  # JSON object


def document(app: FastAPI) -> Object:
    """The app's OpenAPI document, with `/sparql`, `/graphs` and the token; made once."""
    if app.openapi_schema is None:
        schema = get_openapi(
            title=app.title, version=app.version, description=app.description, routes=app.routes
        )
        schema["paths"] |= {"/sparql": _sparql(), "/graphs": _graphs()}
        bearer = {"type": "http", "scheme": "bearer"}
        schema.setdefault("components", {})["securitySchemes"] = {"token": bearer}
        for path, item in schema["paths"].items():
            if path.startswith("/api/") and "post" in item:
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
    problem = {"application/problem+json": {"schema": {"type": "object"}}}
    return {
        "200": {"description": "complete", "content": {each: {} for each in media}},
        "default": {"description": "a problem document (RFC 9457)", "content": problem},
    }
