"""What describes a server: AsyncAPI 3 of its keys, made from the message types, and VoID of what it holds."""

import re
from importlib.metadata import version
from typing import Final

from services.bus import examples, keys
from services.bus.asking import Header
from services.bus.keys import Meta, Part
from services.judging.codec import CBOR, JSON
from services.judging.messages import REQUESTS, SCHEMA
from services.judging.problems import Problem
from services.judging.replies import REPLIES, JobReply

MEDIA: Final = "application/n-triples"
VOID: Final = """
PREFIX void: <http://rdfs.org/ns/void#>
CONSTRUCT {
  ?dataset a void:Dataset ;
    void:classPartition ?part ;
    void:distinctSubjects ?subjects ;
    void:triples ?triples ;
    void:vocabulary law:, sdt:, tee: .
  ?part void:class ?class ;
    void:entities ?entities .
}
WHERE {
  { SELECT (COUNT(*) AS ?triples) (COUNT(DISTINCT ?s) AS ?subjects) WHERE { ?s ?p ?o } }
  { SELECT ?class (COUNT(DISTINCT ?each) AS ?entities) WHERE { ?each a ?class } GROUP BY ?class }
  BIND (id:dataset AS ?dataset)
  BIND (IRI(CONCAT(STR(?dataset), "#", ENCODE_FOR_URI(STR(?class)))) AS ?part)
}
"""
"""Over entities, present states and verdicts: the default graph."""

Object = dict[str, object]

_REFERENCE = "#/components/schemas/{model}"
_SPARQL = {"type": "string", "description": "SPARQL 1.1 results as JSON, or N-Triples"}
_QUERYABLE: Object = {"kind": "queryable", "complete": True, "error": "problem"}
_PARAMETERS = {
    "twin": "Name of the kitchen, percent-encoded",
    "instance": "Of the server, as replies and liveliness tokens name it",
    "id": "Of the job, as rpc/sweep gave it",
    "kind": "verdict or state",
    "sequence": "Number of the event, from 1",
}
_META: dict[Meta, Object] = {
    Meta.VOID: {"payload": {"type": "string"}, "contentType": MEDIA},
}
"""What is no JSON object among what a server says of itself."""


def asyncapi() -> Object:
    """The document: a channel and an operation for each key, with `x-zenoh` for what Zenoh adds."""
    channels = _verbs() | _jobs() | _meta() | _told()
    return {
        "asyncapi": "3.0.0",
        "info": {"title": "sdt-kg: the Law over Zenoh", "version": version("sdt-kg")},
        "defaultContentType": JSON,
        "x-zenoh": {"root": keys.ROOT, "schema": SCHEMA, "encodings": [JSON, CBOR]},
        "channels": channels,
        "operations": {name: _operation(name, channel) for name, channel in channels.items()},
        "components": {"schemas": _schemas()},
    }


def _verbs() -> dict[str, Object]:
    """A question to any server."""
    found: dict[str, Object] = {}
    for verb, request in REQUESTS.items():
        reply = REPLIES.get(verb)
        asked: Object = {
            "payload": _reference(request.__name__),
            "headers": _reference(Header.__name__),
            "examples": [{"payload": examples.REQUESTS[verb], "headers": examples.HEADER}],
        }
        answer: Object = {"payload": _SPARQL if reply is None else _reference(reply.__name__)}
        if verb in examples.REPLIES:
            answer["examples"] = [{"payload": examples.REPLIES[verb]}]
        found[verb.value] = _channel(f"rpc/{verb.value}", _QUERYABLE, request=asked, reply=answer)
    return found


def _jobs() -> dict[str, Object]:
    """How far a sweep is, what it has found, and its end."""
    job: Object = {"payload": _reference(JobReply.__name__)}
    return {
        f"jobs-{part.value}": _channel(
            f"jobs/{{id}}/{part.value}",
            _QUERYABLE,
            request={},
            reply={"payload": {"type": "object"}} if part is Part.RESULT else job,
        )
        for part in Part
    }


def _meta() -> dict[str, Object]:
    """What each server says of itself."""
    anything: Object = {"payload": {"type": "object"}}
    return {
        f"meta-{part.value}": _channel(
            f"@meta/{part.value}", {"kind": "queryable"}, request={}, reply=_META.get(part, anything)
        )
        for part in Meta
    }


def _told() -> dict[str, Object]:
    """What is published, and who is there."""
    quads: Object = {"payload": {"type": "string"}, "contentType": "application/n-quads"}
    return {
        "events": _channel("events/{kind}/{sequence}", {"kind": "publication"}, event=quads),
        "live": _channel("@live/{instance}", {"kind": "liveliness"}, token={}),
    }


def _channel(tail: str, zenoh: Object, **messages: Object) -> Object:
    address = f"{keys.ROOT}/{{twin}}/{tail}"
    if "error" in zenoh:
        messages["problem"] = {
            "payload": _reference(Problem.__name__),
            "examples": [{"payload": examples.PROBLEM}],
        }
    return {
        "address": address,
        "parameters": {name: {"description": _PARAMETERS[name]} for name in re.findall(r"{(\w+)}", address)},
        "messages": messages,
        "x-zenoh": zenoh,
    }


def _operation(name: str, channel: Object) -> Object:
    """What the server does: it receives a request and replies, or it sends."""
    where, messages = {"$ref": f"#/channels/{name}"}, channel["messages"]
    assert isinstance(messages, dict), "as made above"
    if "request" not in messages:
        return {"action": "send", "channel": where}
    return {
        "action": "receive",
        "channel": where,
        "messages": [{"$ref": f"#/channels/{name}/messages/request"}],
        "reply": {"channel": where, "messages": [{"$ref": f"#/channels/{name}/messages/reply"}]},
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
