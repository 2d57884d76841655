"""AsyncAPI 3 document of the bus, made from the message types themselves."""

from importlib.metadata import version

from services.bus import keys
from services.judging.codec import CBOR, JSON
from services.judging.messages import REQUESTS, SCHEMA, Header
from services.judging.problems import Problem
from services.judging.replies import REPLIES

Object = dict[str, object]

_REFERENCE = "#/components/schemas/{model}"
_SPARQL = {"type": "string", "description": "SPARQL 1.1 results as JSON, or N-Triples"}


def asyncapi() -> Object:
    """The document: a channel and an operation for each verb, with `x-zenoh` keys."""
    return {
        "asyncapi": "3.0.0",
        "info": {"title": "sdt-kg: the Law over Zenoh", "version": version("sdt-kg")},
        "defaultContentType": JSON,
        "x-zenoh": {"root": keys.ROOT, "schema": SCHEMA, "encodings": [JSON, CBOR]},
        "channels": {verb.value: _channel(verb) for verb in REQUESTS},
        "operations": {verb.value: _operation(verb) for verb in REQUESTS},
        "components": {"schemas": _schemas()},
    }


def _channel(verb: keys.Verb) -> Object:
    reply = REPLIES.get(verb)
    return {
        "address": f"{keys.ROOT}/{{twin}}/rpc/{verb.value}",
        "parameters": {"twin": {"description": "Name of the kitchen"}},
        "messages": {
            "request": {
                "payload": _reference(REQUESTS[verb].__name__),
                "headers": _reference(Header.__name__),
            },
            "reply": {"payload": _SPARQL if reply is None else _reference(reply.__name__)},
            "problem": {"payload": _reference(Problem.__name__)},
        },
        "x-zenoh": {"kind": "queryable", "complete": True, "error": "problem"},
    }


def _operation(verb: keys.Verb) -> Object:
    channel = f"#/channels/{verb.value}"
    return {
        "action": "receive",
        "channel": {"$ref": channel},
        "messages": [{"$ref": f"{channel}/messages/request"}],
        "reply": {"channel": {"$ref": channel}, "messages": [{"$ref": f"{channel}/messages/reply"}]},
    }


def _schemas() -> Object:
    found: Object = {}
    for model in (*REQUESTS.values(), *REPLIES.values(), Header, Problem):
        schema = model.model_json_schema(ref_template=_REFERENCE)
        found |= schema.pop("$defs", {})
        found[model.__name__] = schema
    return found


def _reference(name: str) -> Object:
    return {"$ref": _REFERENCE.format(model=name)}
