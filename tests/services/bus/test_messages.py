"""Bytes ↔ values: arrays come back exactly, unknown fields pass, unknown major versions do not."""

import json
import re
from typing import Any

import cbor2
import jsonschema
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from predicates.case import Answer, Case, Code
from predicates.causes import nothing_to_cause
from sdt_kg.errors import InputError, OracleUnavailableError
from services.bus import examples, keys
from services.bus.asking import Header
from services.bus.keys import Meta, Part, Verb
from services.bus.oracles.codec import answer_plain, answer_value
from services.bus.schema import asyncapi
from services.judging.codec import CBOR, JSON, asked_in, decode, encode, encode_cbor, from_cbor, to_cbor
from services.judging.messages import REQUESTS, AchieveRequest, CausesRequest, SweepRequest
from services.judging.problems import ProblemType, error_of, problem, problem_of
from services.judging.replies import REPLIES
from tests.small import small_twin


@settings(suppress_health_check=[HealthCheck.too_slow])
@given(arrays(np.float64, st.tuples(st.integers(0, 5), st.integers(0, 4))))
def test_arrays_come_back_to_the_last_bit(array: np.ndarray) -> None:
    back = from_cbor(to_cbor({"a": array, "row": array.ravel()}))
    assert back["a"].shape == array.shape
    assert back["a"].tobytes() == array.tobytes()
    assert back["row"].tobytes() == array.tobytes()


def test_a_request_travels_as_json_and_as_cbor() -> None:
    request = AchieveRequest(task="open:d", robot="pr2", state=["a=1"], base=(1.0, 2.0, 3.0))
    assert decode(AchieveRequest, encode(request)) == request
    assert decode(AchieveRequest, encode_cbor(request), CBOR) == request


def test_numbers_of_numpy_are_numbers() -> None:
    asked = AchieveRequest.model_validate({"task": "open", "seed": np.int64(3), "budget": np.int64(2)})
    assert (asked.seed, asked.budget) == (3, 2.0)
    assert SweepRequest.model_validate({"seeds": list(np.arange(2))}).seeds == [0, 1]


def test_unknown_fields_pass_and_another_major_version_does_not() -> None:
    known = {"task": "open", "schema": "1.7", "colour": "red"}
    assert decode(CausesRequest, json.dumps(known).encode()).task == "open"
    with pytest.raises(InputError, match="schema 2"):
        decode(CausesRequest, json.dumps(known | {"schema": "2.0"}).encode())


@pytest.mark.parametrize(
    ("said", "message"),
    [
        ({"motoin": {}}, "no field 'motoin'; did you mean 'motion'"),
        ({"Base": [0, 0, 0]}, "no field 'Base'; did you mean 'base'"),
        ({"drive_": "fixed"}, "no field 'drive_'; did you mean 'drive'"),
        ({"robots": ["pr2"]}, "no field 'robots'; did you mean 'robot'"),
    ],
)
def test_a_misspelled_field_is_refused_for_it_would_be_another_question(
    said: dict[str, object], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        decode(AchieveRequest, json.dumps({"task": "open", **said}).encode())
    with pytest.raises(InputError, match=message):
        decode(AchieveRequest, cbor2.dumps({"task": "open", **said}), CBOR)


@pytest.mark.parametrize(
    "payload",
    [b"[", b"[]", b"7", b"{}", b'{"task": 3}', b'{"task": NaN}', b"\xff\xfe", b"[" * 100_000],
)
def test_what_is_no_request_is_refused(payload: bytes) -> None:
    with pytest.raises(InputError):
        decode(CausesRequest, payload)


@pytest.mark.parametrize(
    "said", [{"budget": "20"}, {"seed": True}, {"base": [0, "0", 0]}, {"motions": "no"}, {"quads": 1}]
)
def test_a_text_or_truth_is_no_number_and_nothing_else_a_truth(said: dict[str, object]) -> None:
    for payload, encoding in ((json.dumps, JSON), (cbor2.dumps, CBOR)):
        raw = payload({"task": "open", **said})
        with pytest.raises(InputError, match="Input should be a valid"):
            decode(AchieveRequest, raw.encode() if isinstance(raw, str) else raw, encoding)


def test_a_request_that_says_a_thing_twice_is_refused_at_any_depth() -> None:
    with pytest.raises(InputError, match="'task' is there twice; allowed: every name once"):
        asked_in(AchieveRequest, b'{"task": "open", "task": "close"}')
    with pytest.raises(InputError, match="'times' is there twice"):
        asked_in(AchieveRequest, b'{"task": "open", "motion": {"times": [0, 1], "times": [0, 9]}}')
    assert asked_in(AchieveRequest, b'{"task": "open", "robot": "\\u0070r2"}').robot == "pr2"


@pytest.mark.parametrize(
    "payload",
    [
        b"",
        b"\x9f",
        cbor2.dumps([1]),
        cbor2.dumps(cbor2.CBORTag(40, [[10**9, 10**9], cbor2.CBORTag(86, b"\0" * 8)])),
        cbor2.dumps(cbor2.CBORTag(86, b"\0" * 7)),
        cbor2.dumps(cbor2.CBORTag(30, [1, 3])),
        cbor2.dumps({"task": "open"}) + cbor2.dumps({"task": "close"}),
    ],
)
def test_what_is_no_cbor_request_is_refused(payload: bytes) -> None:
    with pytest.raises(InputError):
        decode(CausesRequest, payload, CBOR)


def test_a_name_that_is_there_twice_is_refused_in_cbor_too() -> None:
    once = cbor2.dumps({"task": "open"})[1:]
    with pytest.raises(InputError, match="Duplicate map key: 'task'"):
        asked_in(CausesRequest, b"\xa2" + once + once, CBOR)


def test_cbor_has_no_tags_but_those_of_arrays() -> None:
    for tag in range(2**16):
        payload = b"\xda" + tag.to_bytes(4, "big") + b"\xf6"
        with pytest.raises(InputError):
            from_cbor(payload)


def doubling(depth: int) -> bytes:
    """A list of two lists of two lists …, each list there once and named by a reference the second time."""
    lists = b"\x80"
    for level in reversed(range(depth)):
        lists = b"\x82\xd8\x1c" + lists + b"\xd8\x1d\x18" + bytes([level])
    return lists


def test_a_few_bytes_are_no_list_that_never_ends() -> None:
    with pytest.raises(InputError, match="allowed are the tags 40 and 86"):
        asked_in(CausesRequest, b"\xa1\x64task" + doubling(60), CBOR)


@pytest.mark.parametrize("kind", ProblemType)
def test_every_problem_becomes_an_exception_of_its_own_and_back(kind: ProblemType) -> None:
    said = problem(kind, "because", retry_after=1.0)
    error = error_of(said)
    assert problem_of(error) == said
    assert isinstance(error, OracleUnavailableError) == (kind is ProblemType.UNAVAILABLE)
    assert isinstance(error, InputError) == (kind is ProblemType.INVALID_REQUEST)


def test_keys_name_their_parts() -> None:
    assert keys.asked(keys.rpc("b", Verb.SELECT)) is Verb.SELECT
    assert keys.asked(keys.rpc("b", Verb.SELECT, "instance1")) is Verb.SELECT
    assert keys.asked("sdt/v1/b/rpc/dance") is None
    for name in ("a/b", "*", "a b", "$*", "ä", "@oracle", "a?b#c"):
        key = keys.rpc(name, Verb.SELECT)
        assert keys.asked(key) is Verb.SELECT
        assert re.fullmatch(r"sdt/v1/[\w.%-]+/rpc/select", key, re.ASCII)
    with pytest.raises(InputError, match="no name"):
        keys.rpc("", Verb.SELECT)
    for wrong in ("a/b", "*", "", "$*"):
        with pytest.raises(InputError):
            keys.job("b", wrong, Part.CANCEL)


def test_the_code_of_a_reason_travels_with_an_oracles_answer_and_one_of_before_has_none() -> None:
    twin = small_twin("a")
    plain = from_cbor(to_cbor(answer_plain(Answer(Case(twin), False, (nothing_to_cause("it is there"),)))))
    assert [each.code for each in answer_value(twin, plain).diagnoses] == [Code.NOTHING_TO_CAUSE]
    for each in plain["diagnoses"]:
        del each["code"]
    assert [each.code for each in answer_value(twin, plain).diagnoses] == [None]


def test_a_header_has_bounds() -> None:
    for wrong in ({"deadline_ms": 0}, {"deadline_ms": 10**12}, {"id": "x" * 1000}):
        with pytest.raises(InputError):
            decode(Header, json.dumps(wrong).encode())


def test_every_reference_of_the_asyncapi_document_leads_somewhere() -> None:
    document = json.loads(json.dumps(asyncapi()))
    assert document["asyncapi"].startswith("3.")
    references = _references(document)
    assert references
    for reference in references:
        where = document
        for part in reference.removeprefix("#/").split("/"):
            where = where[part]


def test_every_key_has_a_channel_of_the_asyncapi_document() -> None:
    channels: dict[str, Any] = json.loads(json.dumps(asyncapi()))["channels"]
    named = {"twin": "b", "id": "1", "kind": "state", "sequence": f"{7:012d}", "instance": "me"}
    told = {channel["address"].format(**named) for channel in channels.values()}
    assert told == {
        *(keys.rpc("b", verb) for verb in Verb),
        *(keys.job("b", "1", part) for part in Part),
        *(keys.meta("b", part) for part in Meta),
        keys.event("b", "state", 7),
        keys.live("b", "me"),
    }


def _validated(schema: dict[str, Any], document: dict[str, Any], value: object) -> None:
    validator = jsonschema.Draft202012Validator({**schema, "components": document["components"]})
    validator.validate(value)


def test_every_example_of_the_asyncapi_document_is_what_its_schema_says() -> None:
    document: dict[str, Any] = json.loads(json.dumps(asyncapi()))
    messages = [each for channel in document["channels"].values() for each in channel["messages"].values()]
    examples = [(message, example) for message in messages for example in message.get("examples", ())]
    assert len(examples) > 2 * len(Verb)
    for message, example in examples:
        for part, value in example.items():
            _validated(message[part], document, value)


def test_every_example_of_a_request_is_read_whole() -> None:
    for verb, kind in REQUESTS.items():
        example = examples.REQUESTS[verb]
        assert example == decode(kind, json.dumps(example).encode()).model_dump(
            mode="json", include=set(example)
        )
    for verb, example in examples.REPLIES.items():
        assert set(example) <= set(REPLIES[verb].model_fields)
    header = decode(Header, json.dumps(examples.HEADER).encode())
    assert header.model_dump(by_alias=True) == examples.HEADER


def _references(value: object) -> set[str]:
    if isinstance(value, dict):
        own = {value["$ref"]} if "$ref" in value else set()
        return own.union(*map(_references, value.values()))
    return set().union(*map(_references, value)) if isinstance(value, list) else set()
